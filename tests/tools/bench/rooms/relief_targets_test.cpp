#include "tools/bench/rooms/relief_targets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "core/geometry.h"

namespace luxrig {
namespace {

bool closes(const Scene& scene) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> walked;
  for (const auto& t : scene.triangles)
    for (std::size_t k = 0; k < 3; ++k) walked[std::minmax(t[k], t[(k + 1) % 3])] += t[k] < t[(k + 1) % 3] ? 1 : -1;
  return !scene.triangles.empty() &&
         std::all_of(walked.begin(), walked.end(), [](const auto& edge) { return edge.second == 0; });
}

/// Nearest to -Y of all vertices within a millimetre of this place in x and z.
double front_m(const Scene& scene, double x_m, double z_m, double within_m = 0.004) {
  double front = 1;
  for (const Vec3f& v : scene.vertices_m)
    if (std::hypot(v.x() - x_m, v.z() - z_m) < within_m) front = std::min(front, double{v.y()});
  return front;
}

TEST(ReliefTargets, AreClosed) {
  EXPECT_TRUE(closes(make_head(0.004)));
  EXPECT_TRUE(closes(make_helmet(0.004)));
  EXPECT_TRUE(closes(make_inscription(0.003)));
}

TEST(ReliefTargets, TheHeadHasANoseBeforeItsCheeksAndEyesBehindItsBrow) {
  const Scene head = make_head(0.003);
  const double nose = front_m(head, 0, -0.027), brow = front_m(head, 0.031, 0.030), eye = front_m(head, 0.031, 0.008),
               cheek = front_m(head, 0.048, -0.014);
  EXPECT_NEAR(nose, -0.118, 0.004);
  EXPECT_LT(nose, cheek - 0.02);
  EXPECT_GT(eye, brow + 0.004);
  for (const auto& [x_m, z_m] : {std::pair(0.031, 0.008), std::pair(0.048, -0.014), std::pair(0.02, -0.06)})
    EXPECT_NEAR(front_m(head, x_m, z_m), front_m(head, -x_m, z_m), 0.002) << "both halves are alike";
}

TEST(ReliefTargets, TheInscriptionsGroovesAreFiveMillimetresDeep) {
  const Scene slab = make_inscription(0.001);
  EXPECT_NEAR(front_m(slab, -0.17, 0, 0.002), -0.015, 1e-4);
  double deepest = -1;
  for (const Vec3f& v : slab.vertices_m)  // beside the upright of the L
    if (v.y() < 0 && std::hypot(v.x() + 0.14, v.z()) < 0.002) deepest = std::max(deepest, double{v.y()});
  EXPECT_NEAR(deepest, -0.010, 0.001);
}

}  // namespace
}  // namespace luxrig
