#include "tools/terminal/picture_png.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/photometry/light_colour.h"
#include "tools/terminal/png_canvas.h"

namespace luxrig {
namespace {

constexpr int kLegendWidth_px = 96;

void write_title(cairo_t* pen, const std::string& title, int left_px, int height_px) {
  if (title.empty()) return;
  set_png_font(pen, 14);
  cairo_text_extents_t size;
  cairo_text_extents(pen, title.c_str(), &size);
  cairo_set_source_rgba(pen, 0, 0, 0, 0.55);
  cairo_rectangle(pen, left_px + 8, height_px - 30, size.x_advance + 16, 22);
  cairo_fill(pen);
  cairo_set_source_rgb(pen, 1, 1, 1);
  cairo_move_to(pen, left_px + 16, height_px - 14);
  cairo_show_text(pen, title.c_str());
}

double srgb(double linear) { return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055; }

using ColourTable = std::array<std::array<int, 3>, 9>;

Vec3 colour_in(const ColourTable& table, double at) {
  const double scaled = std::clamp(at, 0.0, 1.0) * 8;
  const auto low = std::min<std::size_t>(7, static_cast<std::size_t>(scaled));
  const double share = scaled - static_cast<double>(low);
  Vec3 colour;
  for (std::size_t c = 0; c < 3; ++c)
    colour[static_cast<Eigen::Index>(c)] = ((1 - share) * table[low][c] + share * table[low + 1][c]) / 255;
  return colour;
}

/// Puts it on a canvas that is as high or higher.
void develop(const Photograph& photograph, int left_px, cairo_surface_t* surface) {
  constexpr double kWhite = 6;  // exposed luminance shown as white
  const Picture& picture = *photograph.picture;
  const double exposure = kWhite / photograph.look.white_cd_m2;
  // A black body's blue may be nearly zero. Do not amplify the little that there is.
  const Vec3 balance = photograph.look.white_rgb.cwiseMax(0.05).cwiseInverse();
  paint_png(surface, left_px, 0, picture.width_px, picture.height_px, [&](int x, int y) {
    const Vec3 rgb =
        picture.luminance_cd_m2[static_cast<std::size_t>(y * picture.width_px + x)].cast<double>().cwiseProduct(
            balance);
    const double exposed = exposure * luminance_of_rgb(rgb);
    if (!(exposed > 0)) return Vec3(Vec3::Zero());
    const double shown = exposed * (1 + exposed / (kWhite * kWhite)) / (1 + exposed);
    const Vec3 linear = rgb * (exposure * shown / exposed);
    return Vec3(srgb(linear.x()), srgb(linear.y()), srgb(linear.z()));
  });
}

}  // namespace

Vec3 viridis(double at) {
  constexpr ColourTable kTable = {{{68, 1, 84},
                                   {71, 45, 123},
                                   {59, 82, 139},
                                   {44, 114, 142},
                                   {33, 145, 140},
                                   {39, 173, 129},
                                   {94, 201, 98},
                                   {170, 220, 50},
                                   {253, 231, 37}}};
  return colour_in(kTable, at);
}

Vec3 blue_white_red(double at) {
  constexpr ColourTable kTable = {{{33, 102, 172},
                                   {67, 147, 195},
                                   {146, 197, 222},
                                   {209, 229, 240},
                                   {247, 247, 247},
                                   {253, 219, 199},
                                   {244, 165, 130},
                                   {214, 96, 77},
                                   {178, 24, 43}}};
  return colour_in(kTable, at);
}

double round_up_1_2_5(double value) {
  const double decade = std::pow(10, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0})
    if (step * decade >= value * (1 - 1e-9)) return step * decade;
  return 10 * decade;
}

std::string write_photograph(const Picture& picture, const std::string& title, const PhotographLook& look,
                             const std::filesystem::path& file) {
  const Photograph one{&picture, title, look};
  return write_photographs({&one, 1}, file);
}

