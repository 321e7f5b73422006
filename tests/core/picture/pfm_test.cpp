#include "core/picture/pfm.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/random.h"

namespace luxrig {
namespace {

Picture some_picture(int width_px, int height_px) {
  Random random(1);
  Picture picture;
  picture.width_px = width_px;
  picture.height_px = height_px;
  for (int i = 0; i < width_px * height_px; ++i)
    picture.luminance_cd_m2.emplace_back(static_cast<float>(random.between(0, 9)),
                                         static_cast<float>(random.between(0, 9)), static_cast<float>(i));
  return picture;
}

TEST(Pfm, RoundTrips) {
  for (const auto& [width_px, height_px] : {std::pair(1, 1), std::pair(5, 3), std::pair(3, 64)}) {
    const Picture picture = some_picture(width_px, height_px);
    const auto back = picture_from_pfm(to_pfm(picture));
    ASSERT_TRUE(back) << back.error().detail;
    EXPECT_EQ(back->width_px, width_px);
    EXPECT_EQ(back->height_px, height_px);
    EXPECT_EQ(back->luminance_cd_m2, picture.luminance_cd_m2);
  }
}

// "PF", size, negative scale for little-endian; rows bottom up.
TEST(Pfm, FollowsThePublishedFormat) {
  const Picture picture = some_picture(2, 2);
  const std::string bytes = to_pfm(picture);
  EXPECT_TRUE(bytes.starts_with("PF\n2 2\n-1.0\n"));
  float first = 0;
  std::memcpy(&first, bytes.data() + 12 + 8, 4);
  EXPECT_EQ(first, 2) << "blue of the lower left pixel";
}

TEST(Pfm, RefusesInvalidFilesAndPixels) {
  const std::string good = to_pfm(some_picture(4, 4));
  for (std::size_t cut = 0; cut < good.size(); ++cut) EXPECT_FALSE(picture_from_pfm(good.substr(0, cut))) << cut;
  EXPECT_FALSE(picture_from_pfm(good + "x"));
  for (const char* bad : {"Pf\n1 1\n-1.0\n", "PF\n-1 1\n-1.0\n", "PF\n1 1\n1.0\n", "PF\n99999 99999\n-1.0\n",
                          "PF\n1 1\nnan\n", "PF\n4294967297 1\n-1.0\n"})
    EXPECT_FALSE(picture_from_pfm(std::string(bad) + std::string(12, '\0'))) << bad;
  for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -1.0f}) {
    Picture picture = some_picture(2, 1);
    picture.luminance_cd_m2[1].y() = wrong;
    EXPECT_FALSE(picture_from_pfm(to_pfm(picture))) << wrong;
  }
}

}  // namespace
}  // namespace luxrig
