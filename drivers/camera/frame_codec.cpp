#include "drivers/camera/frame_codec.h"

#include <fmt/format.h>

#include <algorithm>

namespace luxrig {
namespace {

tl::unexpected<Fault> bad_frame(std::string detail) {
  return tl::unexpected(Fault{Cause::protocol, {}, std::move(detail), {}});
}

/// One line of two pixels in four bytes, as R'G'B' shares.
void decode_yuyv(const FrameLayout& layout, std::span<const std::uint8_t> line, std::vector<float>& out) {
  const float kr = layout.bt709 ? 0.2126f : 0.299f, kb = layout.bt709 ? 0.0722f : 0.114f, kg = 1 - kr - kb;
  const float black = layout.limited_range ? 16.0f : 0.0f;
  const float luma_range = layout.limited_range ? 219.0f : 255.0f,
              chroma_range = layout.limited_range ? 224.0f : 255.0f;
  for (std::size_t x = 0; x < static_cast<std::size_t>(layout.width_px); ++x) {
    const std::size_t pair = x / 2 * 4;
    const float luma = (static_cast<float>(line[2 * x]) - black) / luma_range;
    const float cb = (static_cast<float>(line[pair + 1]) - 128) / chroma_range;
    const float cr = (static_cast<float>(line[pair + 3]) - 128) / chroma_range;
    const float red = luma + 2 * (1 - kr) * cr, blue = luma + 2 * (1 - kb) * cb;
    for (const float share : {red, (luma - kr * red - kb * blue) / kg, blue})
      out.push_back(std::clamp(share, 0.0f, 1.0f));
  }
}

}  // namespace

const char* name_of(PixelFormat format) {
  switch (format) {
    case PixelFormat::any:
      return "any";
    case PixelFormat::grey8:
      return "GREY";
    case PixelFormat::grey10:
      return "Y10";
    case PixelFormat::grey12:
      return "Y12";
    case PixelFormat::grey16:
      return "Y16";
    case PixelFormat::yuyv:
      return "YUYV";
    case PixelFormat::rgb24:
      return "RGB24";
    case PixelFormat::bgr24:
      return "BGR24";
  }
  return "unknown";
}

std::size_t bytes_per_pixel(PixelFormat format) {
  switch (format) {
    case PixelFormat::any:
    case PixelFormat::grey8:
      return 1;
    case PixelFormat::grey10:
    case PixelFormat::grey12:
    case PixelFormat::grey16:
    case PixelFormat::yuyv:
      return 2;
    case PixelFormat::rgb24:
    case PixelFormat::bgr24:
      return 3;
  }
  return 1;
}

int counts_of(PixelFormat format, bool limited_range) {
  switch (format) {
    case PixelFormat::grey10:
      return 1023;
    case PixelFormat::grey12:
      return 4095;
    case PixelFormat::grey16:
      return 65535;
    case PixelFormat::yuyv:
      return limited_range ? 219 : 255;
    default:
      return 255;
  }
}

Result<RawPicture> decode_frame(const FrameLayout& layout, std::span<const std::uint8_t> bytes) {
  if (layout.format == PixelFormat::any) return bad_frame("frames without a format");
  if (layout.width_px < 1 || layout.height_px < 1 || layout.width_px > kMaxPictureSide_px ||
      layout.height_px > kMaxPictureSide_px ||
      static_cast<long long>(layout.width_px) * layout.height_px > kMaxPicturePixels)
    return bad_frame(fmt::format("frames of {} x {} pixels", layout.width_px, layout.height_px));
  const bool yuyv = layout.format == PixelFormat::yuyv;
  if (yuyv && layout.width_px % 2 != 0) return bad_frame(fmt::format("YUYV of {} pixels a line", layout.width_px));
  const auto width = static_cast<std::size_t>(layout.width_px), height = static_cast<std::size_t>(layout.height_px);
  const std::size_t used = width * bytes_per_pixel(layout.format);
  if (layout.bytes_per_line < used || layout.bytes_per_line > used + (1u << 20))
    return bad_frame(fmt::format("lines of {} bytes for {} pixels", layout.bytes_per_line, width));
  const std::size_t wanted = (height - 1) * layout.bytes_per_line + used;
  if (bytes.size() < wanted)
    return bad_frame(
        fmt::format("a frame with {} of {} bytes: the cable or the device loses data", bytes.size(), wanted));
  RawPicture picture;
  picture.width_px = layout.width_px;
  picture.height_px = layout.height_px;
  picture.channels = yuyv || bytes_per_pixel(layout.format) == 3 ? 3 : 1;
  picture.full_scale_counts = counts_of(layout.format, layout.limited_range);
  picture.samples.reserve(width * height * static_cast<std::size_t>(picture.channels));
  const auto counts = static_cast<float>(picture.full_scale_counts);
  for (std::size_t y = 0; y < height; ++y) {
    const auto line = bytes.subspan(y * layout.bytes_per_line, used);
    switch (layout.format) {
      case PixelFormat::grey8:
      case PixelFormat::rgb24:
        for (const std::uint8_t sample : line) picture.samples.push_back(static_cast<float>(sample) / counts);
        break;
      case PixelFormat::bgr24:
        for (std::size_t x = 0; x < width; ++x)
          for (const std::size_t c : {2u, 1u, 0u})
            picture.samples.push_back(static_cast<float>(line[3 * x + c]) / counts);
        break;
      case PixelFormat::yuyv:
        decode_yuyv(layout, line, picture.samples);
        break;
      default:
        for (std::size_t x = 0; x < width; ++x) {
          const int sample = line[2 * x] | line[2 * x + 1] << 8;
          if (sample > picture.full_scale_counts)
            return bad_frame(fmt::format("a sample of {} where {} has {} at most: choose another format", sample,
                                         name_of(layout.format), picture.full_scale_counts));
          picture.samples.push_back(static_cast<float>(sample) / counts);
        }
    }
  }
  return picture;
}

}  // namespace luxrig
