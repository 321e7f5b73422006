#include "core/scene/panes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/scene/ray_scene.h"

namespace luxrig {
namespace {

/// Transmittance of a sheet; `passage` is that of one head-on passage inside. Sums every internal reflection, with
/// Fresnel's equations in their angles.
double summed_transmittance(double index, double passage, double incidence_rad) {
  const double inside_rad = std::asin(std::sin(incidence_rad) / index);
  const double sine = std::sin(incidence_rad - inside_rad) / std::sin(incidence_rad + inside_rad);
  const double tangent = std::tan(incidence_rad - inside_rad) / std::tan(incidence_rad + inside_rad);
  const double left = std::pow(passage, 1 / std::cos(inside_rad));
  double sum = 0;
  for (const double r : {sine * sine, tangent * tangent}) {
    double within = (1 - r) * left;
    for (int k = 0; k < 2000; ++k, within *= r * left * r * left) sum += within * (1 - r);
  }
  return sum / 2;
}

Pane triangle(const Vec3& a, const Vec3& b, const Vec3& c, double transmittance = 0.9, std::uint32_t object = 0) {
  return {{a, b, c}, transmittance, object};
}

/// A square pane across z, with its diagonal from corner to corner.
std::vector<Pane> square(double z_m, double half_m, std::uint32_t object, double transmittance = 0.9) {
  const Vec3 a(-half_m, -half_m, z_m), b(half_m, -half_m, z_m), c(half_m, half_m, z_m), d(-half_m, half_m, z_m);
  return {triangle(a, b, c, transmittance, object), triangle(a, c, d, transmittance, object)};
}

TEST(Panes, TransmitTheirStatedShare) {
  for (const double stated : {0.01, 0.3, 0.8, 0.9, 0.9183, 0.95, 0.99, 1.0}) {
    EXPECT_NEAR(pane_transmittance(stated, 1), stated, 1e-12);
    EXPECT_EQ(pane_transmittance(stated, 0), 0);
    double before = stated + 1e-12;
    for (double deg = 0; deg <= 90; deg += 0.5) {
      const double now = pane_transmittance(stated, std::cos(rad_from_deg(deg)));
      EXPECT_GE(now, 0);
      EXPECT_LE(now, 1);
      // Towards Brewster's angle one polarisation gains slightly before the other loses.
      EXPECT_LE(now, before + 1e-3) << stated << " at " << deg;
      before = now;
    }
  }
}

TEST(Panes, FollowFresnelWithAllInternalReflections) {
  // Clear glass of index 1.52 passes 2n / (n² + 1).
  const double clear = 2 * 1.52 / (1.52 * 1.52 + 1);
  for (const double deg : {10.0, 45.0, 56.66, 75.0, 88.0}) {
    const double incidence_rad = rad_from_deg(deg);
    EXPECT_NEAR(pane_transmittance(clear, std::cos(incidence_rad)), summed_transmittance(1.52, 1, incidence_rad), 1e-9)
        << deg;
    // Grey glass: the absorption of one passage follows from the stated value.
    const double r = std::pow(0.52 / 2.52, 2), passage = 0.6;
    const double stated = (1 - r) * (1 - r) * passage / (1 - r * r * passage * passage);
    EXPECT_NEAR(pane_transmittance(stated, -std::cos(incidence_rad)),
                summed_transmittance(1.52, passage, incidence_rad), 1e-9)
        << deg;
  }
}

TEST(Panes, CountOncePerPaneEvenOnTheirDiagonal) {
  const Panes one(square(1, 2, 0));
  for (const double x : {0.0, 0.3, -1.7, 1.999}) {
    EXPECT_NEAR(one.transmittance({x, x, 0}, {x, x, 3}, 0), 0.9, 1e-12) << "on the diagonal at " << x;
    EXPECT_NEAR(one.transmittance({x, x / 2, 3}, {x, x / 2, 0}, 0), 0.9, 1e-12);
  }
  EXPECT_EQ(one.transmittance({2.01, 0, 0}, {2.01, 0, 3}, 0), 1);
  EXPECT_EQ(one.transmittance({0, 0, 0}, {0, 0, 0.9}, 0), 1) << "it ends before";
  EXPECT_EQ(one.transmittance({0, 0, 0}, {0, 0, 1}, 1e-9), 1) << "it ends on it";
  EXPECT_EQ(one.transmittance({-3, 0, 1}, {3, 0, 1}, 0), 1) << "it runs within it";
  std::vector<Pane> two = square(1, 2, 0);
  for (const Pane& pane : square(1, 2, 1, 0.5)) two.push_back(pane);
  EXPECT_NEAR(Panes(two).transmittance({0.1, 0, 0}, {0.1, 0, 3}, 0), 0.45, 1e-12) << "two objects are two panes";
}

TEST(Panes, OfABoxCountEveryCrossingOfALine) {
  // The six faces of a box about the origin; the number of crossings is counted from its planes.
  std::vector<Pane> box;
  const Vec3 half_m(0.5, 0.4, 0.3);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Vec3 corners[4];
      for (int k = 0; k < 4; ++k) {
        corners[k][axis] = side * half_m[axis];
        corners[k][(axis + 1) % 3] = (k == 1 || k == 2 ? 1 : -1) * half_m[(axis + 1) % 3];
        corners[k][(axis + 2) % 3] = (k >= 2 ? 1 : -1) * half_m[(axis + 2) % 3];
      }
      box.push_back(triangle(corners[0], corners[1], corners[2]));
      box.push_back(triangle(corners[0], corners[2], corners[3]));
    }
  }
  const Panes panes(box);
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> place(-1, 1);
  int crossed[3] = {};
  for (int i = 0; i < 20000; ++i) {
    const Vec3 from(place(random), place(random), place(random)), to(place(random), place(random), place(random));
    double expected = 1;
    int times = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-1.0, 1.0}) {
        const double t = (side * half_m[axis] - from[axis]) / (to[axis] - from[axis]);
        if (!(t > 0 && t < 1)) continue;
        const Vec3 at = from + t * (to - from);
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        if (std::abs(at[u]) > half_m[u] || std::abs(at[v]) > half_m[v]) continue;
        expected *= pane_transmittance(0.9, (to - from).normalized()[axis]);
        ++times;
      }
    ASSERT_NEAR(panes.transmittance(from, to, 0), expected, 1e-9) << i;
    ASSERT_LE(times, 2);
    ++crossed[times];
  }
  for (const int count : crossed) EXPECT_GT(count, 100);
}

