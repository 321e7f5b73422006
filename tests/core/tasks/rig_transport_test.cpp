#include "core/tasks/rig_transport.h"

#include <gtest/gtest.h>

namespace luxrig {
namespace {

Rig small_rig() {
  Rig rig;
  rig.luminaires.resize(2);
  rig.luminaires[0].intensity = make_isotropic(100);
  rig.luminaires[1].intensity = make_isotropic(200);
  rig.fixtures.resize(3);
  rig.fixtures[0].luminaire = 1;
  rig.fixtures[1].luminaire = 0;
  rig.fixtures[2].luminaire = 1;
  for (int i = 0; i < 3; ++i) rig.fixtures[i].world_from_mount.translation_m = {1.0 * i, 2.0, 3.0};
  rig.fixtures[1].joints = {0, kPi / 2};
  rig.points.resize(2);
  rig.points[1].position_world_m = {4, 5, 6};
  rig.points[1].normal_world = Vec3::UnitX();
  rig.luxmeters.resize(1);
  rig.luxmeters[0].position_world_m = {7, 8, 9};
  rig.luxmeters[0].normal_world = -Vec3::UnitZ();
  return rig;
}

TEST(RigTransport, EmittersFollowTheOrderOfTheFixturesAndTheirAim) {
  const Rig rig = small_rig();
  const auto emitters = emitters_of(rig);
  ASSERT_EQ(emitters.size(), 3u);
  EXPECT_EQ(emitters[0].intensity, rig.luminaires[1].intensity);
  EXPECT_EQ(emitters[1].intensity, rig.luminaires[0].intensity);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(emitters[i].world_from_lamp.translation_m, Vec3(i, 2, 3));
  // Tilted by 90° a head aims along +Y of its base (frames.h).
  EXPECT_LT((emitters[1].world_from_lamp.direction(-Vec3::UnitZ()) - Vec3::UnitY()).norm(), 1e-12);
  EXPECT_LT((emitters[0].world_from_lamp.direction(-Vec3::UnitZ()) + Vec3::UnitZ()).norm(), 1e-12);
}

TEST(RigTransport, EmittersHaveTheShapeAndColourOfTheirLuminaire) {
  Rig rig = small_rig();
  rig.luminaires[0].shape = {LuminousShape::Kind::disk, Vec3(0.2, 0, 0)};
  rig.luminaires[0].colour_rgb = Vec3(2, 0.7, 0.3);
  const auto emitters = emitters_of(rig);
  EXPECT_EQ(emitters[1].shape, rig.luminaires[0].shape);
  EXPECT_EQ(emitters[1].colour_rgb, rig.luminaires[0].colour_rgb);
  EXPECT_EQ(emitters[0].shape, LuminousShape{});
  EXPECT_EQ(emitters[0].colour_rgb, Vec3::Ones());
}

TEST(RigTransport, ATiltedLampFollowsItsTiltFactors) {
  Rig rig = small_rig();
  rig.luminaires[0].tilt = LampTilt{3, {0, 90, 180}, {0.8, 0.6, 0.4}};
  rig.luminaires[1].tilt = rig.luminaires[0].tilt;
  const auto emitters = emitters_of(rig);
  EXPECT_EQ(emitters[0].intensity, rig.luminaires[1].intensity);         // hangs straight
  EXPECT_NEAR(emitters[1].intensity->flux_lm(), 100 * 0.6 / 0.8, 1e-9);  // aims level
  rig.fixtures[0].joints = {1, rad_from_deg(135)};
  EXPECT_NEAR(emitters_of(rig)[0].intensity->flux_lm(), 200 * 0.5 / 0.8, 1e-9);
}

TEST(RigTransport, DaylightIsASeparateSkyAndSun) {
  Rig rig;
  EXPECT_TRUE(daylight_emitters_of(rig).empty());
  rig.daylight = Daylight{};
  EXPECT_TRUE(daylight_emitters_of(rig).empty());
  rig.daylight->towards_sun_world = Vec3(0, 0.6, 0.8);
  rig.daylight->horizontal_lx = 12'000;
  rig.daylight->sun_normal_lx = 80'000;
  using Kind = Daylight::SkyKind;
  for (const Kind kind : {Kind::uniform, Kind::overcast, Kind::clear, Kind::general}) {
    rig.daylight->sky = kind;
    const auto emitters = daylight_emitters_of(rig);
    ASSERT_EQ(emitters.size(), 2u);
    EXPECT_EQ(emitters[0].sky->horizontal_illuminance_lx(), 12'000);
    EXPECT_NEAR(emitters[1].sky->horizontal_illuminance_lx(), 80'000 * 0.8, 1e-6);
  }
  rig.daylight->towards_sun_world = Vec3(0, 0.8, -0.6);  // dusk: the sky alone
  EXPECT_EQ(daylight_emitters_of(rig).size(), 1u);
  rig.daylight->towards_sun_world = Vec3(0, 0.6, 0.8);
  rig.daylight->sky = Kind::none;
  ASSERT_EQ(daylight_emitters_of(rig).size(), 1u);
  EXPECT_GT(daylight_emitters_of(rig)[0].sky->luminance_cd_m2(Vec3(0, 0.6, 0.8)), 1e6);
}

TEST(RigTransport, DaylightFollowsTheFixturesAndIsAlwaysOn) {
  Rig rig = small_rig();
  EXPECT_EQ(all_emitters_of(rig).size(), 3u);
  rig.daylight = Daylight{};
  rig.daylight->sky = Daylight::SkyKind::overcast;
  rig.daylight->horizontal_lx = 5000;
  rig.daylight->sun_normal_lx = 1000;
  const auto emitters = all_emitters_of(rig);
  ASSERT_EQ(emitters.size(), 5u);
  for (std::size_t e = 0; e < 5; ++e) EXPECT_EQ(emitters[e].sky != nullptr, e >= 3);
  TransportMatrix transport;
  transport.lux_per_level = Eigen::MatrixXd{{1, 2, 3, 40, 500}, {6, 7, 8, 0, 9}};
  EXPECT_EQ(levels_with_daylight(transport, Eigen::Vector3d(0.1, 0.2, 0.3)), (Eigen::VectorXd{{0.1, 0.2, 0.3, 1, 1}}));
  EXPECT_EQ(daylight_lux(rig, transport), (Eigen::VectorXd{{540, 9}}));
  transport.lux_per_level.conservativeResize(2, 3);
  EXPECT_EQ(daylight_lux(rig, transport), (Eigen::VectorXd{{0, 0}}));
}

TEST(RigTransport, ReceiversArePointsThenLuxmeters) {
  const auto receivers = receivers_of(small_rig());
  ASSERT_EQ(receivers.size(), 3u);
  EXPECT_EQ(receivers[1].position_world_m, Vec3(4, 5, 6));
  EXPECT_EQ(receivers[1].normal_world, Vec3::UnitX());
  EXPECT_EQ(receivers[2].position_world_m, Vec3(7, 8, 9));
  EXPECT_EQ(receivers[2].normal_world, -Vec3::UnitZ());
}

TEST(RigTransport, AnEmptyRigHasNoEmittersAndNoReceivers) {
  EXPECT_TRUE(emitters_of(Rig{}).empty());
  EXPECT_TRUE(receivers_of(Rig{}).empty());
}

}  // namespace
}  // namespace luxrig
