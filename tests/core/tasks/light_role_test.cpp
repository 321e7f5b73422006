#include "core/tasks/light_role.h"

#include <gtest/gtest.h>

#include "tests/core/highlight/seen/seen_fixture.h"

namespace luxrig {
namespace {

using namespace seen_fixture;

const Vec3 kEye{0, -5, 0};

/// Two walls of a wedge, turned 45° to the left and right of the camera, before a wide wall.
struct Wedge {
  Wedge()
      : object(wedge()),
        room(joined(wedge(),
                    parametric(4, 4, [](double u, double v) { return Vec3(8 * (u - 0.5), 2, 8 * (v - 0.5)); }))) {}
  static Scene wedge() {
    const auto wall = [](double x) {
      return parametric(16, 8, [=](double u, double v) {
        const double across = x < 0 ? u - 1 : u;
        return Vec3(0.5 * across, -0.5 + 0.5 * std::abs(across), v - 0.5);
      });
    };
    return joined(wall(-1), wall(1));
  }
  [[nodiscard]] SeenContrast seen(bool surroundings = false) const {
    SeenViewOptions options;
    options.surroundings = surroundings;
    return SeenContrast({*see_object(room, object, kEye, options)}, {});
  }
  RayScene object, room;
};

/// Left and right of the middle; others 0.
std::vector<float> two_sides(const SeenContrast& seen, float left_lx, float right_lx) {
  std::vector<float> lux;
  for (std::size_t s = 0; s < seen.samples().size(); ++s)
    lux.push_back(!seen.of_object(s) ? 0 : seen.samples()[s].position_world_m.x() < 0 ? left_lx : right_lx);
  return lux;
}

Result<AskedOfLight> asked(const SeenContrast& seen, LightRole role, std::optional<double> ratio,
                           const std::vector<float>& fixed) {
  ReliefSpec relief;
  relief.role = role;
  relief.ratio = ratio;
  return asked_of_light(relief, seen, Vec3::Zero(), kEye, fixed);
}

TEST(LightRole, FillIsWhatTheDarkSideLacksForItsRatio) {
  const SeenContrast seen = Wedge().seen();
  const std::vector<float> key = two_sides(seen, 300, 30);
  const auto fill = asked(seen, LightRole::fill, 3, key);
  ASSERT_TRUE(fill) << fill.error().detail;
  EXPECT_NEAR(fill->other_lx, 300, 1e-3);
  EXPECT_NEAR(fill->role.wanted_lx, 300 / 3.0 - 30, 1e-3);
  for (std::size_t s = 0; s < key.size(); ++s) EXPECT_EQ(fill->role.wanted[s] > 0, key[s] == 30) << s;
  EXPECT_NEAR(*ratio_of(LightRole::fill, *fill, 70), 3, 1e-6);
  // Without a number, as portraits are lit.
  EXPECT_NEAR(asked(seen, LightRole::fill, {}, key)->role.wanted_lx, 300 / kFillRatio - 30, 1e-3);
  // The room gives 10 : 1 already.
  const auto too_little = asked(seen, LightRole::fill, 12, key);
  ASSERT_FALSE(too_little);
  EXPECT_NE(too_little.error().detail.find("key to fill is 10.00"), std::string::npos) << too_little.error().detail;
  EXPECT_FALSE(asked(seen, LightRole::fill, 3, {}));  // there is no key
}

TEST(LightRole, KeyIsToAllOtherLight) {
  const SeenContrast seen = Wedge().seen();
  const auto key = asked(seen, LightRole::key, 4, std::vector<float>(seen.samples().size(), 50));
  ASSERT_TRUE(key) << key.error().detail;
  EXPECT_NEAR(key->role.wanted_lx, 200, 1e-3);
  EXPECT_NEAR(*ratio_of(LightRole::key, *key, 100), 2, 1e-6);
  EXPECT_FALSE(asked(seen, LightRole::key, 4, {}));
  EXPECT_FALSE(asked(seen, LightRole::key, {}, {})->role.asks());
}

TEST(LightRole, RimIsAlongTheOutlineAndSparesTheFront) {
  const SeenContrast seen = Wedge().seen();
  const auto rim = asked(seen, LightRole::rim, 2, two_sides(seen, 200, 200));
  ASSERT_TRUE(rim) << rim.error().detail;
  EXPECT_NEAR(rim->role.wanted_lx, 100, 1e-3);
  double at_edges = 0, front = 0;
  for (std::size_t s = 0; s < seen.samples().size(); ++s) {
    const Vec3& at_m = seen.samples()[s].position_world_m;
    if (rim->role.wanted[s] > 0) {
      EXPECT_TRUE(std::abs(at_m.x()) > 0.45 || std::abs(at_m.z()) > 0.45) << at_m.transpose();
      at_edges += rim->role.wanted[s];
    }
    if (rim->role.spared[s] > 0) {
      EXPECT_TRUE(seen.of_object(s));
      front += rim->role.spared[s];
    }
  }
  EXPECT_NEAR(at_edges, 1, 1e-4);
  EXPECT_NEAR(front, 1, 1e-4);
}

TEST(LightRole, BackgroundIsBehindTheObject) {
  const SeenContrast seen = Wedge().seen(true);
  const auto background = asked(seen, LightRole::background, {}, two_sides(seen, 200, 200));
  ASSERT_TRUE(background) << background.error().detail;
  EXPECT_NEAR(background->role.wanted_lx, 200 / kBackgroundRatio, 1e-3);
  EXPECT_TRUE(background->role.evenly);
  std::size_t behind = 0;
  for (std::size_t s = 0; s < seen.samples().size(); ++s) {
    EXPECT_EQ(background->role.wanted[s] > 0, !seen.of_object(s)) << s;
    EXPECT_EQ(background->role.spared[s] > 0, seen.of_object(s)) << s;
    behind += seen.of_object(s) ? 0 : 1;
  }
  // The object takes half of the picture's width and height.
  EXPECT_GT(behind, seen.samples().size() / 2);
  const WantedPlaces places = wanted_places(seen, background->role, 50);
  EXPECT_EQ(places.samples.points.size(), 50u);
  for (const OrientedPoint& at : places.samples.points) EXPECT_NEAR(at.position_world_m.y(), 2, 1e-4);
  // Before nothing there is none.
  const RayScene alone(Wedge::wedge());
  SeenViewOptions options;
  options.surroundings = true;
  const SeenContrast in_space({*see_object(alone, alone, kEye, options)}, {});
  EXPECT_FALSE(asked(in_space, LightRole::background, {}, {}));
}

}  // namespace
}  // namespace luxrig
