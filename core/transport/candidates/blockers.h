#pragma once
/// Walls that hide whole groups of points from a receiver.
///
/// From a given point, a convex flat polygon hides a convex cone cut off by the polygon's plane: five planes at most. A
/// box of points is hidden if it is inside all five, so a few sums decide any number of pairs. This is exact:
/// RayScene::occluded() would find the same pairs occluded, since every plane is tested with a margin of several times
/// the error of rays.

#include <array>
#include <cstdint>
#include <vector>

#include "core/scene/ray_scene.h"

namespace luxrig {

/// A triangle, or two in one plane that share an edge and form a convex quadrilateral.
struct FlatBlocker {
  std::array<Vec3, 4> corners_world_m;
  std::uint32_t sides = 3;
};

class Blockers {
 public:
  explicit Blockers(const Scene& scene);

  [[nodiscard]] const FlatBlocker& of_triangle(std::uint32_t triangle) const {
    return blockers_[blocker_of_triangle_[triangle]];
  }
  [[nodiscard]] std::uint32_t index_of_triangle(std::uint32_t triangle) const { return blocker_of_triangle_[triangle]; }

 private:
  std::vector<FlatBlocker> blockers_;
  std::vector<std::uint32_t> blocker_of_triangle_;
};

/// The shadow of a blocker, seen from one point.
class BlockerShadow {
 public:
  BlockerShadow() = default;  ///< hides nothing
  /// error_m   e of ray_scene.h: the largest at this place and at the boxes to be tested
  BlockerShadow(const FlatBlocker& blocker, const Vec3& from_world_m, double error_m);

  /// True when the whole box is in the shadow.
  [[nodiscard]] bool hides_box(const Vec3& low_world_m, const Vec3& high_world_m) const;

 private:
  std::array<Vec3, 5> inward_;  ///< unit normals: of the plane, away from the point; then of the shadow's sides
  std::array<double, 5> min_m_{};
  std::uint32_t planes_ = 0;
  double height_m_ = 0;  ///< of the point over the plane
  double beside_m_ = 0;  ///< margin at the crossing with the plane
};

}  // namespace luxrig
