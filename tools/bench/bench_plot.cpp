#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "tools/bench/bench_row.h"

namespace luxrig {
namespace {

constexpr double kWidth_px = 900, kHeight_px = 560, kLeft_px = 80, kRight_px = 260, kTop_px = 50, kBottom_px = 60;
constexpr double kMin = 1e-16;  ///< smallest error that is drawn

/// A logarithmic axis that covers whole decades.
struct Axis {
  double from_px, to_px;
  int low_decade = 0, high_decade = 1;

  void cover(double least, double most) {
    low_decade = static_cast<int>(std::floor(std::log10(least)));
    high_decade = std::max(low_decade + 1, static_cast<int>(std::ceil(std::log10(most))));
  }
  double at(double value) const {
    return from_px + (std::log10(value) - low_decade) / (high_decade - low_decade) * (to_px - from_px);
  }
};

void text_at(cairo_t* pen, double x, double y, const std::string& text) {
  cairo_move_to(pen, x, y);
  cairo_show_text(pen, text.c_str());
}

void draw_line(cairo_t* pen, double x0, double y0, double x1, double y1) {
  cairo_move_to(pen, x0, y0);
  cairo_line_to(pen, x1, y1);
  cairo_stroke(pen);
}

}  // namespace

std::string write_plot(const std::vector<BenchRow>& rows, const std::string& title, const std::filesystem::path& file) {
  if (std::all_of(rows.begin(), rows.end(), [](const BenchRow& row) { return std::isnan(row.error); }))
    return "nothing to draw";
  // Logarithms need positive values: exact results are drawn at 1e-16.
  const auto error_of = [](const BenchRow& row) { return std::clamp(row.error, kMin, 1e16); };
  const auto seconds_of = [](const BenchRow& row) { return std::max(row.seconds, 1e-6); };
  Axis x{kLeft_px, kWidth_px - kRight_px}, y{kHeight_px - kBottom_px, kTop_px};
  double min_s = 1e9, max_s = 1e-9, least = 1e9, most = 1e-16;
  std::map<std::string, std::vector<const BenchRow*>> lines;
  bool one_case = true;  // then it is in the title
  for (const BenchRow& row : rows) {
    if (std::isnan(row.error)) continue;
    min_s = std::min(min_s, seconds_of(row));
    max_s = std::max(max_s, seconds_of(row));
    least = std::min(least, row.quartiles ? std::max(row.quartiles->first, kMin) : error_of(row));
    most = std::max(most, row.quartiles ? row.quartiles->second : error_of(row));
    lines[row.case_name + ", " + row.method].push_back(&row);
    one_case = one_case && row.case_name == rows.front().case_name;
  }
  x.cover(min_s, max_s);
  y.cover(least, most);
  const std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(kWidth_px), static_cast<int>(kHeight_px)),
      &cairo_surface_destroy);
  const std::unique_ptr<cairo_t, decltype(&cairo_destroy)> owner(cairo_create(surface.get()), &cairo_destroy);
  cairo_t* pen = owner.get();
  cairo_set_source_rgb(pen, 1, 1, 1);
  cairo_paint(pen);
  cairo_select_font_face(pen, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(pen, 13);
  cairo_set_line_width(pen, 1);
  for (int d = x.low_decade; d <= x.high_decade; ++d) {
    const double at = x.at(std::pow(10, d));
    cairo_set_source_rgb(pen, 0.87, 0.87, 0.87);
    draw_line(pen, at, kTop_px, at, kHeight_px - kBottom_px);
    cairo_set_source_rgb(pen, 0.2, 0.2, 0.2);
    text_at(pen, at - 16, kHeight_px - kBottom_px + 20, fmt::format("{:g} s", std::pow(10, d)));
  }
  for (int d = y.low_decade; d <= y.high_decade; ++d) {
    const double at = y.at(std::pow(10, d));
    cairo_set_source_rgb(pen, 0.87, 0.87, 0.87);
    draw_line(pen, kLeft_px, at, kWidth_px - kRight_px, at);
    cairo_set_source_rgb(pen, 0.2, 0.2, 0.2);
    text_at(pen, 24, at + 4, fmt::format("1e{}", d));
  }
  text_at(pen, kLeft_px, 28, (one_case ? rows.front().case_name : title) + ": error (as a fraction) over run time");
  // Colours that colour-blind people can tell apart (M. Okabe and K. Ito, 2008).
  constexpr double kColours[][3] = {{0, .45, .70},   {.84, .37, 0}, {0, .62, .45},
                                    {.80, .47, .65}, {.90, .62, 0}, {.34, .71, .91}};
  std::size_t index = 0;
  for (auto& [name, points] : lines) {
    const double* colour = kColours[index % std::size(kColours)];
    cairo_set_source_rgb(pen, colour[0], colour[1], colour[2]);
    std::sort(points.begin(), points.end(),
              [](const BenchRow* a, const BenchRow* b) { return a->seconds < b->seconds; });
    cairo_new_path(pen);  // text leaves a current point behind
    for (const BenchRow* row : points) cairo_line_to(pen, x.at(seconds_of(*row)), y.at(error_of(*row)));
    cairo_stroke(pen);
    for (const BenchRow* row : points) {
      // Side by side, where many lines have a point at the same time.
      const double at_px = x.at(seconds_of(*row)) + (row->quartiles ? 2.5 * static_cast<double>(index % 6) - 6 : 0);
      if (row->quartiles)
        draw_line(pen, at_px, y.at(std::max(row->quartiles->first, kMin)), at_px,
                  y.at(std::max(row->quartiles->second, kMin)));
      cairo_arc(pen, x.at(seconds_of(*row)), y.at(error_of(*row)), 4, 0, 6.2832);
      cairo_fill(pen);
    }
    text_at(pen, kWidth_px - kRight_px + 20, kTop_px + 20 + 20 * static_cast<double>(index),
            one_case ? points.front()->method : name);
    ++index;
  }
  const cairo_status_t status = cairo_surface_write_to_png(surface.get(), file.c_str());
  return status == CAIRO_STATUS_SUCCESS ? "" : cairo_status_to_string(status);
}

}  // namespace luxrig
