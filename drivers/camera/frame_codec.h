#pragma once
/// Frames of a video device as samples.
/// Source: Linux Media documentation, "Image Formats" (Y10, Y12, Y16: little-endian in 16 bits; YUYV: two pixels in
/// four bytes) and "Colorspaces" (matrices and ranges of Rec. 601 and 709).

#include <cstdint>
#include <span>

#include "drivers/camera/raw_picture.h"

namespace luxrig {

struct FrameLayout {
  PixelFormat format = PixelFormat::grey8;  ///< not `any`
  int width_px = 0, height_px = 0;
  std::size_t bytes_per_line = 0;  ///< ≥ the bytes of a line's samples
  bool limited_range = false;      ///< YUYV: luma 16…235, else 0…255
  bool bt709 = false;              ///< YUYV: matrix of Rec. 709, else of Rec. 601
};

[[nodiscard]] const char* name_of(PixelFormat format);
[[nodiscard]] std::size_t bytes_per_pixel(PixelFormat format);
[[nodiscard]] int counts_of(PixelFormat format, bool limited_range = false);

/// Cause::protocol: impossible sizes, missing bytes, a sample with more bits than its format has.
[[nodiscard]] Result<RawPicture> decode_frame(const FrameLayout& layout, std::span<const std::uint8_t> bytes);

}  // namespace luxrig
