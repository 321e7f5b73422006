#include "drivers/camera/frame_codec.h"

#include <gtest/gtest.h>

namespace luxrig {
namespace {

using Bytes = std::vector<std::uint8_t>;

FrameLayout layout_of(PixelFormat format, int width_px, int height_px) {
  return {format, width_px, height_px, static_cast<std::size_t>(width_px) * bytes_per_pixel(format), false, false};
}

TEST(FrameCodec, ReadsGreySamplesOfEveryDepth) {
  const auto grey = decode_frame(layout_of(PixelFormat::grey8, 2, 1), Bytes{0, 255});
  ASSERT_TRUE(grey);
  EXPECT_EQ(grey->samples, (std::vector<float>{0, 1}));
  const auto ten = decode_frame(layout_of(PixelFormat::grey10, 2, 1), Bytes{0xFF, 0x03, 0x00, 0x02});
  ASSERT_TRUE(ten);
  EXPECT_EQ(ten->full_scale_counts, 1023);
  EXPECT_FLOAT_EQ(ten->samples[0], 1);
  EXPECT_FLOAT_EQ(ten->samples[1], 512 / 1023.0f);
  const auto twelve = decode_frame(layout_of(PixelFormat::grey12, 1, 1), Bytes{0x00, 0x08});
  ASSERT_TRUE(twelve);
  EXPECT_FLOAT_EQ(twelve->samples[0], 2048 / 4095.0f);
  const auto sixteen = decode_frame(layout_of(PixelFormat::grey16, 1, 1), Bytes{0x34, 0x12});
  ASSERT_TRUE(sixteen);
  EXPECT_FLOAT_EQ(sixteen->samples[0], 0x1234 / 65535.0f);
}

TEST(FrameCodec, ReadsColoursInTheirOrder) {
  const auto rgb = decode_frame(layout_of(PixelFormat::rgb24, 1, 1), Bytes{255, 51, 0});
  const auto bgr = decode_frame(layout_of(PixelFormat::bgr24, 1, 1), Bytes{0, 51, 255});
  ASSERT_TRUE(rgb && bgr);
  EXPECT_EQ(rgb->samples, bgr->samples);
  EXPECT_FLOAT_EQ(rgb->samples[1], 0.2f);
}

/// Rec. ITU-R BT.601: 100 % bars in eight bits, Y Cb Cr as in its table.
TEST(FrameCodec, ReadsYuyvByRec601sColourBars) {
  const struct {
    std::uint8_t y, cb, cr;
    float r, g, b;
  } bars[] = {{235, 128, 128, 1, 1, 1}, {210, 16, 146, 1, 1, 0}, {170, 166, 16, 0, 1, 1}, {145, 54, 34, 0, 1, 0},
              {106, 202, 222, 1, 0, 1}, {81, 90, 240, 1, 0, 0},  {41, 240, 110, 0, 0, 1}, {16, 128, 128, 0, 0, 0}};
  for (const auto& bar : bars) {
    FrameLayout layout = layout_of(PixelFormat::yuyv, 2, 1);
    layout.limited_range = true;
    const auto picture = decode_frame(layout, Bytes{bar.y, bar.cb, bar.y, bar.cr});
    ASSERT_TRUE(picture);
    EXPECT_EQ(picture->full_scale_counts, 219);
    for (const std::size_t pixel : {0u, 1u}) {
      EXPECT_NEAR(picture->samples[3 * pixel], bar.r, 0.01);
      EXPECT_NEAR(picture->samples[3 * pixel + 1], bar.g, 0.01);
      EXPECT_NEAR(picture->samples[3 * pixel + 2], bar.b, 0.01);
    }
  }
}

TEST(FrameCodec, ReadsYuyvByRec709sRed) {
  FrameLayout layout = layout_of(PixelFormat::yuyv, 2, 1);
  layout.limited_range = layout.bt709 = true;
  const auto red = decode_frame(layout, Bytes{63, 102, 63, 240});  // Rec. BT.709, 100 % red
  ASSERT_TRUE(red);
  EXPECT_NEAR(red->samples[0], 1, 0.01);
  EXPECT_NEAR(red->samples[1], 0, 0.01);
  EXPECT_NEAR(red->samples[2], 0, 0.01);
  layout.limited_range = false;
  const auto white = decode_frame(layout, Bytes{255, 128, 0, 128});
  ASSERT_TRUE(white);
  EXPECT_FLOAT_EQ(white->samples[1], 1);
  EXPECT_FLOAT_EQ(white->samples[4], 0);
}

TEST(FrameCodec, SkipsLinePadding) {
  FrameLayout layout = layout_of(PixelFormat::grey8, 2, 2);
  layout.bytes_per_line = 4;
  const auto picture = decode_frame(layout, Bytes{51, 102, 9, 9, 153, 204});
  ASSERT_TRUE(picture) << "the last line needs no filling";
  EXPECT_FLOAT_EQ(picture->samples[2], 0.6f);
}

TEST(FrameCodec, RefusesInvalidFrames) {
  EXPECT_FALSE(decode_frame(layout_of(PixelFormat::grey8, 2, 2), Bytes{1, 2, 3}));
  EXPECT_FALSE(decode_frame(layout_of(PixelFormat::grey10, 1, 1), Bytes{0xFF, 0xFF})) << "16 bits in 10";
  EXPECT_FALSE(decode_frame(layout_of(PixelFormat::yuyv, 1, 1), Bytes{1, 2}));
  EXPECT_FALSE(decode_frame(layout_of(PixelFormat::any, 1, 1), Bytes{1}));
  EXPECT_FALSE(decode_frame(layout_of(PixelFormat::grey8, 0, 1), Bytes{}));
  EXPECT_FALSE(decode_frame(layout_of(PixelFormat::grey8, -4, 1), Bytes{}));
  FrameLayout narrow = layout_of(PixelFormat::rgb24, 4, 1);
  narrow.bytes_per_line = 11;
  EXPECT_FALSE(decode_frame(narrow, Bytes(100)));
}

}  // namespace
}  // namespace luxrig
