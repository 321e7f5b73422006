/// gather_evaluator: accuracy over many samples.

#include <gtest/gtest.h>

#include "tests/core/transport/boxes.h"
#include "tests/core/transport/paths/gather_evaluator_fixture.h"
#include "tests/core/transport/within.h"
#include "tools/bench/rooms/enclosures.h"
#include "tools/bench/rooms/lit_room.h"

namespace luxrig {
namespace {

using namespace gather_evaluator_fixture;

/// Root mean square of (a - b) / b over receivers.
double apart(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return std::sqrt(((a - b).array() / b.array()).square().mean());
}

TEST(GatherEvaluator, AgreesWithPathsInTheFlatForFarFewerRays) {
  const LitRoom flat = make_eight_room_flat();
  const RayScene rays(flat.scene);
  const auto gather = evaluated(make_gather_evaluator(rays), flat.receivers, flat.emitters, within(0.05));
  const auto path = evaluated(make_path_evaluator(rays), flat.receivers, flat.emitters, within(0.05, 2));
  const Eigen::VectorXd levels = Eigen::VectorXd::Ones(gather.emitters());
  const Eigen::VectorXd error_lx = gather.standard_error_lux(levels), path_error_lx = path.standard_error_lux(levels);
  int outside = 0;
  for (Eigen::Index r = 0; r < gather.receivers(); ++r)
    outside += std::abs(gather.lux(levels)[r] - path.lux(levels)[r]) > 3 * std::hypot(error_lx[r], path_error_lx[r]);
  EXPECT_LE(outside, gather.receivers() / 30);
  EXPECT_LT(apart(gather.lux(levels), path.lux(levels)), 0.035) << "each has 0.016 of its own";
  EXPECT_LT(gather.rays, path.rays);
}

TEST(GatherEvaluator, ReachesSmallErrorsMoreCheaplyThanPaths) {
  // Records have their own noise, which more paths ending in them do not reduce.
  const LitRoom room = make_box_room();
  const RayScene rays(room.scene);
  const auto gather = evaluated(make_gather_evaluator(rays), room.receivers, room.emitters, within(0.01));
  const auto path = evaluated(make_path_evaluator(rays), room.receivers, room.emitters, within(0.01, 2));
  EXPECT_LE(gather.relative_error, 0.01);
  EXPECT_LT(gather.rays, path.rays);
  const Eigen::VectorXd levels = Eigen::VectorXd::Ones(gather.emitters());
  EXPECT_LT(apart(gather.lux(levels), path.lux(levels)), 0.01) << "0.004 each, and 0.003 of bias";
}

TEST(GatherEvaluator, EndsInARoomWhereNoPointCanShare) {
  // All walls varnished, the lamp in a corner: no record can be used. With this seed all points go on alone after 14
  // million rays.
  Scene box = make_cube(4, 0.3);
  for (auto& corner : box.vertices_m) corner.z() *= 0.75f;
  for (Material& wall : box.materials) wall.specular_reflectance = 0.04, wall.roughness = 0.1;
  const RayScene rays(box);
  std::vector<Receiver> receivers;
  for (int i = 0; i < 30; ++i)
    receivers.push_back({{-1.6 + 0.6 * (i % 6), -1.6 + 0.6 * (i / 6), -1.4995}, Vec3::UnitZ()});
  EvaluateOptions options = within(0.01, 3);
  options.max_rays = 15'000'000;
  const auto gather = evaluated(make_gather_evaluator(rays), receivers, {bulb(3000, {-1.95, -1.95, 1.45})}, options);
  EXPECT_TRUE((gather.lux_per_level.array() > 0).all());
}

TEST(GatherEvaluator, ReachesAnRmsErrorWithFewerRaysThanThatErrorEverywhere) {
  const LitRoom flat = make_eight_room_flat();
  const RayScene rays(flat.scene);
  // Sampling stops when 2.5 standard errors are within the wanted error at each receiver.
  const auto of_each = evaluated(make_gather_evaluator(rays), flat.receivers, flat.emitters, within(0.03));
  EvaluateOptions options = within(0.03, 2);
  options.wanted_rms_error = 0.03 / 2.5;
  const auto by_rms = evaluated(make_gather_evaluator(rays), flat.receivers, flat.emitters, options);
  EXPECT_LT(by_rms.rays, of_each.rays);
  const Eigen::VectorXd levels = Eigen::VectorXd::Ones(by_rms.emitters());
  const Eigen::ArrayXd stated = by_rms.standard_error_lux(levels).array() / by_rms.lux(levels).array();
  EXPECT_LE(by_rms.rms_error, options.wanted_rms_error) << "with what records are off by";
  EXPECT_NEAR(std::sqrt(stated.square().mean()), by_rms.rms_error, 0.1 * by_rms.rms_error);
  EXPECT_GT(by_rms.relative_error, by_rms.rms_error);
  EXPECT_LT(apart(by_rms.lux(levels), of_each.lux(levels)), 1.5 * std::hypot(0.012, 0.012));
}

// Records do badly in a sphere of high reflectance, where light comes from many bounces, and on a glossy floor. There
// the wanted error was once missed silently. It must be reached, and the stated error must hold.
TEST(GatherEvaluator, ReachesTheWantedErrorWhereRecordsPerformBadly) {
  Scene sphere = make_icosphere(2, 4, 0.9);
  std::vector<Receiver> receivers;
  for (const WallPoint& p : spread_over_walls(sphere, 40, Vec3::Zero())) receivers.push_back({p.position_m, p.normal});
  const RayScene rays(sphere);
  for (const bool by_rms : {true, false}) {
    EvaluateOptions options = within(0.005);
    options.wanted_rms_error = by_rms ? 0.005 : 0;
    const auto gather = evaluated(make_gather_evaluator(rays), receivers, {bulb(1000, Vec3::Zero())}, options);
    EXPECT_LE(by_rms ? gather.rms_error : EvaluateOptions::kStopMargin * gather.relative_error, 0.005);
    const Eigen::VectorXd exact_lx =
        gather.direct_lux_per_level.col(0).array() + reflected_wall_illuminance_lx(1000, area_m2(sphere), 0.9);
    const Eigen::ArrayXd off_lx = (gather.lux_per_level.col(0) - exact_lx).array().abs(),
                         bar_lx = gather.standard_error_lux(Eigen::VectorXd::Ones(1)).array();
    EXPECT_LE(apart(gather.lux_per_level.col(0), exact_lx), 1.5 * 0.005);
    EXPECT_GE((off_lx <= 2 * bar_lx).count(), 34);
  }
  const LitRoom gallery = make_gallery_hall(1, true);
  const RayScene hall(gallery.scene);
  EvaluateOptions options = within(0.05);
  const auto gather = evaluated(make_gather_evaluator(hall), gallery.receivers, gallery.emitters, options);
  EXPECT_LE(EvaluateOptions::kStopMargin * gather.relative_error, 0.05 * 1.0001);
}

TEST(PathEvaluator, ReachesAnRmsErrorAndRefusesANegativeOne) {
  const LitRoom room = make_box_room();
  const RayScene rays(room.scene);
  EvaluateOptions options = within(1);
  options.wanted_rms_error = 0.01;
  const auto path = evaluated(make_path_evaluator(rays), room.receivers, room.emitters, options);
  const Eigen::VectorXd levels = Eigen::VectorXd::Ones(path.emitters());
  const Eigen::ArrayXd stated = path.standard_error_lux(levels).array() / path.lux(levels).array();
  EXPECT_LE(std::sqrt(stated.square().mean()), 0.0101);
  EXPECT_GT(stated.maxCoeff(), 0.01) << "some keep larger ones";
  EXPECT_LE(path.rms_error, 0.01);
  EXPECT_NEAR(path.relative_error, stated.maxCoeff(), 1e-3);
  options.wanted_rms_error = -0.01;
  EXPECT_FALSE(make_path_evaluator(rays)->evaluate(room.receivers, room.emitters, options).has_value());
}

}  // namespace
}  // namespace luxrig
