#include <gtest/gtest.h>

#include "core/highlight/surface/target_surface.h"
#include "tests/core/highlight/shapes.h"
#include "tools/bench/highlight/variants.h"

namespace luxrig {
namespace {

TEST(HighlightVariants, ASphereDecimatedToHalfStaysAClosedSphere) {
  const Scene sphere = uv_sphere(1, 60);
  const auto whole = make_target_surface(sphere);
  const std::size_t wanted = whole->triangles.size() / 2;
  const Scene half = decimated(sphere, wanted);
  EXPECT_LE(half.triangles.size(), wanted);
  EXPECT_GE(half.triangles.size() + 2, wanted);
  const auto surface = make_target_surface(half);
  ASSERT_TRUE(surface);
  EXPECT_NEAR(surface->area_m2(), whole->area_m2(), 0.01 * whole->area_m2());
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : surface->triangles)
    for (std::size_t k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
  for (const auto& [edge, triangles] : edges) ASSERT_EQ(triangles, 2);
  for (const auto& t : surface->triangles) {
    const Vec3 &a = surface->points_m[t[0]], &b = surface->points_m[t[1]], &c = surface->points_m[t[2]];
    ASSERT_GT((b - a).cross(c - a).dot(a + b + c), 0);  // still facing out
    ASSERT_NEAR((surface->point_world_m(t[0])).norm(), 1, 0.01);
  }
}

TEST(HighlightVariants, DescribeTheSameObject) {
  const Scene object = torus(1, 0.4, 60, 30);
  const auto before = make_target_surface(object);
  for (const char* kind : highlight_variant_kinds()) {
    const HighlightVariant variant = highlight_variant(object, kind);
    const auto after = make_target_surface(variant.scene);
    ASSERT_TRUE(after) << kind;
    const double scale = std::string(kind) == "scale" ? 0.01 : 1;
    EXPECT_NEAR(after->area_m2(), scale * scale * before->area_m2(), 0.03 * scale * scale * before->area_m2()) << kind;
    EXPECT_NEAR((variant.rotation * variant.rotation.transpose() - Mat3::Identity()).norm(), 0, 1e-12);
    if (std::string(kind) == "decimate") continue;
    ASSERT_EQ(after->points_m.size(), before->points_m.size()) << kind;
    for (std::size_t i = 0; i < before->normals.size(); ++i)
      ASSERT_GT(after->normals[i].dot(variant.rotation * before->normals[i]), 0.9) << kind;
  }
}

}  // namespace
}  // namespace luxrig
