#include <png.h>

#include <csetjmp>
#include <cstring>

#include "drivers/camera/picture_file.h"

namespace luxrig {
namespace {

/// libpng's input, and why it stopped. libpng leaves a function by longjmp, so a function that calls it must have no
/// objects with destructors.
struct PngInput {
  const unsigned char* bytes;
  std::size_t size, at;
  char reason[96];
};

void png_take(png_structp png, png_bytep out, png_size_t wanted) {
  auto* input = static_cast<PngInput*>(png_get_io_ptr(png));
  if (wanted > input->size - input->at) png_error(png, "it ends too early");
  std::memcpy(out, input->bytes + input->at, wanted);
  input->at += wanted;
}
[[noreturn]] void png_failed(png_structp png, png_const_charp text) {
  auto* input = static_cast<PngInput*>(png_get_error_ptr(png));
  std::strncpy(input->reason, text, sizeof input->reason - 1);
  png_longjmp(png, 1);
}
void png_warned(png_structp, png_const_charp) {}

struct PngHead {
  png_uint_32 width, height;
  int channels, bits;
};

/// Reads everything before the samples; false with a reason in the input.
bool read_png_head(png_structp png, png_infop info, PngHead* head) {
  if (setjmp(png_jmpbuf(png))) return false;  // NOLINT: libpng's way
  png_set_user_limits(png, kMaxPictureSide_px, kMaxPictureSide_px);
  png_set_chunk_malloc_max(png, 1u << 20);
  png_set_chunk_cache_max(png, 64);
  png_read_info(png, info);
  const int colour = png_get_color_type(png, info);
  if (colour == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png);
  if (colour == PNG_COLOR_TYPE_GRAY && png_get_bit_depth(png, info) < 8) png_set_expand_gray_1_2_4_to_8(png);
  png_set_strip_alpha(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  head->width = png_get_image_width(png, info);
  head->height = png_get_image_height(png, info);
  head->channels = png_get_channels(png, info);
  head->bits = png_get_bit_depth(png, info);
  return true;
}

bool read_png_rows(png_structp png, png_bytepp rows) {
  if (setjmp(png_jmpbuf(png))) return false;  // NOLINT
  png_read_image(png, rows);
  png_read_end(png, nullptr);
  return true;
}

tl::unexpected<Fault> bad_png(const std::string& why) {
  return tl::unexpected(Fault{Cause::protocol, {}, "a PNG file that cannot be read: " + why, {}});
}

}  // namespace

Result<RawPicture> decode_png(std::string_view bytes) {
  PngInput input{reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), 0, {}};
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &input, png_failed, png_warned);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  struct Closer {
    png_structp& png;
    png_infop& info;
    ~Closer() { png_destroy_read_struct(&png, &info, nullptr); }
  } closer{png, info};
  if (info == nullptr) return bad_png("no memory");
  png_set_read_fn(png, &input, png_take);
  PngHead head{};
  if (!read_png_head(png, info, &head)) return bad_png(input.reason);
  if ((head.channels != 1 && head.channels != 3) || (head.bits != 8 && head.bits != 16) ||
      static_cast<long long>(head.width) * static_cast<long long>(head.height) > kMaxPicturePixels)
    return bad_png("an unusual kind");
  const std::size_t row_bytes = png_get_rowbytes(png, info), per_sample = head.bits == 16 ? 2 : 1;
  const std::size_t row_samples = static_cast<std::size_t>(head.width) * static_cast<std::size_t>(head.channels);
  if (row_bytes != row_samples * per_sample) return bad_png("an unusual kind");
  // A short file may claim a large picture, so check before allocating. Deflate packs 1032 to 1 at most.
  if (row_bytes * head.height / 1100 > bytes.size()) return bad_png("it ends too early");
  std::vector<unsigned char> data(row_bytes * head.height);
  std::vector<png_bytep> rows;
  for (std::size_t y = 0; y < head.height; ++y) rows.push_back(data.data() + y * row_bytes);
  if (!read_png_rows(png, rows.data())) return bad_png(input.reason);
  RawPicture picture;
  picture.width_px = static_cast<int>(head.width);
  picture.height_px = static_cast<int>(head.height);
  picture.channels = head.channels;
  picture.full_scale_counts = head.bits == 16 ? 65535 : 255;
  const auto counts = static_cast<float>(picture.full_scale_counts);
  picture.samples.reserve(row_samples * head.height);
  for (std::size_t i = 0; i < row_samples * head.height; ++i)
    picture.samples.push_back(static_cast<float>(per_sample == 2 ? data[2 * i] << 8 | data[2 * i + 1] : data[i]) /
                              counts);
  return picture;
}

}  // namespace luxrig
