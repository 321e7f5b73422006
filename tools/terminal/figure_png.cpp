#include "tools/terminal/figure_png.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/terminal/picture_png.h"
#include "tools/terminal/png_canvas.h"

namespace luxrig {
namespace {

constexpr int kMargin_px = 10, kTitleLine_px = 22, kLine_px = 16, kBarWidth_px = 18;
constexpr double kTitleFont_px = 15, kFont_px = 12;

void ink(cairo_t* pen, const Vec3& rgb) { cairo_set_source_rgb(pen, rgb.x(), rgb.y(), rgb.z()); }

/// White under all text and marks in a picture, so that they read on any colour.
void fill_on_white(cairo_t* pen, const Vec3& rgb) {
  cairo_set_source_rgba(pen, 1, 1, 1, 0.9);
  cairo_set_line_width(pen, 3);
  cairo_set_line_join(pen, CAIRO_LINE_JOIN_ROUND);
  cairo_stroke_preserve(pen);
  ink(pen, rgb);
  cairo_fill(pen);
}

void stroke_on_white(cairo_t* pen, const Vec3& rgb) {
  cairo_set_source_rgba(pen, 1, 1, 1, 0.9);
  cairo_set_line_width(pen, 5);
  cairo_stroke_preserve(pen);
  ink(pen, rgb);
  cairo_set_line_width(pen, 2);
  cairo_stroke(pen);
}

void draw_mark(cairo_t* pen, FigureMark mark, double x, double y, const Vec3& rgb) {
  cairo_new_path(pen);
  switch (mark) {
    case FigureMark::none:
      return;
    case FigureMark::dot:
      cairo_arc(pen, x, y, 4, 0, 2 * kPi);
      return fill_on_white(pen, rgb);
    case FigureMark::ring:
      cairo_arc(pen, x, y, 7, 0, 2 * kPi);
      return stroke_on_white(pen, rgb);
    case FigureMark::diamond:
      cairo_move_to(pen, x, y - 6);
      cairo_line_to(pen, x + 6, y);
      cairo_line_to(pen, x, y + 6);
      cairo_line_to(pen, x - 6, y);
      cairo_close_path(pen);
      return fill_on_white(pen, rgb);
    case FigureMark::cross:
      cairo_move_to(pen, x - 4, y - 4);
      cairo_line_to(pen, x + 4, y + 4);
      cairo_move_to(pen, x - 4, y + 4);
      cairo_line_to(pen, x + 4, y - 4);
      return stroke_on_white(pen, rgb);
    case FigureMark::line:
      cairo_move_to(pen, x - 7, y);
      cairo_line_to(pen, x + 7, y);
      return stroke_on_white(pen, rgb);
  }
}

/// Places for the words of labels, clear of earlier ones: on the label's own line if it is free, else a few lines below
/// or above.
class LabelPlaces {
 public:
  [[nodiscard]] double free_y(double x, double y, double wide) {
    constexpr double kHigh_px = kFont_px + 2;
    const auto taken = [&](double at) {
      return std::ranges::any_of(taken_, [&](const Words& w) {
        return x < w.x + w.wide + 4 && w.x < x + wide + 4 && std::abs(at - w.y) < kHigh_px;
      });
    };
    double best = y;
    for (const int lines : {0, 1, -1, 2, -2, 3, -3}) {
      best = y + lines * kHigh_px;
      if (!taken(best)) break;
      best = y;
    }
    taken_.push_back({x, best, wide});
    return best;
  }

 private:
  struct Words {
    double x, y, wide;
  };
  std::vector<Words> taken_;
};

void draw_label(cairo_t* pen, const FigureLabel& label, LabelPlaces& places, double top, int width_px, int height_px) {
  draw_mark(pen, label.mark, label.x_px, top + label.y_px, label.rgb);
  if (label.words.empty()) return;
  set_png_font(pen, kFont_px, PngFont::bold);
  const bool alone = label.mark == FigureMark::none;
  const double wide = png_text_width_px(pen, label.words), gap = alone ? -wide / 2 : 10;
  double x = label.x_px + gap;
  if (x + wide > width_px - 4) x = alone ? width_px - 4 - wide : label.x_px - gap - wide;
  x = std::max(4.0, x);
  const double wanted_y = places.free_y(x, label.y_px + kFont_px / 2 - 2, wide);
  const double y = std::clamp(wanted_y, kFont_px + 2, height_px - 4.0);
  cairo_new_path(pen);
  cairo_move_to(pen, x, top + y);
  cairo_text_path(pen, label.words.c_str());
  fill_on_white(pen, alone ? label.rgb : Vec3(Vec3::Constant(0.1)));
}

/// Lays the column out, and draws it if there is a pen. Returns how far down it reached.
class FigureColumn {
 public:
  FigureColumn(cairo_t* pen, bool draws, double left, double top) : pen_(pen), draws_(draws), left_(left), y_(top) {}