std::string write_photographs(std::span<const Photograph> photographs, const std::filesystem::path& file) {
  int width_px = 0;
  for (const Photograph& one : photographs) width_px += one.picture->width_px;
  const PngSurface surface = make_png_surface(width_px, photographs.front().picture->height_px);
  const PngPen pen = make_png_pen(surface);
  int left_px = 0;
  for (const Photograph& one : photographs) {
    develop(one, left_px, surface.get());
    write_title(pen.get(), one.title, left_px, one.picture->height_px);
    left_px += one.picture->width_px;
  }
  return write_picture(surface, file);
}

namespace {

/// Lux averaged over similar neighbours, as many as the picture's noise requires. For lines only: they follow what the
/// eye sees, not the noise.
std::vector<float> calmed(const Picture& picture) {
  constexpr double kCalm = 0.01;
  const int reach = std::clamp(static_cast<int>(std::ceil(picture.relative_error / kCalm / 2)), 2, 8);
  std::vector<float> lux(picture.illuminance_lx.size(), -1.0f);
  for (int y = 0; y < picture.height_px; ++y)
    for (int x = 0; x < picture.width_px; ++x) {
      const auto at = [&](int i, int j) {
        return picture.illuminance_lx[static_cast<std::size_t>(j * picture.width_px + i)];
      };
      const float here = at(x, y);
      if (here < 0) continue;
      float sum = 0;
      int count = 0;
      for (int j = std::max(0, y - reach); j <= std::min(picture.height_px - 1, y + reach); ++j)
        for (int i = std::max(0, x - reach); i <= std::min(picture.width_px - 1, x + reach); ++i)
          if (const float there = at(i, j); there > 0.5f * here && there < 2 * here) sum += there, ++count;
      lux[static_cast<std::size_t>(y * picture.width_px + x)] = count > 0 ? sum / static_cast<float>(count) : here;
    }
  return lux;
}

/// Lines of equal lux at 1, 2, 5 × 10^k, each labelled once where it has room.
void draw_isolux_lines(cairo_t* pen, const Picture& picture, double bottom_lx, double top_lx) {
  const std::vector<float> lux = calmed(picture);
  const auto at = [&](int x, int y) { return lux[static_cast<std::size_t>(y * picture.width_px + x)]; };
  set_png_font(pen, 11);
  for (double level = round_up_1_2_5(bottom_lx); level <= top_lx * 1.001; level = round_up_1_2_5(level * 1.5)) {
    const auto line_lx = static_cast<float>(level);
    int best_x = -1, best_y = -1, best_distance = 1 << 30;
    cairo_set_source_rgba(pen, 1, 1, 1, 0.75);
    for (int y = 0; y + 1 < picture.height_px; ++y)
      for (int x = 0; x + 1 < picture.width_px; ++x) {
        const float here = at(x, y), right = at(x + 1, y), below = at(x, y + 1);
        if (here < 0 || right < 0 || below < 0) continue;
        // A step of more than a third between neighbours is the edge of an object, not a gradient of light.
        const float steepest = std::max(std::abs(right - here), std::abs(below - here));
        const bool crosses = (here < line_lx) != (right < line_lx) || (here < line_lx) != (below < line_lx);
        if (!crosses || steepest > here / 3) continue;
        cairo_rectangle(pen, x, y, 1, 1);
        const int distance = std::abs(x - picture.width_px / 2) + std::abs(y - picture.height_px / 2);
        if (distance < best_distance && x > 20 && y > 14 && x < picture.width_px - 40)
          best_distance = distance, best_x = x, best_y = y;
      }
    cairo_fill(pen);
    if (best_x < 0) continue;
    const std::string label = fmt::format("{:g}", level);
    cairo_text_extents_t extents;
    cairo_text_extents(pen, label.c_str(), &extents);
    cairo_set_source_rgba(pen, 0, 0, 0, 0.6);
    cairo_rectangle(pen, best_x + 2, best_y - extents.height / 2 - 3, extents.width + 6, extents.height + 6);
    cairo_fill(pen);
    cairo_set_source_rgb(pen, 1, 1, 1);
    cairo_move_to(pen, best_x + 5, best_y + extents.height / 2);
    cairo_show_text(pen, label.c_str());
  }
}

/// The top of the scale: of nearly all that is shown.
double top_of(const Picture& picture) {
  std::vector<float> values;
  for (const float value : picture.illuminance_lx)
    if (value > 0) values.push_back(value);
  if (values.empty()) return 100;
  std::sort(values.begin(), values.end());
  return round_up_1_2_5(values[static_cast<std::size_t>(0.995 * static_cast<double>(values.size() - 1))]);
}

/// A logarithmic scale of a height, beside the picture.
void draw_legend(cairo_t* pen, const Picture& picture, const char* unit, double bottom, double top) {
  const double left_px = picture.width_px + 12, top_px = 40, height_px = std::max(40, picture.height_px - 60);
  for (int i = 0; i < static_cast<int>(height_px); ++i) {
    const Vec3 colour = viridis(1 - (i + 0.5) / height_px);
    cairo_set_source_rgb(pen, colour.x(), colour.y(), colour.z());
    cairo_rectangle(pen, left_px, top_px + i, 20, 1);
    cairo_fill(pen);
  }
  set_png_font(pen, 13);
  cairo_set_source_rgb(pen, 1, 1, 1);
  cairo_move_to(pen, left_px, 24);
  cairo_show_text(pen, unit);
  for (double tick = round_up_1_2_5(bottom); tick <= top * 1.001; tick = round_up_1_2_5(tick * 1.5)) {
    const double y_px = top_px + (1 - std::log(tick / bottom) / std::log(top / bottom)) * height_px;
    cairo_rectangle(pen, left_px + 20, y_px - 0.5, 5, 1);
    cairo_fill(pen);
    cairo_move_to(pen, left_px + 29, y_px + 4.5);
    cairo_show_text(pen, fmt::format("{:g}", tick).c_str());
  }
}

PngSurface false_colour_surface(const Picture& picture, const std::string& title, const FalseColours& colours) {
  const double top = colours.most.value_or(top_of(picture)), bottom = top / std::pow(10, colours.decades);
  PngSurface surface = make_png_surface(picture.width_px + kLegendWidth_px, picture.height_px);
  const PngPen pen = make_png_pen(surface);
  cairo_set_source_rgb(pen.get(), 0.1, 0.1, 0.1);
  cairo_paint(pen.get());
  paint_png(surface.get(), 0, 0, picture.width_px, picture.height_px, [&](int x, int y) {
    const auto pixel = static_cast<std::size_t>(y * picture.width_px + x);
    const float value = picture.illuminance_lx[pixel];
    if (value < 0) return Vec3(Vec3::Constant(colours.grey.empty() ? 0.0 : static_cast<double>(colours.grey[pixel])));
    return viridis(value > 0 ? std::log(value / bottom) / std::log(top / bottom) : 0);
  });
  draw_isolux_lines(pen.get(), picture, bottom, top);
  draw_legend(pen.get(), picture, colours.unit, bottom, top);
  write_title(pen.get(), title, 0, picture.height_px);
  return surface;
}

std::string png_of(const PngSurface& surface) {
  std::string bytes;
  const auto append = [](void* to, const unsigned char* data, unsigned int size) {
    static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(data), size);
    return CAIRO_STATUS_SUCCESS;
  };
  if (cairo_surface_write_to_png_stream(surface.get(), append, &bytes) != CAIRO_STATUS_SUCCESS) bytes.clear();
  return bytes;
}

}  // namespace

std::string write_false_colour(const Picture& picture, const std::string& title, std::optional<double> max_lx,
                               const std::filesystem::path& file) {
  return write_picture(false_colour_surface(picture, title, {"lux", 2, max_lx, {}}), file);
}

std::string false_colour_png(const Picture& picture, const std::string& title, const FalseColours& colours) {
  return png_of(false_colour_surface(picture, title, colours));
}

namespace {

PngSurface plan_surface(const PlanView& view) {
  PngSurface surface = make_png_surface(view.width_px, view.height_px);
  paint_png(surface.get(), 0, 0, view.width_px, view.height_px, [&](int x, int y) {
    return Vec3(Vec3::Constant(view.shade[static_cast<std::size_t>(y * view.width_px + x)]));
  });
  return surface;
}

}  // namespace

std::string plan_view_png(const PlanView& view) { return png_of(plan_surface(view)); }

}  // namespace luxrig
