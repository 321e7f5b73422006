/// Gather against the unbiased path tracer, and features of both: colour, gloss, luminaires with size, skies.

#include <gtest/gtest.h>

#include "core/photometry/sky/sky.h"
#include "tests/core/transport/boxes.h"
#include "tests/core/transport/paths/gather_evaluator_fixture.h"
#include "tests/core/transport/within.h"
#include "tools/bench/rooms/enclosures.h"
#include "tools/bench/rooms/lit_room.h"

namespace luxrig {
namespace {

using namespace gather_evaluator_fixture;

TEST(GatherEvaluator, FewReceiversFallBackToTheirOwnPaths) {
  const RayScene rays(make_cube(2, 0.5));
  const std::vector<Receiver> receivers = {{{0.1, 0.2, -1}, Vec3::UnitZ()}, {{-1, 0.3, 0.2}, Vec3::UnitX()}};
  const std::vector<Emitter> lamps = {bulb(300, {-0.2, 0.1, 0.2})};
  const auto gather = evaluated(make_gather_evaluator(rays), receivers, lamps, within(0.02));
  EXPECT_EQ(gather.lux_per_level, evaluated(make_path_evaluator(rays), receivers, lamps, within(0.02)).lux_per_level);
}

// Few paths find light that passes doors; at many points none did. Their error bars were then zero or nearly zero.
TEST(GatherEvaluator, StatesHonestErrorsForLightIntoOtherRooms) {
  LitRoom flat = make_eight_room_flat();
  flat.emitters = {flat.emitters[2]};
  std::vector<Receiver> receivers;
  for (std::size_t r = 0; r < flat.receivers.size(); r += 5) receivers.push_back(flat.receivers[r]);
  const RayScene rays(flat.scene);
  const Eigen::VectorXd lit = Eigen::VectorXd::Ones(1);
  std::vector<TransportMatrix> runs;
  for (const std::uint64_t seed : {1, 2}) {
    EvaluateOptions options = within(1, seed);
    options.wanted_rms_error = 0.2;
    runs.push_back(evaluated(make_path_evaluator(rays), receivers, flat.emitters, options));
    runs.push_back(evaluated(make_gather_evaluator(rays), receivers, flat.emitters, options));
  }
  int within_two = 0, pairs = 0;
  for (std::size_t a = 0; a < runs.size(); ++a) {
    EXPECT_LE(runs[a].rms_error, 0.2);
    EXPECT_GT(runs[a].standard_error_lux(lit).minCoeff(), 0);
    for (std::size_t b = 0; b < a; ++b) {
      const Eigen::ArrayXd off_lx = (runs[a].lux(lit) - runs[b].lux(lit)).array().abs();
      const Eigen::ArrayXd squares =
          runs[a].standard_error_lux(lit).array().square() + runs[b].standard_error_lux(lit).array().square();
      within_two += static_cast<int>((off_lx <= 2 * squares.sqrt()).count());
      pairs += static_cast<int>(off_lx.size());
    }
  }
  EXPECT_GE(within_two, 0.93 * pairs);
}

// Where paths find no light, they go on until darkness is known to the wanted error.
TEST(PathEvaluator, APointInAClosedBoxIsDarkWithinTheWantedError) {
  Scene scene;
  scene.materials.resize(1);
  scene.materials[0].reflectance_rgb.setConstant(0.5);
  add_box(scene, {0, 0, 0}, {4, 4, 3});
  add_box(scene, {3, 3, 1}, {3.5, 3.5, 1.5});
  const RayScene rays(scene);
  const std::vector<Receiver> receivers = {{{3.25, 3.25, 1.2}, Vec3::UnitZ()}, {{1, 1, 0.5}, Vec3::UnitZ()}};
  const auto path = evaluated(make_path_evaluator(rays), receivers, {bulb(800, {2, 2, 2.5})}, within(0.05));
  EXPECT_EQ(path.lux_per_level(0, 0), 0);
  EXPECT_GT(path.standard_error_lux(Eigen::VectorXd::Ones(1))[0], 0);
  EXPECT_LE(path.relative_error, 0.05 / EvaluateOptions::kStopMargin);
}

// The noise of the receivers' own paths may be below the error they share through records. That error has to fall, too.
TEST(GatherEvaluator, AFineRmsErrorIncludesTheErrorOfRecords) {
  const LitRoom room = make_box_room();
  const RayScene rays(room.scene);
  for (const double wanted : {0.004, 0.002}) {
    EvaluateOptions options = within(1);
    options.wanted_rms_error = wanted;
    const auto gather = evaluated(make_gather_evaluator(rays), room.receivers, room.emitters, options);
    const Eigen::VectorXd levels = Eigen::VectorXd::Ones(gather.emitters());
    const Eigen::ArrayXd stated = gather.standard_error_lux(levels).array() / gather.lux(levels).array();
    EXPECT_LE(std::sqrt(stated.square().mean()), 1.1 * wanted) << "what is shared goes up and down by replicates";
    EXPECT_LE(gather.rms_error, wanted);
  }
}

/// Integrating sphere whose walls reflect each primary differently: each follows its own ρ/(1-ρ).
TEST(PathEvaluator, EachPrimaryFollowsItsOwnReflectance) {
  Scene sphere = make_icosphere(2, 4, 0.5);
  const Vec3 reflectance(0.8, 0.5, 0.2);
  sphere.materials[0].reflectance_rgb = reflectance;
  const RayScene rays(sphere);
  const Vec3 warm = Vec3(1.6, 0.9, 0.2) / (0.2126 * 1.6 + 0.7152 * 0.9 + 0.0722 * 0.2);
  std::vector<Emitter> lamp = {bulb(1000, Vec3::Zero())};
  lamp[0].colour_rgb = warm;
  std::vector<Receiver> receivers;
  for (const WallPoint& p : spread_over_walls(sphere, 30, Vec3::Zero())) receivers.push_back({p.position_m, p.normal});
  EvaluateOptions options = within(0.02);
  options.colour = true;
  for (const auto& make : {make_path_evaluator, make_gather_evaluator}) {
    const auto matrix = evaluated(make(rays), receivers, lamp, options);
    ASSERT_EQ(matrix.rgb_per_level.size(), 3u);
    for (Eigen::Index r = 0; r < matrix.receivers(); ++r) {
      double lux = 0;
      for (int c = 0; c < 3; ++c) {
        const double reflected_lx = warm[c] * reflected_wall_illuminance_lx(1000, area_m2(sphere), reflectance[c]);
        const double expected_lx = warm[c] * matrix.direct_lux_per_level(r, 0) + reflected_lx;
        // The wanted error is that of the total. A single primary with high reflectance may err more.
        const double got_lx = matrix.rgb_per_level[static_cast<std::size_t>(c)](r, 0);
        EXPECT_NEAR(got_lx, expected_lx, 0.05 * expected_lx) << "receiver " << r << " primary " << c;
        lux += Vec3(0.2126, 0.7152, 0.0722)[c] * got_lx;
      }
      EXPECT_NEAR(lux, matrix.lux_per_level(r, 0), 1e-9 * lux);
    }
  }
}

/// A closed room keeps all light that its walls do not absorb, glossy or not. The albedo is a(θ) = Es + ρ (1 - Es) with
/// ρ of the body alone. So the mean over the walls lies between matt rooms of the lowest and the highest albedo.
TEST(PathEvaluator, AGlossyRoomKeepsAllReflectedLight) {
  Scene cube = make_cube(2, 0.5);
  std::vector<Receiver> receivers;
  for (const WallPoint& p : cube_wall_grid(2, 8)) receivers.push_back({p.position_m, p.normal});
  const auto mean_lx = [&](double specular, double roughness) {
    cube.materials[0].specular_reflectance = specular;
    cube.materials[0].roughness = roughness;
    const RayScene rays(cube);
    return evaluated(make_path_evaluator(rays), receivers, {bulb(1000, {0.1, 0.2, 0.1})}, within(0.05))
        .lux_per_level.mean();
  };
  const double matt_lx = mean_lx(0, 0.5);
  EXPECT_NEAR(matt_lx, mean_wall_illuminance_lx(1000, area_m2(cube), 0.5), 0.01 * matt_lx);
  // Coat of 0.04: albedo from 0.52 at normal incidence to about 0.6 averaged over the hemisphere.
  const double varnished_lx = mean_lx(0.04, 0.4);
  EXPECT_GT(varnished_lx, mean_wall_illuminance_lx(1000, area_m2(cube), 0.51));
  EXPECT_LT(varnished_lx, mean_wall_illuminance_lx(1000, area_m2(cube), 0.60));
}

/// A luminaire with size is reflected like the point lamps that would fill it.
TEST(PathEvaluator, APanelIsReflectedLikeManyPointsInItsPlace) {
  const RayScene rays(make_cube(3, 0.6));
  Emitter panel = bulb(1000, {0.2, 0.1, 1.2});
  panel.intensity = make_lambertian(1000);
  panel.shape = {LuminousShape::Kind::rectangle, {1.0, 0.6, 0}};
  std::vector<Emitter> points;
  constexpr int kX = 10, kY = 6;
  for (int i = 0; i < kX; ++i)
    for (int j = 0; j < kY; ++j) {
      Emitter point = panel;
      point.shape = {};
      point.intensity = make_lambertian(1000.0 / (kX * kY));
      point.world_from_lamp.translation_m += Vec3((i + 0.5) / kX - 0.5, 0.6 * ((j + 0.5) / kY - 0.5), 0);
      points.push_back(point);
    }
  const std::vector<Receiver> receivers = {
      {{0.1, 0.2, -1.5}, Vec3::UnitZ()}, {{-1.5, 0.3, 0.2}, Vec3::UnitX()}, {{0.3, 0.2, 1.5}, -Vec3::UnitZ()}};
  const auto one = evaluated(make_path_evaluator(rays), receivers, {panel}, within(0.01));
  const auto many = evaluated(make_path_evaluator(rays), receivers, points, within(0.01, 5));
  const Eigen::VectorXd all = many.lux(Eigen::VectorXd::Ones(kX * kY));
  for (Eigen::Index r = 0; r < 3; ++r) EXPECT_NEAR(one.lux_per_level(r, 0), all[r], 0.02 * all[r]) << r;
}

/// A uniform sky over an open box. Reflected light is less than ρ/(1-ρ) of the light that enters.
TEST(PathEvaluator, SkylightEntersThroughAnOpeningAndIsReflected) {
  Scene box = make_cube(2, 0.5);
  // Remove the lid: the two triangles whose vertices all lie at z = 1.
  for (std::size_t t = box.triangles.size(); t-- > 0;) {
    bool lid = true;
    for (const auto v : box.triangles[t]) lid = lid && box.vertex_world_m(v).z() > 0.99;
    if (!lid) continue;
    box.triangles.erase(box.triangles.begin() + static_cast<std::ptrdiff_t>(t));
    box.material_of_triangle.erase(box.material_of_triangle.begin() + static_cast<std::ptrdiff_t>(t));
    box.object_of_triangle.erase(box.object_of_triangle.begin() + static_cast<std::ptrdiff_t>(t));
  }
  ASSERT_EQ(box.triangles.size(), 10u);
  Emitter sky;
  sky.sky = make_uniform_sky(10'000);
  const std::vector<Receiver> floor = {{{0, 0, -1}, Vec3::UnitZ()}};
  const RayScene rays(box);
  const auto matrix = evaluated(make_path_evaluator(rays), floor, {sky}, within(0.01));
  // From the middle of a square floor of edge 2 to a parallel square of edge 2 at distance 2: four times the corner
  // form factor of a quarter, a = b = 1, h = 2.
  const double a = 0.5;
  const double corner = (a / std::sqrt(1 + a * a) * std::atan(a / std::sqrt(1 + a * a))) / kPi;
  EXPECT_NEAR(matrix.direct_lux_per_level(0, 0), 4 * corner * 10'000, 0.01 * 4 * corner * 10'000);
  // All light that enters falls on the walls: 10 000 lx through 4 m². Reflected light is at most ρ/(1-ρ) of it spread
  // over the walls. Some leaves through the opening.
  const double reflected_lx = matrix.lux_per_level(0, 0) - matrix.direct_lux_per_level(0, 0);
  EXPECT_GT(reflected_lx, 0.3 * 10'000 * 4 / 20 * 0.5);
  EXPECT_LT(reflected_lx, 10'000 * 4.0 / 20 * 2);
}

}  // namespace
}  // namespace luxrig
