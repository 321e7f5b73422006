#include "tools/terminal/png_canvas.h"

#include <jpeglib.h>

#include <cctype>
#include <cerrno>
#include <csetjmp>
#include <cstdio>  // jpeglib.h needs it first
#include <cstring>
#include <sstream>

namespace luxrig {

PngSurface make_png_surface(int width_px, int height_px) {
  return {cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px), &cairo_surface_destroy};
}

PngPen make_png_pen(const PngSurface& surface) { return {cairo_create(surface.get()), &cairo_destroy}; }

namespace {

std::string ending_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

bool is_jpeg_ending(const std::string& ending) { return ending == ".jpg" || ending == ".jpeg"; }

/// libjpeg returns here with an error: nothing may be thrown through C.
struct JpegErrors {
  jpeg_error_mgr manager{};
  std::jmp_buf back;
  char text[JMSG_LENGTH_MAX] = "";
};

void leave_jpeg(j_common_ptr jpeg) {
  auto* errors = reinterpret_cast<JpegErrors*>(jpeg->err);  // `manager` is its first member
  jpeg->err->format_message(jpeg, errors->text);
  std::longjmp(errors->back, 1);
}

std::string write_jpeg(const PngSurface& surface, const std::filesystem::path& file) {
  constexpr int kQuality = 92;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> out(std::fopen(file.c_str(), "wb"), std::fclose);
  if (!out) return std::strerror(errno);
  cairo_surface_flush(surface.get());
  const unsigned char* bytes = cairo_image_surface_get_data(surface.get());
  const int width_px = cairo_image_surface_get_width(surface.get());
  const int height_px = cairo_image_surface_get_height(surface.get());
  const int stride = cairo_image_surface_get_stride(surface.get());
  if (bytes == nullptr) return "no memory for the picture";
  std::vector<JSAMPLE> row(3 * static_cast<std::size_t>(width_px));
  jpeg_compress_struct jpeg{};
  JpegErrors errors;
  jpeg.err = jpeg_std_error(&errors.manager);
  errors.manager.error_exit = leave_jpeg;
  if (setjmp(errors.back) != 0) {
    jpeg_destroy_compress(&jpeg);
    return errors.text;
  }
  jpeg_create_compress(&jpeg);
  jpeg_stdio_dest(&jpeg, out.get());
  jpeg.image_width = static_cast<JDIMENSION>(width_px);
  jpeg.image_height = static_cast<JDIMENSION>(height_px);
  jpeg.input_components = 3;
  jpeg.in_color_space = JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, kQuality, TRUE);
  jpeg.comp_info[0].h_samp_factor = jpeg.comp_info[0].v_samp_factor = 1;  // thin coloured lines stay sharp
  jpeg_start_compress(&jpeg, TRUE);
  for (int y = 0; y < height_px; ++y) {
    const auto* from = reinterpret_cast<const std::uint32_t*>(bytes + static_cast<std::ptrdiff_t>(y) * stride);
    for (int x = 0; x < width_px; ++x)
      for (int c = 0; c < 3; ++c)
        row[static_cast<std::size_t>(3 * x + c)] = static_cast<JSAMPLE>(from[x] >> (16 - 8 * c) & 0xFF);
    JSAMPROW rows[] = {row.data()};
    jpeg_write_scanlines(&jpeg, rows, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  return std::fflush(out.get()) == 0 ? "" : std::strerror(errno);
}

}  // namespace

bool is_picture_name(const std::filesystem::path& file) {
  const std::string ending = ending_of(file);
  return ending == ".png" || is_jpeg_ending(ending);
}

std::string write_picture(const PngSurface& surface, const std::filesystem::path& file) {
  if (is_jpeg_ending(ending_of(file))) return write_jpeg(surface, file);
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