TEST(Panes, TolerateDegenerateAndInfiniteInput) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  std::vector<Pane> odd = square(1, 2, 0);
  odd.push_back(triangle({0, 0, 2}, {0, 0, 2}, {1, 0, 2}));
  odd.push_back(triangle({0, 0, nan}, {1, 0, 2}, {1, 1, 2}));
  odd.push_back(triangle({0, 0, inf}, {1, 0, 2}, {1, 1, 2}));
  const Panes panes(odd);
  EXPECT_NEAR(panes.transmittance({0.1, 0.2, 0}, {0.1, 0.2, 3}, 0), 0.9, 1e-12);
  for (const Vec3& bad : {Vec3(nan, 0, 0), Vec3(inf, 0, 0), Vec3(0.1, 0.2, 0)}) {
    const double share = panes.transmittance({0.1, 0.2, 0}, bad, 0);
    EXPECT_TRUE(share >= 0 && share <= 1) << share;
  }
  EXPECT_TRUE(Panes().empty());
  EXPECT_TRUE(Panes(std::span(odd).last(3)).empty());
  // Far from the origin the ends of a segment still touch their surfaces.
  Scene scene;
  scene.panes = square(0, 1, 0);
  for (Pane& pane : scene.panes)
    for (Vec3& corner : pane.corners_world_m) corner += Vec3(1e6, 1e6, 1e3);
  scene.origin_world_m = Vec3(1e6, 1e6, 1e3);
  const RayScene rays(scene);
  EXPECT_TRUE(rays.has_panes());
  EXPECT_NEAR(rays.transmittance(Vec3(1e6, 1e6, 999), Vec3(1e6, 1e6, 1001)), 0.9, 1e-9);
  EXPECT_EQ(rays.transmittance(Vec3(1e6, 1e6, 1000), Vec3(1e6, 1e6, 1001)), 1);
}

}  // namespace
}  // namespace luxrig
