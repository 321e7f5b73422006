// clang-format off
#include <cstdio>  // jpeglib.h needs it
#include <jpeglib.h>
#include <jerror.h>
// clang-format on
#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstring>

#include "core/scene/texture.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxPixels = std::size_t{1} << 26;
constexpr int kMaxScans = 200;  // a progressive JPEG of a few bytes may promise more than a day's work

DecodedTexture not_read(std::string trouble) { return {nullptr, std::move(trouble)}; }

DecodedTexture decode_png(std::string_view bytes) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) == 0) return not_read("is a damaged PNG");
  if (std::size_t{image.width} * image.height > kMaxPixels) {
    png_image_free(&image);
    return not_read("has more than 64 million pixels");
  }
  // With alpha, which is then ignored; without it, libpng composes onto black. 8-bit sRGB, whatever the file has.
  image.format = PNG_FORMAT_RGBA;
  std::vector<unsigned char> pixels(PNG_IMAGE_SIZE(image));
  if (png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr) == 0) {
    png_image_free(&image);
    return not_read("is a damaged PNG");
  }
  Texture::Rows rows(image.width, image.height);
  for (std::size_t y = 0; y < image.height; ++y) rows.add(&pixels[y * image.width * 4], 4);
  return {rows.finish(), ""};
}

/// libjpeg leaves errors by longjmp, so objects that must survive it are here, and plain.
struct JpegErrors {
  jpeg_error_mgr base;  // must be first: libjpeg knows only this
  std::jmp_buf out;
  bool cut_short = false;
};

void jump_out(j_common_ptr info) { std::longjmp(reinterpret_cast<JpegErrors*>(info->err)->out, 1); }

void note_message(j_common_ptr info, int level) {
  auto* const errors = reinterpret_cast<JpegErrors*>(info->err);
  if (level < 0 && (errors->base.msg_code == JWRN_JPEG_EOF || errors->base.msg_code == JWRN_HIT_MARKER))
    errors->cut_short = true;
}

void stop_long_work(j_common_ptr info) {
  if (reinterpret_cast<j_decompress_ptr>(info)->input_scan_number > kMaxScans) jump_out(info);
}

enum class JpegEnd { read, damaged, too_large };

/// No object with a destructor may be created in here: the jump would skip it.
JpegEnd read_jpeg(std::string_view bytes, JpegErrors& errors, std::unique_ptr<Texture::Rows>& rows,
                  std::vector<unsigned char>& row) {
  jpeg_decompress_struct info;
  jpeg_progress_mgr progress{};
  info.err = jpeg_std_error(&errors.base);
  errors.base.error_exit = jump_out;
  errors.base.emit_message = note_message;
  if (setjmp(errors.out) != 0) {
    jpeg_destroy_decompress(&info);
    return JpegEnd::damaged;
  }
  jpeg_create_decompress(&info);
  progress.progress_monitor = stop_long_work;
  info.progress = &progress;
  jpeg_mem_src(&info, reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<unsigned long>(bytes.size()));
  jpeg_read_header(&info, TRUE);
  if (std::size_t{info.image_width} * info.image_height > kMaxPixels) {
    jpeg_destroy_decompress(&info);
    return JpegEnd::too_large;
  }
  info.out_color_space = JCS_RGB;
  jpeg_start_decompress(&info);
  rows = std::make_unique<Texture::Rows>(info.output_width, info.output_height);
  row.resize(std::size_t{3} * info.output_width);
  unsigned char* pixels = row.data();
  while (info.output_scanline < info.output_height) {
    jpeg_read_scanlines(&info, &pixels, 1);
    rows->add(pixels, 3);
  }
  jpeg_finish_decompress(&info);
  jpeg_destroy_decompress(&info);
  return errors.cut_short ? JpegEnd::damaged : JpegEnd::read;
}

DecodedTexture decode_jpeg(std::string_view bytes) {
  JpegErrors errors{};
  std::unique_ptr<Texture::Rows> rows;
  std::vector<unsigned char> row;
  switch (read_jpeg(bytes, errors, rows, row)) {
    case JpegEnd::read:
      return {rows->finish(), ""};
    case JpegEnd::damaged:
      return not_read("is a damaged JPEG, or one of print colours");
    case JpegEnd::too_large:
      return not_read("has more than 64 million pixels");
  }
  return {};
}

}  // namespace

DecodedTexture decode_texture(std::string_view bytes) {
  const auto begins = [&](std::string_view with, std::size_t at = 0) {
    return bytes.substr(std::min(at, bytes.size())).starts_with(with);
  };
  if (begins("\x89PNG\r\n\x1a\n")) return decode_png(bytes);
  if (begins("\xff\xd8\xff")) return decode_jpeg(bytes);
  if (begins("RIFF") && begins("WEBP", 8)) return not_read("is WebP, which is not read");
  if (begins("\xabKTX")) return not_read("is KTX, which is not read");
  if (begins("DDS ")) return not_read("is DDS, which is not read");
  return not_read("is neither PNG nor JPEG");
}

}  // namespace luxrig
