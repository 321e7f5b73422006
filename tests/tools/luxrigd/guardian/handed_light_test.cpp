#include "tools/luxrigd/guardian/handed_light.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace luxrig {
namespace {

using nlohmann::json;

const LightInForce kHanded{{{0.1, 1.0 / 3}, {{-0.5, 0.25, 0.1}, {1.0 / 7, 0, 0}}}, {0, 1}, 1.5, 3, {0, 1}};

TEST(HandedLight, RoundTrips) {
  const auto read = handed_light_of(handed_light_text(kHanded) + "\n", 2);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->look.levels, kHanded.look.levels);
  EXPECT_EQ(read->safe_levels, kHanded.safe_levels);
  EXPECT_EQ(read->look.joints, kHanded.look.joints);
  EXPECT_EQ(read->silent, kHanded.silent);
  EXPECT_EQ(read->hold_s, kHanded.hold_s);
  EXPECT_EQ(read->fade_s, kHanded.fade_s);
}

TEST(HandedLight, IsSentInFullUnlessSilencesAreStated) {
  json all = json::parse(handed_light_text(kHanded));
  all.erase("silent");
  const auto read = handed_light_of(all.dump(), 2);
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->silent.empty());
  for (const json& bad : {json{0}, json{0, 2}, json{0, "x"}, json(1), json::object()}) {
    all["silent"] = bad;
    EXPECT_FALSE(handed_light_of(all.dump(), 2)) << bad;
  }
}

TEST(HandedLight, IsRefusedIfTruncatedInvalidOrOfAnotherRig) {
  const std::string text = handed_light_text(kHanded);
  EXPECT_FALSE(handed_light_of(text, 3));
  EXPECT_FALSE(handed_light_of(text, 1));
  for (std::size_t cut = 0; cut < text.size(); ++cut) EXPECT_FALSE(handed_light_of(text.substr(0, cut), 2)) << cut;
  for (const auto& [key, bad] : std::vector<std::pair<std::string, json>>{{"levels", {0.1, 1.5}},
                                                                          {"levels", {0.1, -0.1}},
                                                                          {"levels", {0.1, "x"}},
                                                                          {"safe", 7},
                                                                          {"safe", {0.1, nullptr}},
                                                                          {"joints_rad", {{0, 0, 0}, {0, 0}}},
                                                                          {"joints_rad", {{0, 0, 0}, {0, 0, 1e300}}},
                                                                          {"hold_s", -1},
                                                                          {"fade_s", "soon"},
                                                                          {"fade_s", 1e9}}) {
    json all = json::parse(text);
    all[key] = bad;
    EXPECT_FALSE(handed_light_of(all.dump(), 2)) << all.dump();
    all.erase(key);
    EXPECT_FALSE(handed_light_of(all.dump(), 2)) << all.dump();
  }
}

}  // namespace
}  // namespace luxrig
