#include "core/highlight/surface/even_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/core/highlight/shapes.h"
#include "tests/core/highlight/surface/even_surface_fixture.h"

namespace luxrig {
namespace {

using namespace even_surface_fixture;

TEST(SizeOfASurface, IsTheDiagonalOfARectangleForAnyMeshAndRotation) {
  const Mat3 rotation = Eigen::AngleAxisd(1.1, Vec3(0.3, -0.5, 0.8).normalized()).toRotationMatrix();
  for (const int split : {1, 7}) {
    const Scene flat = parametric(split, 2 * split, [](double u, double v) { return Vec3(5 + 3 * u, 4 * v, 1); });
    EXPECT_NEAR(mesh_of(flat).size_m(), 5, 1e-6);
    EXPECT_NEAR(mesh_of(turned(flat, rotation)).size_m(), 5, 1e-5);
  }
  EXPECT_NEAR(mesh_of(uv_sphere(2, 90)).size_m(), 2 * std::sqrt(12), 0.01);
  EXPECT_EQ(mesh_of(Scene{}).size_m(), 0);
}

TEST(EvenSurface, CoversASphereEvenlyWithPoints) {
  const double radius_m = 2, scale_m = 0.3;
  const TargetSurface mesh = mesh_of(uv_sphere(radius_m, 100));
  const EvenSurface even = even_of(mesh, scale_m);
  const TargetSurface& surface = even.surface;
  EXPECT_NEAR(surface.area_m2(), mesh.area_m2(), 1e-3 * mesh.area_m2());
  const double off_m = 0.003 * mesh.size_m(), apart_m = 0.2 * scale_m;
  // Discs of half the distance do not overlap; discs of the full distance leave no gap.
  const auto count = static_cast<double>(surface.points_m.size());
  EXPECT_LT(count * kPi * apart_m * apart_m / 4, mesh.area_m2());
  EXPECT_GT(count * kPi * apart_m * apart_m, mesh.area_m2());
  double nearest_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < surface.points_m.size(); ++i) {
    EXPECT_NEAR(surface.points_m[i].norm(), radius_m + off_m, 1e-3 * radius_m);
    EXPECT_GT(surface.normals[i].dot(surface.points_m[i].normalized()), 0.9999);
    EXPECT_NEAR(even.curvature[i].mean_per_m(), 1 / radius_m, 0.02 / radius_m);
    for (std::size_t j = 0; j < i; ++j)
      nearest_m = std::min(nearest_m, (surface.points_m[i] - surface.points_m[j]).norm());
  }
  EXPECT_GE(nearest_m, apart_m * (1 + off_m / radius_m) - 1e-6);
}

TEST(EvenSurface, ComparesEachPlaceWithOthersAllAroundIt) {
  const double scale_m = 0.3;
  const EvenSurface even = even_of(mesh_of(torus(1, 0.5, 120, 60)), scale_m);
  const TargetSurface& surface = even.surface;
  for (std::uint32_t i = 0; i < surface.points_m.size(); ++i) {
    EXPECT_EQ(surface.ring(i).size(), 6u);
    EXPECT_TRUE(std::ranges::is_sorted(surface.ring(i)));
    Vec3 mean = Vec3::Zero();
    for (const std::uint32_t n : surface.ring(i)) {
      const double away_m = (surface.points_m[n] - surface.points_m[i]).norm();
      EXPECT_GT(away_m, 0.35 * scale_m);
      EXPECT_LT(away_m, 1.1 * scale_m);
      mean += (surface.points_m[n] - surface.points_m[i]) / 6;
    }
    EXPECT_LT(mean.norm(), 0.35 * scale_m) << "its ring lies to one side of point " << i;
  }
}

TEST(EvenSurface, OfACoarseMeshMatchesThatOfAFineOne) {
  const double scale_m = 0.2;
  const auto plane = [](int split) {
    return parametric(split, split, [](double u, double v) { return Vec3(2 * u, 3 * v, 0); });
  };
  const EvenSurface coarse = even_of(mesh_of(plane(1)), scale_m), fine = even_of(mesh_of(plane(150)), scale_m);
  // The density of random places depends slightly on their source surface.
  EXPECT_NEAR(static_cast<double>(coarse.surface.points_m.size()), static_cast<double>(fine.surface.points_m.size()),
              0.12 * static_cast<double>(fine.surface.points_m.size()));
  for (const EvenSurface* even : {&coarse, &fine}) {
    EXPECT_NEAR(even->surface.area_m2(), 6, 1e-3);
    EXPECT_NEAR((even->surface.centroid_world_m() - Vec3(1, 1.5, 0.003 * std::sqrt(13.0))).norm(), 0, 0.01);
    for (const Vec3& normal : even->surface.normals) EXPECT_GT(normal.z(), 0.9999);
  }
}

TEST(EvenSurface, KeepsTheSidesOfASheetApart) {
  // 10 mm thick, at a scale of 120 mm.
  const Scene front = parametric(60, 60, [](double u, double v) { return Vec3(u, v, 0.005); });
  const Scene back = parametric(60, 60, [](double u, double v) { return Vec3(v, u, -0.005); });
  const EvenSurface even = even_of(mesh_of(joined(front, back)), 0.12);
  double front_m2 = 0, back_m2 = 0;
  for (std::uint32_t i = 0; i < even.surface.points_m.size(); ++i) {
    const double side = even.surface.points_m[i].z() > 0 ? 1 : -1;
    EXPECT_GT(side * even.surface.normals[i].z(), 0.999);
    (side > 0 ? front_m2 : back_m2) += even.surface.areas_m2[i];
    for (const std::uint32_t n : even.surface.ring(i)) EXPECT_GT(side * even.surface.points_m[n].z(), 0);
  }
  EXPECT_NEAR(front_m2, 1, 1e-3);
  EXPECT_NEAR(back_m2, 1, 1e-3);
}

TEST(EvenSurface, AcceptsAnyMeshAndRefusesInvalidScales) {
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")})
    EXPECT_FALSE(even_surface(mesh_of(uv_sphere(1, 10)), {{}, bad})) << bad;
  EXPECT_TRUE(even_of(mesh_of(Scene{}), 1).surface.points_m.empty());
  // Far too fine: refused with a workable value, instead of filling the memory.
  const auto too_fine = even_surface(mesh_of(uv_sphere(1, 10)), {{}, 1e-5});
  ASSERT_FALSE(too_fine);
  EXPECT_NE(too_fine.error().detail.find("too fine"), std::string::npos) << too_fine.error().detail;
  // Thin facets all along the object, each worth hundreds of pieces.
  Scene slivers;
  for (int i = 0; i < 200'000; ++i) {
    const auto first = static_cast<std::uint32_t>(slivers.vertices_m.size());
    const auto y = static_cast<float>(1e-5 * i);
    for (const Vec3f& v : {Vec3f(0, y, 0), Vec3f(1, y, 0), Vec3f(0, y + 0.9e-5f, 0)}) slivers.vertices_m.push_back(v);
    slivers.triangles.push_back({first, first + 1, first + 2});
  }
  const auto sliced = even_surface(mesh_of(with_one_material(slivers)), {{}, 0.03});
  ASSERT_FALSE(sliced);
  EXPECT_NE(sliced.error().detail.find("pieces"), std::string::npos) << sliced.error().detail;
  // Unconnected triangles, from millimetres to kilometres.
  Random random(5);
  for (const double size_m : {1e-3, 1.0, 1e3}) {
    Scene soup;
    for (int i = 0; i < 200; ++i) {
      const auto first = static_cast<std::uint32_t>(soup.vertices_m.size());
      const Vec3 place(random.between(0, 1), random.between(0, 1), random.between(0, 1));
      for (int k = 0; k < 3; ++k)
        soup.vertices_m.push_back(
            (size_m * (place + 0.3 * Vec3(random.between(0, 1), random.between(0, 1), random.between(0, 1))))
                .cast<float>());
      soup.triangles.push_back({first, first + 1, first + 2});
    }
    const TargetSurface mesh = mesh_of(with_one_material(soup));
    const EvenSurface even = even_of(mesh, 0.1 * size_m);
    EXPECT_GT(even.surface.points_m.size(), 100u);
    EXPECT_NEAR(even.surface.area_m2(), mesh.area_m2(), 0.02 * mesh.area_m2());
    EXPECT_EQ(even.surface.ring_begin_.size(), even.surface.points_m.size() + 1);
    for (const Vec3& p : even.surface.points_m) EXPECT_TRUE(p.allFinite());
  }
}

}  // namespace
}  // namespace luxrig
