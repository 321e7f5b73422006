// Light through panes: every evaluator that knows them against closed forms and an independent random walk.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/transport/candidates/incremental_transport.h"
#include "core/transport/evaluator.h"
#include "tests/core/transport/candidates/computed.h"
#include "tests/core/transport/within.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig {
namespace {

constexpr double kHalf_m = 1.5;

/// A pane right across the cube.
std::vector<Pane> pane_at(double z_m, double transmittance) {
  const Vec3 a(-2, -2, z_m), b(2, -2, z_m), c(2, 2, z_m), d(-2, 2, z_m);
  return {{{a, b, c}, transmittance, 0}, {{a, c, d}, transmittance, 0}};
}

Emitter bulb_at(const Vec3& position_m) { return {make_isotropic(1000), {Mat3::Identity(), position_m}}; }

/// Double precision, analytic walls, one lamp asked at each bounce: slow, and shares nothing with the evaluators.
class RandomWalk {
 public:
  RandomWalk(double reflectance, double pane_z_m, double transmittance, const Vec3& lamp_m)
      : reflectance_(reflectance), pane_z_m_(pane_z_m), transmittance_(transmittance), lamp_m_(lamp_m) {}

  double lux(const Receiver& at, int walks, unsigned seed) const {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    double sum = 0;
    for (int i = 0; i < walks; ++i) {
      Vec3 place = at.position_world_m, normal = at.normal_world;
      double weight = 1;
      for (int bounce = 0; bounce < 40; ++bounce) {
        sum += weight * direct(place, normal);
        const double r = std::sqrt(uniform(random)), phi = 2 * kPi * uniform(random);
        const Vec3 x = normal.unitOrthogonal(), y = normal.cross(x);
        const Vec3 way = r * std::cos(phi) * x + r * std::sin(phi) * y + std::sqrt(1 - r * r) * normal;
        // To the nearest of the six walls.
        double nearest = HUGE_VAL;
        Vec3 wall;
        for (int axis = 0; axis < 3; ++axis) {
          if (way[axis] == 0) continue;
          const double side = way[axis] > 0 ? 1 : -1, t = (side * kHalf_m - place[axis]) / way[axis];
          if (t < 1e-9 || t >= nearest) continue;
          nearest = t;
          wall = -side * Vec3::Unit(axis);
        }
        const Vec3 next = place + nearest * way;
        weight *= reflectance_ * through(place, next);
        place = next;
        normal = wall;
      }
    }
    return sum / walks;
  }

  double direct(const Vec3& place, const Vec3& normal) const {
    const Vec3 away_m = lamp_m_ - place;
    const double d2 = away_m.squaredNorm();
    return std::max(0.0, normal.dot(away_m)) / std::sqrt(d2) / d2 * 1000 / (4 * kPi) * through(place, lamp_m_);
  }

 private:
  double through(const Vec3& a, const Vec3& b) const {
    if ((a.z() - pane_z_m_) * (b.z() - pane_z_m_) >= 0) return 1;
    return pane_transmittance(transmittance_, (b - a).normalized().z());
  }

