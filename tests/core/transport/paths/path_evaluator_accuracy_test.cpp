/// path_evaluator: accuracy over many samples.
#include <gtest/gtest.h>

#include <random>

#include "core/transport/evaluator.h"
#include "core/transport/replicate_error.h"
#include "tests/core/transport/cube_radiosity.h"
#include "tests/core/transport/lamp_pose.h"
#include "tests/core/transport/paths/path_evaluator_fixture.h"
#include "tests/core/transport/within.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig {
namespace {

using namespace path_evaluator_fixture;

// A closed enclosure conserves flux, so the mean over its walls is known for any position of the source. Few paths per
// receiver are enough because estimates are unbiased. The midpoint rule over the grid is good to 0.2 %.
TEST(PathEvaluator, MeanOfAClosedCubeIsFluxOverAreaTimesOneMinusReflectance) {
  std::vector<Receiver> receivers;
  for (const WallPoint& p : cube_wall_grid(3, 12)) receivers.push_back({p.position_m, p.normal});
  for (const double reflectance : {0.2, 0.5, 0.8}) {
    const Scene cube = make_cube(3, reflectance);
    const RayScene rays(cube);
    const double expected_lx = mean_wall_illuminance_lx(1000, area_m2(cube), reflectance);
    EvaluateOptions options = within(0.005);
    options.max_rays = 2'000'000;
    const auto matrix = path(rays, receivers, {bulb_at(1000, {0.3, -0.2, 0.4})}, options);
    // Receivers share light vertices, so their errors correlate. The error of the mean is the error of the replicates'
    // means.
    std::vector<double> means_lx;
    for (const auto& replicate : matrix.replicates) means_lx.push_back(replicate.mean());
    const double error_lx = standard_error_of_mean(means_lx);
    EXPECT_NEAR(matrix.lux_per_level.mean(), expected_lx, 0.005 * expected_lx) << "reflectance " << reflectance;
    EXPECT_NEAR(matrix.lux_per_level.mean(), expected_lx, 3 * error_lx + 0.002 * expected_lx);
  }
}

TEST(PathEvaluator, IntegratingSphereReflectsTheSameLightEverywhere) {
  for (const double reflectance : {0.3, 0.9}) {
    const Scene sphere = make_icosphere(2, 4, reflectance);
    const RayScene rays(sphere);
    const double ideal_lx = reflected_wall_illuminance_lx(1000, 4 * kPi * 4, reflectance);
    const double tessellated_lx = reflected_wall_illuminance_lx(1000, area_m2(sphere), reflectance);
    EXPECT_NEAR(tessellated_lx, ideal_lx, 0.005 * ideal_lx);
    const auto matrix = path(rays, receivers_on(sphere, 4), {bulb_at(1000, Vec3::Zero())}, within(0.005));
    const Eigen::VectorXd error_lx = matrix.standard_error_lux(Eigen::VectorXd::Ones(1));
    for (Eigen::Index r = 0; r < matrix.receivers(); ++r) {
      const double reflected_lx = matrix.lux_per_level(r, 0) - matrix.direct_lux_per_level(r, 0);
      // Facets are seen slightly tilted, so the wall is uniform only to the square of their half angle (0.03²).
      EXPECT_NEAR(reflected_lx, tessellated_lx, 3 * error_lx[r] + 0.001 * tessellated_lx) << r;
      EXPECT_NEAR(reflected_lx, tessellated_lx, 0.005 * matrix.lux_per_level(r, 0)) << r;
    }
  }
}

// Panels that fill their walls: every place gets M directly and M ρ/(1 − ρ) by reflection.
TEST(PathEvaluator, FlushWallPanelsAreReflectedInFull) {
  constexpr double kEdge_m = 3, kReflectance = 0.5, kExitance_lm_m2 = 100;
  const Scene scene = make_cube(kEdge_m, kReflectance);
  const RayScene rays(scene);
  std::vector<Emitter> panels;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      Emitter panel{make_lambertian(kExitance_lm_m2 * kEdge_m * kEdge_m), {}};
      panel.shape = {LuminousShape::Kind::rectangle, {kEdge_m, kEdge_m, 0}};
      const Vec3 x = Vec3::Unit((axis + 1) % 3), z = side * Vec3::Unit(axis);  // light leaves along -z
      panel.world_from_lamp.rotation << x, z.cross(x), z;
      panel.world_from_lamp.translation_m = side * kEdge_m / 2 * Vec3::Unit(axis);
      panels.push_back(panel);
    }
  const std::vector<Receiver> receivers = {
      {{0.2, -0.3, 0.1}, Vec3::UnitZ()}, {{-0.8, 0.5, -0.9}, Vec3(1, 1, 1).normalized()}, {{1, 1, 1}, -Vec3::UnitX()}};
  EvaluateOptions options;
  options.wanted_relative_error = 0.003;
  for (const bool gather : {false, true}) {
    const auto made =
        (gather ? make_gather_evaluator(rays) : make_path_evaluator(rays))->evaluate(receivers, panels, options);
    ASSERT_TRUE(made) << made.error().detail;
    const Eigen::VectorXd lux = made->lux(Eigen::VectorXd::Ones(6));
    for (Eigen::Index r = 0; r < lux.size(); ++r) EXPECT_NEAR(lux[r], kExitance_lm_m2 / (1 - kReflectance), 3) << r;
  }
}

