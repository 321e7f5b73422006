#include "tools/luxrig/png_canvas.h"

#include <sstream>

namespace luxrig {

PngSurface make_png_surface(int width_px, int height_px) {
  return {cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px), &cairo_surface_destroy};
}

PngPen make_png_pen(const PngSurface& surface) { return {cairo_create(surface.get()), &cairo_destroy}; }

std::string write_png(const PngSurface& surface, const std::filesystem::path& file) {
  const cairo_status_t status = cairo_surface_write_to_png(surface.get(), file.c_str());
  return status == CAIRO_STATUS_SUCCESS ? "" : std::string(cairo_status_to_string(status));
}

void set_png_font(cairo_t* pen, double size_px, PngFont font) {
  cairo_select_font_face(pen, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         font == PngFont::bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(pen, size_px);
}

double png_text_width_px(cairo_t* pen, const std::string& text) {
  cairo_text_extents_t extents;
  cairo_text_extents(pen, text.c_str(), &extents);
  return extents.x_advance;
}

std::vector<std::string> png_text_lines(cairo_t* pen, const std::string& text, double width_px) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (!lines.empty() && png_text_width_px(pen, lines.back() + " " + word) <= width_px)
      lines.back() += " " + word;
    else
      lines.push_back(word);
  }
  return lines;
}

}  // namespace luxrig
