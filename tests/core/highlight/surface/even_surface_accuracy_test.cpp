/// even_surface: accuracy over many samples.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/highlight/surface/even_surface.h"
#include "tests/core/highlight/shapes.h"
#include "tests/core/highlight/surface/even_surface_fixture.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig {
namespace {

using namespace even_surface_fixture;

TEST(EvenSurface, TurnsWithItsObjectExceptForTheSampledPlaces) {
  const Mat3 rotation = Eigen::AngleAxisd(0.7, Vec3(0.3, -0.5, 0.8).normalized()).toRotationMatrix();
  const Scene relief = make_carved_relief(0.01);
  const TargetSurface mesh = mesh_of(relief), mesh_turned = mesh_of(turned(relief, rotation));
  EXPECT_NEAR(mesh.size_m(), mesh_turned.size_m(), 1e-5);
  const EvenSurface a = even_of(mesh, 0.05), b = even_of(mesh_turned, 0.05);
  const auto points = static_cast<double>(a.surface.points_m.size());
  EXPECT_NEAR(static_cast<double>(b.surface.points_m.size()), points, 0.06 * points);
  // The recessed share of the surface, and its depth.
  const auto recess = [](const EvenSurface& even) {
    double sum = 0;
    for (std::size_t i = 0; i < even.curvature.size(); ++i)
      sum += even.surface.areas_m2[i] * std::max(0.0, -even.curvature[i].mean_per_m());
    return sum / even.surface.area_m2();
  };
  EXPECT_NEAR(recess(b), recess(a), 0.02 * recess(a));
}

}  // namespace
}  // namespace luxrig