// All walls have the radiance ρE/π: every receiver inside gets ρE of reflected light in any direction.
TEST(PathEvaluator, AFurnaceGivesEqualReflectedLightEverywhere) {
  const double reflectance = 0.7;
  const Scene sphere = make_icosphere(2, 4, reflectance);
  const RayScene rays(sphere);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Receiver> receivers;
  for (int i = 0; i < 12; ++i)
    receivers.push_back({0.9 * Vec3(unit(random), unit(random), unit(random)),
                         Vec3(unit(random), unit(random), unit(random)).normalized()});
  const auto matrix = path(rays, receivers, {bulb_at(1000, Vec3::Zero())}, within(0.005));
  const double expected_lx = reflected_wall_illuminance_lx(1000, area_m2(sphere), reflectance);
  const Eigen::VectorXd error_lx = matrix.standard_error_lux(Eigen::VectorXd::Ones(1));
  for (Eigen::Index r = 0; r < matrix.receivers(); ++r)
    EXPECT_NEAR(matrix.lux_per_level(r, 0) - matrix.direct_lux_per_level(r, 0), expected_lx,
                std::min(3 * error_lx[r], 0.005 * matrix.lux_per_level(r, 0)) + 0.001 * expected_lx);
}

TEST(PathEvaluator, AgreesWithRadiosityAtPointsOfACube) {
  const double reflectance = 0.6, edge_m = 2;
  const Vec3 source_m(0.35, -0.2, 0.45);
  const Scene cube = make_cube(edge_m, reflectance);
  const RayScene rays(cube);
  std::vector<Receiver> receivers = receivers_on(cube, 48);
  std::erase_if(receivers, [](const Receiver& r) {  // patches are too coarse a reference near edges
    return (r.position_world_m.cwiseAbs().array() > 0.8).count() > 1;
  });
  ASSERT_GT(receivers.size(), 20u);
  const auto matrix = path(rays, receivers, {bulb_at(1000, source_m)}, within(0.005));
  const Eigen::VectorXd error_lx = matrix.standard_error_lux(Eigen::VectorXd::Ones(1));
  const CubeRadiosity coarse(edge_m, reflectance, 1000, source_m, 6), fine(edge_m, reflectance, 1000, source_m, 12);
  int far = 0;
  double chi2 = 0;
  for (Eigen::Index r = 0; r < matrix.receivers(); ++r) {
    const Receiver& receiver = receivers[static_cast<std::size_t>(r)];
    const double reference_lx = fine.reflected_lx(receiver.position_world_m, receiver.normal_world);
    // Error of the patches falls with the square of their size: a third of the change from coarse to fine.
    const double reference_error_lx =
        std::abs(reference_lx - coarse.reflected_lx(receiver.position_world_m, receiver.normal_world)) / 3;
    ASSERT_LT(reference_error_lx, 0.002 * reference_lx);
    const double reflected_lx = matrix.lux_per_level(r, 0) - matrix.direct_lux_per_level(r, 0);
    far += std::abs(reflected_lx - reference_lx) > 3 * error_lx[r] + reference_error_lx;
    EXPECT_NEAR(matrix.lux_per_level(r, 0), reference_lx + matrix.direct_lux_per_level(r, 0),
                0.01 * matrix.lux_per_level(r, 0) + reference_error_lx)
        << "receiver " << r;
    chi2 += std::pow((reflected_lx - reference_lx) / (error_lx[r] + reference_error_lx), 2);
  }
  EXPECT_LE(far, 1) << "of " << matrix.receivers() << " beyond three standard errors";
  EXPECT_LT(chi2 / static_cast<double>(matrix.receivers()), 2.0);
}

