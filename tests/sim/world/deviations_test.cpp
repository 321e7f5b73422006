// A truth that differs from the rig file as real rigs do.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/output/output_program.h"
#include "sim/devices/dimmer.h"
#include "sim/devices/head.h"
#include "sim/devices/luxmeter.h"
#include "sim/world/world.h"
#include "tests/sim/tiny_rig.h"

namespace luxrig::sim {
namespace {

TEST(Deviations, OfARealRigStayWithinWhatTheySay) {
  Rig rig = tiny_rig();
  Deviations real = Deviations::real();
  double low = 9, high = 0, steepest = 0, flattest = 9, farthest_m = 0, widest_rad = 0;
  double slowest = 9, fastest = 0, slackest_s = 0;
  for (real.seed = 1; real.seed <= 500; ++real.seed)
    for (const FixtureTruth& truth : draw_fixtures(rig, real)) {
      low = std::min(low, truth.output);
      high = std::max(high, truth.output);
      EXPECT_TRUE(truth.of_drive);
      steepest = std::max(steepest, truth.curve_exponent);
      flattest = std::min(flattest, truth.curve_exponent);
      EXPECT_GE(truth.dead_band, 0);
      EXPECT_LE(truth.dead_band, 0.04);
      const Vec3 off_m = truth.world_from_mount.translation_m - rig.fixtures[0].world_from_mount.translation_m;
      farthest_m = std::max(farthest_m, off_m.cwiseAbs().maxCoeff());
      widest_rad = std::max(widest_rad, Eigen::AngleAxisd(truth.photometry_from_lamp).angle());
      slowest = std::min(slowest, truth.head.speed_share);
      fastest = std::max(fastest, truth.head.speed_share);
      slackest_s = std::max(slackest_s, truth.head.lag_s);
      EXPECT_EQ(truth.head.pan_scale, 1) << "only a bad rig is connected wrongly";
    }
  EXPECT_NEAR(slowest, 0.85, 0.005);
  EXPECT_NEAR(fastest, 1.075, 0.005);
  EXPECT_NEAR(slackest_s, 0.06, 0.005);
  EXPECT_GE(low, 0.8);
  EXPECT_LE(high, 1.2);
  EXPECT_LT(low, 0.81);
  EXPECT_GT(high, 1.19);
  EXPECT_GE(flattest, 0.8);
  EXPECT_LE(steepest, 2.4);
  EXPECT_LT(flattest, 0.85);
  EXPECT_GT(steepest, 2.35);
  EXPECT_LE(farthest_m, 0.15 + 1e-12);
  EXPECT_GT(farthest_m, 0.12);
  EXPECT_LE(widest_rad, rad_from_deg(3) + 1e-12);
  EXPECT_GT(widest_rad, rad_from_deg(2.9));
}

TEST(Deviations, EmittersOfAHousingHangTogetherAndAgeApart) {
  Rig rig = tiny_rig();
  for (Fixture& fixture : rig.fixtures) fixture.housing = 0;
  Deviations real = Deviations::real();
  real.seed = 3;
  const auto truths = draw_fixtures(rig, real);
  for (const FixtureTruth& truth : truths)
    EXPECT_EQ(truth.world_from_mount.translation_m - rig.fixtures[0].world_from_mount.translation_m,
              truths[0].world_from_mount.translation_m - rig.fixtures[0].world_from_mount.translation_m);
  std::set<double> outputs;
  for (const FixtureTruth& truth : truths) outputs.insert(truth.output);
  EXPECT_EQ(outputs.size(), truths.size());
}

TEST(Deviations, SomeHeadsOfABadRigTurnWronglyAndSomeLinesAreSwapped) {
  Rig rig = tiny_rig();
  Deviations bad = Deviations::bad();
  int mirrored = 0, scaled = 0, swapped = 0, heads = 0;
  for (bad.seed = 1; bad.seed <= 400; ++bad.seed) {
    const auto truths = draw_fixtures(rig, bad);
    std::multiset<std::size_t> lines;
    for (std::size_t f = 0; f < truths.size(); ++f) {
      lines.insert(truths[f].line);
      swapped += truths[f].line != f;
      if (!rig.fixtures[f].moves) {
        EXPECT_EQ(truths[f].head.pan_scale, 1);
        continue;
      }
      ++heads;
      mirrored += truths[f].head.pan_scale == -1;
      scaled += truths[f].head.pan_scale == 540.0 / 630.0;
    }
    for (std::size_t f = 0; f < truths.size(); ++f) EXPECT_EQ(lines.count(f), 1U) << "every line ends somewhere";
  }
  // A twelfth of all heads each: a quarter of them is wrong, in one of three ways.
  EXPECT_NEAR(mirrored, heads / 12.0, 4 * std::sqrt(heads / 12.0));
  EXPECT_NEAR(scaled, heads / 12.0, 4 * std::sqrt(heads / 12.0));
  EXPECT_EQ(swapped, 0) << "a head and a lamp have different plugs";
}

TEST(Deviations, ASwappedLineLightsTheNeighbour) {
  Rig rig = tiny_rig();
  for (Fixture& fixture : rig.fixtures) fixture.moves = false;
  Deviations swapped = Deviations::none();
  swapped.wrong_lines = 1;
  const auto truths = draw_fixtures(rig, swapped);
  ASSERT_EQ(truths[0].line, 1U);
  ASSERT_EQ(truths[1].line, 0U);
  const auto world = tiny_world(rig, swapped);
  world->set_drive(0, 1);
  world->advance(at_s(0.1));
  EXPECT_EQ(world->levels()[0], 0);
  EXPECT_EQ(world->levels()[1], 1);
}

TEST(Deviations, ADimmerOfADriveHasADeadBandAndATail) {
  Dimmer dimmer({.nominal = DimmerCurve::s_curve, .exponent = 2, .of_drive = true, .dead_band = 0.04, .tail = 0.01});
  const auto level_at = [&](double drive) {
    dimmer.set_drive(drive);
    dimmer.step(1);
    return dimmer.level();
  };
  EXPECT_EQ(level_at(0), 0);
  EXPECT_EQ(level_at(0.04), 0);
  EXPECT_NEAR(level_at(0.0401), 0.01, 1e-6);
  EXPECT_NEAR(level_at(0.52), 0.01 + 0.99 * 0.25, 1e-12);
  EXPECT_EQ(level_at(1), 1);
}

TEST(Deviations, ALampGivesMoreWhileItIsColdAndLessWhenItIsOld) {
  Dimmer cold({.warm_up_share = 0.05});
  cold.set_drive(1);
  cold.step(1);
  EXPECT_NEAR(cold.level(), 1.05, 0.001);
  for (int s = 0; s < 600; ++s) cold.step(1);
  EXPECT_NEAR(cold.level(), 1 + 0.05 * std::exp(-3), 2e-4) << "95 % of the way in ten minutes";
  Dimmer old({.ageing_per_hour = 0.01});
  old.set_drive(0.5);
  for (int minute = 0; minute < 600; ++minute) old.step(60);
  EXPECT_NEAR(old.level(), 0.5 * std::exp(-0.01 * 10 * 0.5), 1e-9) << "ten hours at half light";
}

TEST(Deviations, AMeterShowsItsLightLateAndDrifts) {
  LuxmeterDevice meter({.drift_per_hour = 0.36, .latency_ticks = 150, .ticks_per_sample = 10});
  std::uint64_t tick = 0;
  const auto run_for = [&](double s, double lux) {
    for (const auto end = tick + static_cast<std::uint64_t>(std::lround(100 * s)); tick < end;)
      meter.step(lux, 0.01, ++tick);
  };
  run_for(5, 100);
  EXPECT_NEAR(meter.reading_lx(), 100, 0.1);
  run_for(1.4, 200);
  EXPECT_NEAR(meter.reading_lx(), 100, 0.1) << "1.5 s late";
  EXPECT_GT(meter.sampled_at_tick() + 11, tick) << "and it does not tell";
  run_for(0.3, 200);
  EXPECT_NEAR(meter.reading_lx(), 200, 0.2);
  run_for(100 - 6.7, 200);
  EXPECT_NEAR(meter.reading_lx(), 200 * (1 + 0.36 * 98.5 / 3600), 0.01);
}

// cos^(1+k): the light of each lamp by its own angle, for lamps with nothing around them.
TEST(Deviations, AMeterRespondsToSlantingLightByItsOwnExponent) {
  Rig rig = tiny_rig();
  rig.luxmeters[0].position_world_m = {3, 0, 0};                   // 45° off the lamps at {0, 0, 3}
  rig.luxmeters[1].position_world_m = {3 * std::sqrt(3.0), 0, 0};  // 60°
  rig.fixtures.resize(1);
  Deviations slanted = Deviations::none();
  slanted.meter_cosine_exponent = 0.2;
  int less = 0;
  for (slanted.seed = 1; slanted.seed <= 20; ++slanted.seed) {
    const auto made = World::make(rig, slanted, 0.01);
    ASSERT_TRUE(made) << made.error().detail;
    World& world = **made;
    world.set_drive(0, 1);
    world.advance(at_s(1));
    for (const auto& [m, cosine] : {std::pair{0U, std::sqrt(0.5)}, std::pair{1U, 0.5}}) {
      const double k = std::log(world.meter_reading_lx(m) / world.luxmeters()[m].lux) / std::log(cosine);
      EXPECT_LE(std::abs(k), 0.2 + 1e-3);
      less += k > 0;
    }
  }
  EXPECT_GT(less, 8);
  EXPECT_LT(less, 32);
}

TEST(Deviations, AHeadWithPlayStopsShortOnEitherSide) {
  Fixture fixture = tiny_rig().fixtures[1];
  Head head(fixture, {1, 0.02});
  const auto pan_after = [&](double target_rad) {
    head.set_target({target_rad, 0});
    for (int i = 0; i < 500; ++i) head.step(0.01);
    return head.joints().pan_rad;
  };
  EXPECT_NEAR(pan_after(0.5), 0.49, 1e-12);
  EXPECT_NEAR(pan_after(1), 0.99, 1e-12);
  EXPECT_NEAR(pan_after(0.5), 0.51, 1e-12);
  Head mirrored(fixture, {-1});
  mirrored.set_target({0.5, 0.2});
  for (int i = 0; i < 500; ++i) mirrored.step(0.01);
  EXPECT_NEAR(mirrored.joints().pan_rad, -0.5, 1e-12);
  EXPECT_NEAR(mirrored.joints().tilt_rad, 0.2, 1e-12);
}

TEST(Deviations, CloudsPassSmoothlyAndVisitorsNowAndThen) {
  Rig rig = tiny_rig();
  Deviations clouds = Deviations::none();
  clouds.cloud_share = 0.3;
  const auto under = World::make(rig, clouds, tiny_light(), nullptr, Eigen::VectorXd{{100, 100, 100}});
  ASSERT_TRUE(under);
  double least = 200, most = 0, largest_step = 0, before = (*under)->points()[0].lux;
  for (int s = 1; s <= 3600; ++s) {
    (*under)->advance(at_s(s));
    const double lux = (*under)->points()[0].lux;
    if (s > 1) largest_step = std::max(largest_step, std::abs(lux - before));
    before = lux;
    least = std::min(least, lux);
    most = std::max(most, lux);
  }
  EXPECT_GE(least, 70);
  EXPECT_LE(most, 130);
  EXPECT_LT(least, 90);
  EXPECT_GT(most, 110);
  EXPECT_LT(largest_step, 2) << "no cloud comes within a second";

  Deviations visits = Deviations::none();
  visits.visits_per_hour = 30;
  const auto world = tiny_world(rig, visits);
  world->set_drive(0, 1);
  int shaded_s = 0;
  for (int s = 1; s <= 36000; ++s) {
    world->advance(at_s(s));
    if (world->points()[0].lux < 99.9) ++shaded_s;
  }
  // Half a visit a minute, 36 s each in the mean, at the only point: 300 visits.
  EXPECT_NEAR(shaded_s, 300 * 36, 4 * 36 * std::sqrt(300.0));
}

TEST(Deviations, PaintDiffersByMaterialAndObjectsThatCarryAPointStay) {
  Scene scene;
  scene.object_names = {"scene", "chair", "picture"};
  scene.materials.resize(3);
  for (std::uint32_t object = 0; object < 3; ++object) {
    const auto x = static_cast<float>(5 * object);
    for (int corner = 0; corner < 3; ++corner)
      scene.vertices_m.emplace_back(x + (corner == 1), static_cast<float>(corner == 2), 1);
    scene.triangles.push_back({3 * object, 3 * object + 1, 3 * object + 2});
    scene.object_of_triangle.push_back(object);
    scene.material_of_triangle.push_back(object);
  }
  Rig rig = tiny_rig();
  rig.luxmeters.clear();
  rig.points.resize(1);
  rig.points[0].position_world_m = {10.1, 0.1, 1};  // on the picture
  Deviations real = Deviations::real();
  real.seed = 5;
  const Scene moved = true_scene(scene, rig, real);
  std::set<double> reflectances;
  for (const Material& material : moved.materials) {
    EXPECT_GE(material.reflectance_rgb.x(), 0.85 * 0.5);
    EXPECT_LE(material.reflectance_rgb.x(), 1.15 * 0.5);
    EXPECT_EQ(material.reflectance_rgb.x(), material.reflectance_rgb.z());
    reflectances.insert(material.reflectance_rgb.x());
  }
  EXPECT_EQ(reflectances.size(), 3U);
  const auto shift_m = [&](std::size_t v) { return (moved.vertices_m[v] - scene.vertices_m[v]).norm(); };
  EXPECT_EQ(shift_m(0), 0) << "the room";
  EXPECT_GT(shift_m(3), 0);
  EXPECT_LE(shift_m(3), 0.05F + 1e-6F);
  EXPECT_NEAR(shift_m(3), shift_m(4), 1e-6) << "as a whole";
  EXPECT_EQ(shift_m(6), 0) << "a point lies on it";
}

}  // namespace
}  // namespace luxrig::sim
