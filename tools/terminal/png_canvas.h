#pragma once
/// The canvas of pictures: a cairo surface, with colours and text.

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

using PngSurface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using PngPen = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

[[nodiscard]] PngSurface make_png_surface(int width_px, int height_px);
[[nodiscard]] PngPen make_png_pen(const PngSurface& surface);

/// Whether the name ends in .png, .jpg or .jpeg, in any case.
[[nodiscard]] bool is_picture_name(const std::filesystem::path& file);

/// As PNG, or as JPEG (quality 92) if the name ends in .jpg or .jpeg. Returns an empty string, or why the file could
/// not be written.
[[nodiscard]] std::string write_picture(const PngSurface& surface, const std::filesystem::path& file);

enum class PngFont { regular, bold };
void set_png_font(cairo_t* pen, double size_px, PngFont font = PngFont::regular);
[[nodiscard]] double png_text_width_px(cairo_t* pen, const std::string& text);
/// Lines of at most this width in the pen's font, broken at spaces. A longer word gets a line of its own.
[[nodiscard]] std::vector<std::string> png_text_lines(cairo_t* pen, const std::string& text, double width_px);

/// colour_of(x, y) gives sRGB 0…1; x and y count from the left and top of the painted area.
template <class ColourOf>
void paint_png(cairo_surface_t* surface, int left, int top, int width_px, int height_px, const ColourOf& colour_of) {
  cairo_surface_flush(surface);
  unsigned char* bytes = cairo_image_surface_get_data(surface);
  const int stride = cairo_image_surface_get_stride(surface);
  for (int y = 0; y < height_px && bytes; ++y) {
    auto* row = reinterpret_cast<std::uint32_t*>(bytes + static_cast<std::ptrdiff_t>(top + y) * stride);
    for (int x = 0; x < width_px; ++x) {
      const Vec3 colour = colour_of(x, y);
      std::uint32_t rgb = 0;
      for (int c = 0; c < 3; ++c)
        rgb = (rgb << 8) | static_cast<std::uint32_t>(std::lround(255 * std::clamp(colour[c], 0.0, 1.0)));
      row[left + x] = rgb;
    }
  }
  cairo_surface_mark_dirty(surface);
}

}  // namespace luxrig
