// glass: accuracy over many samples.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/transport/candidates/incremental_transport.h"
#include "core/transport/evaluator.h"
#include "tests/core/transport/glass_fixture.h"
#include "tests/core/transport/within.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig {
namespace {

using namespace glass_fixture;

/// Double precision, analytic walls, the lamp sampled at each bounce. Slow; shares no code with the evaluators.
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
        // Distance to the nearest of the six walls.
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

TEST(Glass, PathsAgreeWithAnIndependentRandomWalk) {
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

}  // namespace
}  // namespace luxrig