  void words(const std::string& text, double indent, PngFont font = PngFont::regular) {
    set_png_font(pen_, kFont_px, font);
    for (const std::string& line : png_text_lines(pen_, text, kFigureColumn_px - 2 * kMargin_px - indent)) {
      if (draws_) {
        ink(pen_, Vec3::Constant(0.1));
        cairo_move_to(pen_, left_ + indent, y_ + kFont_px);
        cairo_show_text(pen_, line.c_str());
      }
      y_ += kLine_px;
    }
  }

  void scale(const FigureScale& scale, double height) {
    words(scale.what, 0, PngFont::bold);
    y_ += 6;
    if (!scale.words_at_top.empty()) words(scale.words_at_top, 0);
    y_ += 4;
    if (draws_) bar(scale, height);
    y_ += height + 6;
    if (!scale.words_at_bottom.empty()) words(scale.words_at_bottom, 0);
    y_ += 12;
  }

  void key(const FigureKey& entry) {
    if (draws_) draw_mark(pen_, entry.mark, left_ + 8, y_ + 8, entry.rgb);
    words(entry.words, entry.mark == FigureMark::none ? 0 : 22);
    y_ += 8;
  }

  [[nodiscard]] double reached() const { return y_; }

 private:
  void bar(const FigureScale& scale, double height) {
    for (int i = 0; i < static_cast<int>(height); ++i) {
      ink(pen_, scale.colour(1 - (i + 0.5) / height));
      cairo_rectangle(pen_, left_, y_ + i, kBarWidth_px, 1);
      cairo_fill(pen_);
    }
    set_png_font(pen_, kFont_px);
    ink(pen_, Vec3::Constant(0.1));
    for (const double tick : even_ticks(scale.bottom, scale.top, 6)) {
      const double y = y_ + (scale.top - tick) / (scale.top - scale.bottom) * height;
      cairo_rectangle(pen_, left_ + kBarWidth_px, y - 0.5, 5, 1);
      cairo_fill(pen_);
      cairo_move_to(pen_, left_ + kBarWidth_px + 9, y + 4);
      cairo_show_text(pen_, fmt::format("{:g}", tick).c_str());
    }
  }

  cairo_t* pen_;
  bool draws_;
  double left_, y_;
};

double lay_out(FigureColumn column, const Figure& figure, double bar_px) {
  if (figure.scale) column.scale(*figure.scale, bar_px);
  for (const FigureKey& entry : figure.key) column.key(entry);
  return column.reached();
}

}  // namespace

std::vector<double> even_ticks(double bottom, double top, int most) {
  const double step = round_up_1_2_5((top - bottom) / std::max(1, most - 1));
  std::vector<double> ticks;
  const double slack = 1e-9 * step;
  for (double i = std::ceil((bottom - slack) / step); i * step <= top + slack; ++i)
    ticks.push_back(i * step + 0.0);  // no -0
  return ticks;
}

std::string write_figure(const Figure& figure, const std::filesystem::path& file) {
  const int width = figure.picture.width_px, height = figure.picture.height_px;
  const int all_width = width + kFigureColumn_px;
  const PngSurface scratch = make_png_surface(1, 1);
  const PngPen measure = make_png_pen(scratch);
  set_png_font(measure.get(), kTitleFont_px, PngFont::bold);
  const auto title = png_text_lines(measure.get(), figure.title, all_width - 2 * kMargin_px);
  set_png_font(measure.get(), kFont_px);
  const auto caption = png_text_lines(measure.get(), figure.caption, all_width - 2 * kMargin_px);
  const int top = kMargin_px + kTitleLine_px * static_cast<int>(title.size()) +
                  kLine_px * static_cast<int>(caption.size()) + kMargin_px / 2;
  const double bar_px = std::clamp(height / 2.0, 60.0, 240.0);
  const double column_px = lay_out({measure.get(), false, 0, 0}, figure, bar_px);
  const int below = std::max(height, static_cast<int>(std::ceil(column_px)) + kMargin_px);

  const PngSurface surface = make_png_surface(all_width, top + below);
  const PngPen pen = make_png_pen(surface);
  ink(pen.get(), Vec3::Ones());
  cairo_paint(pen.get());
  paint_png(surface.get(), 0, top, width, height, [&](int x, int y) {
    return Vec3(
        figure.picture.rgb[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)]
            .cast<double>());
  });
  ink(pen.get(), Vec3::Constant(0.1));
  int y = kMargin_px;
  set_png_font(pen.get(), kTitleFont_px, PngFont::bold);
  for (const std::string& line : title) {
    cairo_move_to(pen.get(), kMargin_px, y + kTitleFont_px);
    cairo_show_text(pen.get(), line.c_str());
    y += kTitleLine_px;
  }
  set_png_font(pen.get(), kFont_px);
  for (const std::string& line : caption) {
    cairo_move_to(pen.get(), kMargin_px, y + kFont_px);
    cairo_show_text(pen.get(), line.c_str());
    y += kLine_px;
  }
  LabelPlaces places;
  for (const FigureLabel& label : figure.labels) draw_label(pen.get(), label, places, top, width, height);
  lay_out({pen.get(), true, static_cast<double>(width + kMargin_px), static_cast<double>(top)}, figure, bar_px);
  return write_picture(surface, file);
}

}  // namespace luxrig