  double reflectance_, pane_z_m_, transmittance_;
  Vec3 lamp_m_;
};

std::vector<Receiver> some_receivers() {
  return {{{0.2, -0.4, -kHalf_m}, Vec3::UnitZ()},
          {{-kHalf_m, 0.3, -0.5}, Vec3::UnitX()},
          {{0.5, kHalf_m, 0.9}, -Vec3::UnitY()},
          {{-0.6, 0.1, 0.1}, -Vec3::UnitZ()}};
}

TEST(Glass, PathsAgreeWithARandomWalkOfIndependentMake) {
  const Vec3 lamp_m(0.4, -0.3, 0.8);
  const std::vector<Receiver> receivers = some_receivers();
  for (const double transmittance : {0.9, 0.35}) {
    Scene cube = make_cube(2 * kHalf_m, 0.6);
    cube.panes = pane_at(0.25, transmittance);
    const RayScene rays(cube);
    const RandomWalk walk(0.6, 0.25, transmittance, lamp_m);
    const Emitter lamp = bulb_at(lamp_m);
    const auto path = make_path_evaluator(rays)->evaluate(receivers, {&lamp, 1}, within(0.002));
    const auto gather = make_gather_evaluator(rays)->evaluate(receivers, {&lamp, 1}, within(0.005));
    ASSERT_TRUE(path && gather);
    for (std::size_t r = 0; r < receivers.size(); ++r) {
      const auto row = static_cast<Eigen::Index>(r);
      const double expected_lx = walk.lux(receivers[r], 60000, 11 + static_cast<unsigned>(r));
      const double direct_lx = walk.direct(receivers[r].position_world_m, receivers[r].normal_world);
      EXPECT_NEAR(path->direct_lux_per_level(row, 0), direct_lx, 1e-5 * direct_lx + 1e-9) << r;
      EXPECT_NEAR(path->lux_per_level(row, 0), expected_lx, 0.015 * expected_lx) << transmittance << ", " << r;
      EXPECT_NEAR(gather->lux_per_level(row, 0), expected_lx, 0.02 * expected_lx) << transmittance << ", " << r;
    }
  }
}

TEST(Glass, ThatTakesNothingChangesNothing) {
  const Scene bare = make_cube(2 * kHalf_m, 0.5);
  Scene cube = bare;
  cube.panes = pane_at(0.25, 1);
  const RayScene with(cube), without(bare);
  const Emitter lamp = bulb_at({0.1, 0.2, 0.9});
  const auto a = make_path_evaluator(with)->evaluate(some_receivers(), {&lamp, 1}, within(0.01));
  const auto b = make_path_evaluator(without)->evaluate(some_receivers(), {&lamp, 1}, within(0.01));
  ASSERT_TRUE(a && b);
  EXPECT_LT((a->lux_per_level - b->lux_per_level).cwiseAbs().maxCoeff(), 1e-9 * b->lux_per_level.maxCoeff());
}

TEST(Glass, DimsWhatHasSizeAndWhatStandsInTheOpen) {
  // Nothing but a pane: no triangle stops a ray, and light is weighed all the same.
  Scene scene;
  scene.panes = pane_at(1, 0.8);
  const RayScene rays(scene);
  const std::vector<Receiver> below = {{{0, 0, 0}, Vec3::UnitZ()}};
  std::vector<Emitter> lamps = {bulb_at({0, 0, 2}), {make_lambertian(500), {Mat3::Identity(), {0, 0, 3}}}};
  lamps[1].shape = {LuminousShape::Kind::disk, Vec3(0.2, 0, 0)};
  const auto lit = make_direct_evaluator(rays)->evaluate(below, lamps, within(1e-3));
  const auto bare = make_direct_evaluator(RayScene(Scene{}))->evaluate(below, lamps, within(1e-3));
  ASSERT_TRUE(lit && bare);
  EXPECT_NEAR(lit->lux_per_level(0, 0), 0.8 * bare->lux_per_level(0, 0), 1e-9 * bare->lux_per_level(0, 0));
  // Seen within 2° of head-on, where glass is as it is head-on.
  EXPECT_NEAR(lit->lux_per_level(0, 1), 0.8 * bare->lux_per_level(0, 1), 3e-3 * bare->lux_per_level(0, 1));
}

TEST(Glass, DimsTheDirectLightOfCandidates) {
  Scene cube = make_cube(2 * kHalf_m, 0.5);
  cube.panes = pane_at(0.25, 0.8);
  const RayScene rays(cube);
  const std::vector<Receiver> receivers = some_receivers();
  const Emitter lamp = bulb_at({0.3, 0.1, 0.9});
  const auto exact = make_direct_evaluator(rays)->evaluate(receivers, {&lamp, 1}, within(1e-3));
  ASSERT_TRUE(exact);
  IncrementalOptions options;
  options.indirect = false;
  const auto columns = IncrementalTransport::make(cube, rays, receivers, options);
  ASSERT_TRUE(columns);
  const auto column = (*columns)->direct_column(lamp);
  ASSERT_TRUE(column);
  EXPECT_LT((column->direct_lux - exact->lux_per_level.col(0)).cwiseAbs().maxCoeff(),
            1e-9 * exact->lux_per_level.maxCoeff());
  Eigen::MatrixXd anew = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(receivers.size()), 1);
  ASSERT_TRUE((*columns)->update_direct({&lamp, 1}, rays, rays.bounds_world_m(), anew));
  EXPECT_LT((anew - exact->lux_per_level).cwiseAbs().maxCoeff(), 1e-9 * exact->lux_per_level.maxCoeff());

  CandidateOptions of;
  of.indirect = false;
  const CandidateTransport streamed =
      computed(cube, rays, receivers, {{lamp.world_from_lamp.translation_m}, {bulb_at({0, 0, 0})}}, of);
  const Eigen::VectorXd streamed_lux = streamed.matrix.lux(receivers.size(), std::vector<double>{1});
  for (std::size_t r = 0; r < receivers.size(); ++r) {
    const auto row = static_cast<Eigen::Index>(r);
    EXPECT_NEAR(streamed_lux[row], exact->lux_per_level(row, 0), 1e-6 * exact->lux_per_level.maxCoeff()) << r;
  }
}

}  // namespace
}  // namespace luxrig