TEST(PathEvaluator, ReportedErrorsHoldAsOftenAsStated) {
  const Scene cube = make_cube(2, 0.5);
  const RayScene rays(cube);
  // A narrow spot makes a small bright patch, a hard case for sampling. The receiver sees it but gets no direct light.
  const std::vector<Emitter> emitters = {
      {make_spot(900, rad_from_deg(24), rad_from_deg(40)), lamp_at({0.3, 0.2, 0.9}, {0.4, -0.3, -1})},
      bulb_at(300, {-0.5, 0.1, 0.2})};
  const std::vector<Receiver> receivers = {{{0.1, 0.2, -1}, Vec3::UnitZ()}, {{-1, 0.3, 0.2}, Vec3::UnitX()}};
  const Eigen::VectorXd levels = Eigen::VectorXd::Ones(2);
  const auto truth = path(rays, receivers, emitters, within(0.004, 4711));
  int within_two = 0, within_four = 0, trials = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const auto matrix = path(rays, receivers, emitters, within(0.03, seed));
    const Eigen::VectorXd error_lx = matrix.standard_error_lux(levels);
    const Eigen::VectorXd off_lx = (matrix.lux(levels) - truth.lux(levels)).cwiseAbs();
    for (Eigen::Index r = 0; r < 2; ++r, ++trials) {
      within_two += off_lx[r] < 2 * error_lx[r];
      within_four += off_lx[r] < 4 * error_lx[r];
    }
  }
  EXPECT_GE(within_two, 0.9 * trials) << within_two << " of " << trials;  // 0.955 expected, binomial spread 0.015
  EXPECT_GE(within_four, 0.985 * trials);
}

TEST(PathEvaluator, IsUnbiasedOverSeeds) {
  const Scene cube = make_cube(2, 0.8);
  const RayScene rays(cube);
  const Vec3 source_m(0.35, -0.2, 0.45);
  const Receiver receiver{{0.3, 0.1, -1}, Vec3::UnitZ()};
  EvaluateOptions options = within(10);  // stops at once: fewest samples, where a bias would show most
  double sum = 0, squares = 0;
  constexpr int kSeeds = 100;
  for (int seed = 0; seed < kSeeds; ++seed) {
    options.seed = 1000 + seed;
    const auto matrix = path(rays, {receiver}, {bulb_at(1000, source_m)}, options);
    const double lux = matrix.lux_per_level(0, 0) - matrix.direct_lux_per_level(0, 0);
    sum += lux / kSeeds;
    squares += lux * lux / kSeeds;
  }
  const double error_lx = std::sqrt((squares - sum * sum) / kSeeds);
  const double reference_lx =
      CubeRadiosity(2, 0.8, 1000, source_m, 12).reflected_lx(receiver.position_world_m, receiver.normal_world);
  EXPECT_NEAR(sum, reference_lx, 4 * error_lx + 0.001 * reference_lx);
}

}  // namespace
}  // namespace luxrig
