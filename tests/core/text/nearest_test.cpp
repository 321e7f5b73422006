#include "core/text/nearest.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace luxrig {
namespace {

constexpr std::string_view kKnown[] = {"lumens", "watts", "beam_angle_deg", "field_angle_deg", "name"};

TEST(NearestName, FindsTypingErrors) {
  EXPECT_EQ(nearest_name("lumen", kKnown), "lumens");
  EXPECT_EQ(nearest_name("lumesn", kKnown), "lumens");
  EXPECT_EQ(nearest_name("Watts", kKnown), "watts");
  EXPECT_EQ(nearest_name("beam-angle-deg", kKnown), "beam_angle_deg");
  EXPECT_EQ(nearest_name("beam_angle", kKnown), "beam_angle_deg");
  EXPECT_EQ(nearest_name("nmae", kKnown), "name");
}

TEST(NearestName, FindsNothingWhenNoNameIsNear) {
  EXPECT_EQ(nearest_name("colour", kKnown), "");
  EXPECT_EQ(nearest_name("", kKnown), "");
  EXPECT_EQ(nearest_name("xy", kKnown), "");
  EXPECT_EQ(nearest_name(std::string(100000, 'a'), kKnown), "");
  EXPECT_EQ(nearest_name("lumens", {}), "");
}

TEST(NearestName, TakesTheFirstOfTwoEquallyNearNames) {
  constexpr std::string_view kPair[] = {"spot-1", "spot-2"};
  EXPECT_EQ(nearest_name("spot-3", kPair), "spot-1");
}

TEST(MendForUnknown, ListsKnownNamesWhenNoneIsNear) {
  EXPECT_EQ(mend_for_unknown("lumen", kKnown, "-"), "did you mean \"lumens\"?");
  EXPECT_EQ(mend_for_unknown("colour", kKnown, "-"), "known: lumens, watts, beam_angle_deg, field_angle_deg, name");
  EXPECT_EQ(mend_for_unknown("colour", {}, "add one"), "add one");
  std::vector<std::string_view> many(20, "long-name");
  EXPECT_TRUE(mend_for_unknown("x", many, "-").ends_with("and 8 more"));
}

}  // namespace
}  // namespace luxrig
