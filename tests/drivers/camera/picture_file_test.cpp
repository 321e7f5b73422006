/// The PNG vectors were made by hand (chunks and checksums by Python's struct and zlib), not by libpng.
#include "drivers/camera/picture_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/drivers/hex.h"

namespace luxrig {
namespace {

constexpr const char* kGrey16 =
    "89504e470d0a1a0a0000000d4948445200000002000000021000000000074d8ebb0000001249444154789c636060f8ff9f41"
    "c8849101000de302461ae60dcb0000000049454e44ae426082";
constexpr const char* kRgb8 =
    "89504e470d0a1a0a0000000d49484452000000020000000108020000007b40e8dd0000000f49444154789c63f8cf60cc2522"
    "07000731016ffc2bed690000000049454e44ae426082";
constexpr const char* kRgba8 =
    "89504e470d0a1a0a0000000d49484452000000010000000108060000001f15c4890000000d49444154789c63f89fc6c00e00"
    "053a016d6ab093ae0000000049454e44ae426082";
constexpr const char* kPalette =
    "89504e470d0a1a0a0000000d4948445200000002000000010803000000c3fc8fb800000006504c5445000000ff804056a054"
    "f90000000b49444154789c636064000000050002d16633780000000049454e44ae426082";
constexpr const char* kOneBit =
    "89504e470d0a1a0a0000000d4948445200000008000000010100000000cb7bd2ee0000000a49444154789c6358050000ac00"
    "ab660be46b0000000049454e44ae426082";
std::string png_of(std::string_view hex) {
  const auto bytes = from_hex(hex);
  return {bytes.begin(), bytes.end()};
}
std::string float_bytes(std::initializer_list<float> values, bool big_endian) {
  std::string bytes;
  for (const float value : values) {
    char word[4];
    std::memcpy(word, &value, 4);
    if (big_endian) std::swap(word[0], word[3]), std::swap(word[1], word[2]);
    bytes.append(word, 4);
  }
  return bytes;
}
using Samples = std::vector<float>;

TEST(PictureFile, ReadsPngOfEveryKind) {
  const auto grey = decode_picture(png_of(kGrey16));
  ASSERT_TRUE(grey) << grey.error().detail;
  EXPECT_EQ(grey->full_scale_counts, 65535);
  EXPECT_EQ(grey->samples, (Samples{0, 1, 0x1234 / 65535.0f, 256 / 65535.0f}));
  const auto rgb = decode_picture(png_of(kRgb8));
  ASSERT_TRUE(rgb) << rgb.error().detail;
  EXPECT_EQ(rgb->channels, 3);
  EXPECT_EQ(rgb->width_px, 2);
  EXPECT_EQ(rgb->samples, (Samples{1, 0, 0.2f, 10 / 255.0f, 20 / 255.0f, 30 / 255.0f}));
  const auto see_through = decode_picture(png_of(kRgba8));
  ASSERT_TRUE(see_through) << see_through.error().detail;
  EXPECT_EQ(see_through->samples, (Samples{1, 0.4f, 0}));
  const auto palette = decode_picture(png_of(kPalette));
  ASSERT_TRUE(palette) << palette.error().detail;
  EXPECT_EQ(palette->samples, (Samples{1, 128 / 255.0f, 64 / 255.0f, 0, 0, 0}));
  const auto one_bit = decode_picture(png_of(kOneBit));
  ASSERT_TRUE(one_bit) << one_bit.error().detail;
  EXPECT_EQ(one_bit->samples, (Samples{1, 0, 1, 0, 1, 0, 1, 0}));
}

TEST(PictureFile, RefusesDamagedPng) {
  const std::string whole = png_of(kGrey16);
  for (std::size_t length = 0; length < whole.size() - 12; ++length)  // without its end chunk it is still complete
    EXPECT_FALSE(decode_picture(whole.substr(0, length))) << length;
  std::string damaged = whole;
  damaged[45] = static_cast<char>(damaged[45] ^ 1);
  EXPECT_FALSE(decode_picture(damaged)) << "a checksum is wrong";
}

TEST(PictureFile, ReadsPgmAndPpm) {
  const auto grey = decode_picture(std::string("P5\n# by hand\n2 1\n255\n\x00\x33", 23));
  ASSERT_TRUE(grey) << grey.error().detail;
  EXPECT_EQ(grey->samples, (Samples{0, 0.2f}));
  const auto deep = decode_picture(std::string("P5 1 1 4095\n\x08\x00", 14));
  ASSERT_TRUE(deep) << deep.error().detail;
  EXPECT_EQ(deep->full_scale_counts, 4095);
  EXPECT_FLOAT_EQ(deep->samples[0], 2048 / 4095.0f);
  const auto colour = decode_picture("P6 1 1 255\n\x01\x02\x03");
  ASSERT_TRUE(colour) << colour.error().detail;
  EXPECT_EQ(colour->channels, 3);
  EXPECT_FLOAT_EQ(colour->samples[2], 3 / 255.0f);
  EXPECT_FALSE(decode_picture("P5 1 1 100\n\xff")) << "above its largest";
  EXPECT_FALSE(decode_picture("P5 2 2 255\n\x01"));
  EXPECT_FALSE(decode_picture("P5 99999 99999 255\n\x01"));
  EXPECT_FALSE(decode_picture("P5 1 1 70000\n\x01\x01\x01"));
  EXPECT_FALSE(decode_picture("P2 1 1 255\n1"));
}

TEST(PictureFile, ReadsPfmAsLightFromTheBottomUp) {
  const auto little = decode_picture("Pf\n1 2\n-1.0\n" + float_bytes({5, 7}, false));
  ASSERT_TRUE(little) << little.error().detail;
  EXPECT_TRUE(little->is_light);
  EXPECT_EQ(little->samples, (Samples{7, 5}));
  const auto big = decode_picture("PF\n1 1\n1.0\n" + float_bytes({1, 2, 3}, true));
  ASSERT_TRUE(big) << big.error().detail;
  EXPECT_EQ(big->samples, (Samples{1, 2, 3}));
  EXPECT_FALSE(decode_picture("Pf\n1 1\n-1.0\n" + float_bytes({-1}, false)));
  EXPECT_FALSE(decode_picture("Pf\n1 1\n-1.0\n" + float_bytes({NAN}, false)));
  EXPECT_FALSE(decode_picture("Pf\n1 1\n0\n" + float_bytes({1}, false)));
}

}  // namespace
}  // namespace luxrig
