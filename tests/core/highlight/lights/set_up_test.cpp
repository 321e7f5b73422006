#include "core/highlight/lights/set_up.h"

#include <gtest/gtest.h>

#include "tests/core/highlight/seen/seen_fixture.h"

namespace luxrig {
namespace {

using namespace seen_fixture;

const Vec3 kEye{0, -5, 0};
constexpr SetUp kAll[] = {SetUp::rembrandt, SetUp::loop, SetUp::split, SetUp::broad, SetUp::raking, SetUp::copy};

SetUpFrame frame_of(const Scene& scene, const Vec3& eye_m = kEye) {
  const RayScene object(scene);
  return set_up_frame(SeenContrast({view_on(object, object, eye_m)}, {}), Vec3::Zero(), eye_m);
}

/// Aside of a camera that looks from -y, positive to the picture's right.
Vec3 at(double aside_deg, double above_deg) {
  const double aside = rad_from_deg(aside_deg), above = rad_from_deg(above_deg);
  return {std::cos(above) * std::sin(aside), -std::cos(above) * std::cos(aside), std::sin(above)};
}

bool has(SetUp set_up, const Vec3& towards) {
  static const SetUpFrame frame = frame_of(uv_sphere(0.5, 48));
  return LightWindow(set_up, LightRole::any, frame).has(towards);
}

TEST(SetUpFrame, IsThatOfThePicture) {
  const SetUpFrame frame = frame_of(uv_sphere(0.5, 48));
  EXPECT_LT((frame.to_camera + Vec3::UnitY()).norm(), 1e-9);
  EXPECT_LT((frame.right - Vec3::UnitX()).norm(), 1e-9);
  EXPECT_LT((frame.surface + Vec3::UnitY()).norm(), 0.01);
  EXPECT_EQ(frame.broad_side, 0);  // a sphere has none
}

TEST(LightWindow, HasTheAnglesOfEachSetUpOnBothSides) {
  for (const double side : {-1.0, 1.0}) {
    EXPECT_TRUE(has(SetUp::rembrandt, at(side * 45, 45)));
    EXPECT_FALSE(has(SetUp::rembrandt, at(side * 45, 20)));
    EXPECT_FALSE(has(SetUp::rembrandt, at(side * 70, 45)));
    EXPECT_TRUE(has(SetUp::loop, at(side * 37, 20)));
    EXPECT_FALSE(has(SetUp::loop, at(side * 20, 20)));
    EXPECT_FALSE(has(SetUp::loop, at(side * 37, 45)));
    EXPECT_TRUE(has(SetUp::split, at(side * 90, 0)));
    EXPECT_FALSE(has(SetUp::split, at(side * 60, 0)));
    EXPECT_TRUE(has(SetUp::raking, at(side * 80, 0)));
    EXPECT_FALSE(has(SetUp::raking, at(side * 88, 0)));
    EXPECT_FALSE(has(SetUp::raking, at(side * 60, 0)));
    EXPECT_TRUE(has(SetUp::copy, at(side * 45, 0)));
    EXPECT_FALSE(has(SetUp::copy, at(side * 45, 40)));
    EXPECT_FALSE(has(SetUp::copy, at(side * 30, 0)));
    EXPECT_TRUE(has(SetUp::none, at(side * 30, 80)));
  }
  EXPECT_TRUE(has(SetUp::raking, at(0, 80)));  // from above, too
}

TEST(LightWindow, HasItsMiddle) {
  const SetUpFrame frame = frame_of(uv_sphere(0.5, 48));
  for (const auto set_up : kAll)
    for (const int side : {-1, 1}) {
      const LightWindow window(set_up, LightRole::key, frame);
      EXPECT_TRUE(window.has(window.middle(side))) << name_of(set_up);
      EXPECT_EQ(window.side_of(window.middle(side)), side) << name_of(set_up);
      EXPECT_EQ(window.lights(), set_up == SetUp::copy ? 2 : 1);
    }
  const LightWindow rim(SetUp::none, LightRole::rim, frame);
  EXPECT_TRUE(rim.has(rim.middle(1)));
  EXPECT_FALSE(rim.has(at(90, 0)));
  EXPECT_FALSE(rim.open());
  EXPECT_TRUE(LightWindow(SetUp::none, LightRole::fill, frame).open());
}

// Two walls of a box, the wide one turned 30° to the left of the camera, the narrow one 60° to the right. A light from
// the right lights both, one from the left only the wide one.
TEST(LightWindow, BroadIsTheSideThatLightsMoreOfWhatIsSeen) {
  const auto wall = [](double turned_deg, double begin, double end) {
    const Vec3 out = at(turned_deg, 0), along(-out.y(), out.x(), 0);
    return parametric(8, 8, [=](double u, double v) {
      return Vec3(0.4 * out + (begin + (end - begin) * u) * along + (v - 0.5) * Vec3::UnitZ());
    });
  };
  for (const double side : {-1.0, 1.0}) {
    const SetUpFrame frame = frame_of(joined(wall(side * -30, -0.4, 0.4), wall(side * 60, -0.4, 0.4)));
    ASSERT_EQ(frame.broad_side, side);
    const LightWindow broad(SetUp::broad, LightRole::any, frame);
    EXPECT_TRUE(broad.has(at(side * 45, 30)));
    EXPECT_FALSE(broad.has(at(-side * 45, 30)));
    EXPECT_TRUE(broad.has(broad.middle(-1)));
    EXPECT_TRUE(broad.has(broad.middle(1)));
  }
}

// From straight above, as on a copying stand.
TEST(LightWindow, CopiesWhatLiesFlat) {
  const SetUpFrame frame =
      frame_of(parametric(8, 8, [](double u, double v) { return Vec3(u - 0.5, v - 0.5, 0); }), {0, 0, 3});
  const LightWindow copy(SetUp::copy, LightRole::any, frame);
  EXPECT_TRUE(copy.has({1, 0, 1}));
  EXPECT_TRUE(copy.has({-1, 0, 1}));
  EXPECT_FALSE(copy.has({0, 1, 1}));
  EXPECT_FALSE(copy.has({0.3, 0, 1}));
}

}  // namespace
}  // namespace luxrig
