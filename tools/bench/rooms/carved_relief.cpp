#include <algorithm>
#include <cmath>

#include "tools/bench/rooms/level_set.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig {
namespace {

constexpr double kReliefHalfWidth_m = 0.6, kReliefHalfHeight_m = 0.4, kReliefHalfDepth_m = 0.04;

struct ReliefLimb {
  Vec3 a, b;
  double radius, blend;
};

/// For a figure of height 1 that stands on the origin and faces -Y; `swing` turns its arms.
double relief_figure_distance(const Vec3& p, double swing) {
  const Vec3 left(-0.16 - 0.10 * swing, -0.04, 0.62 + 0.22 * swing),
      right(0.16 + 0.10 * swing, -0.04, 0.62 - 0.1 * swing);
  const std::array<ReliefLimb, 7> limbs = {{{{0, 0, 0.50}, {0, 0, 0.72}, 0.095, 0.08},
                                            {{-0.10, 0, 0.76}, {0.10, 0, 0.76}, 0.052, 0.05},
                                            {{0, -0.01, 0.80}, {0, -0.02, 0.95}, 0.060, 0.02},
                                            {{-0.13, 0, 0.75}, left, 0.036, 0.02},
                                            {left, left + Vec3(0.06, -0.05, 0.18), 0.030, 0.015},
                                            {{0.13, 0, 0.75}, right, 0.036, 0.02},
                                            {right, right + Vec3(-0.05, -0.06, -0.16), 0.030, 0.015}}};
  const double folds = 1 + 0.09 * std::cos(13 * std::atan2(p.x(), -p.y()) + 2 * swing) * std::max(0.0, 1 - 1.8 * p.z());
  const double robe = std::hypot(p.x(), p.y()) - (0.17 - 0.14 * std::clamp(p.z(), 0.0, 0.55)) * folds;
  double distance = std::max({robe, p.z() - 0.55, -p.z()});
  for (const ReliefLimb& limb : limbs)
    distance = blended_least_m(distance, distance_to_segment_m(p, limb.a, limb.b) - limb.radius, limb.blend);
  return distance;
}

double box_distance_m(const Vec3& p_m, const Vec3& middle_m, const Vec3& half_m) {
  const Vec3 past_m = (p_m - middle_m).cwiseAbs() - half_m;
  return past_m.cwiseMax(0.0).norm() + std::min(0.0, past_m.maxCoeff());
}

}  // namespace

Scene make_carved_relief(double cell_m) {
  const Vec3 half_m(kReliefHalfWidth_m, kReliefHalfDepth_m, kReliefHalfHeight_m);
  const auto distance_m = [&](const Vec3& p) {
    double slab_m = box_distance_m(p, Vec3::Zero(), half_m - Vec3::Constant(0.005)) - 0.005;
    // The border remains where the front is not cut back by 25 mm.
    slab_m = std::max(slab_m, -box_distance_m(p, {0, -kReliefHalfDepth_m - 0.035, 0}, {0.54, 0.06, 0.34}));
    double figures_m = 1;
    for (int k = 0; k < 3; ++k) {
      const double height_m = 0.62 - 0.05 * (k % 2);
      const Vec3 foot_m(-0.34 + 0.34 * k, -0.012, -0.345);
      figures_m = std::min(figures_m, height_m * relief_figure_distance((p - foot_m) / height_m, 0.9 * (k - 1)));
    }
    return std::min(slab_m, std::max(figures_m, box_distance_m(p, {0, -0.06, 0}, {0.56, 0.09, 0.36})));
  };
  const Vec3 room_m = half_m + Vec3(4 * cell_m, 0.12, 4 * cell_m);
  ClosedMesh mesh = mesh_level_set(Eigen::AlignedBox3d(-room_m, room_m), cell_m, distance_m);
  Scene scene;
  for (const Vec3& v : mesh.vertices_m) scene.vertices_m.push_back(v.cast<float>());
  scene.triangles = std::move(mesh.triangles);
  scene.materials = {Material{}};
  scene.materials.front().name = "stone";
  scene.object_names = {"relief"};
  scene.material_of_triangle.assign(scene.triangles.size(), 0);
  scene.object_of_triangle.assign(scene.triangles.size(), 0);
  return scene;
}

}  // namespace luxrig
