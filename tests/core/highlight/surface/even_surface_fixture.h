#pragma once
/// Shared by the tests of even_surface.

#include <gtest/gtest.h>

#include "core/highlight/surface/even_surface.h"
#include "tests/random.h"

namespace luxrig::even_surface_fixture {

inline TargetSurface mesh_of(const Scene& scene) {
  auto mesh = make_target_surface(scene);
  EXPECT_TRUE(mesh);
  return std::move(*mesh);
}

inline EvenSurface even_of(const TargetSurface& mesh, double scale_m, int threads = 0) {
  auto even = even_surface(mesh, {{.threads = threads, .watch = {}}, scale_m});
  EXPECT_TRUE(even);
  return std::move(*even);
}

inline Scene turned(Scene scene, const Mat3& rotation) {
  for (Vec3f& v : scene.vertices_m) v = (rotation * v.cast<double>()).cast<float>();
  return scene;
}

}  // namespace luxrig::even_surface_fixture
