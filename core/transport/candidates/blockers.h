#pragma once
/// Walls that hide whole groups of points from a receiver.
///
/// Seen from a point, what a convex flat polygon hides is a convex cone cut off by the polygon's plane: five planes at
/// most. A box of points is hidden if it is inside of all five, so that a few sums decide any number of pairs, exactly:
/// what is found hidden here RayScene::occluded() would find occluded too, since every plane is asked for with a margin
/// of several times the error that rays have.

#include <array>
#include <cstdint>
#include <vector>

#include "core/scene/ray_scene.h"

namespace luxrig {

/// A triangle, or two that lie in one plane, share an edge and make a convex quadrilateral.
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

/// The shadow that a blocker throws, seen from one point.
class BlockerShadow {
 public:
  BlockerShadow() = default;  ///< hides nothing
  /// error_m   e of ray_scene.h at the place and the largest of the scene
  BlockerShadow(const FlatBlocker& blocker, const Vec3& from_world_m, double error_m);

  /// True when the whole box is in the shadow.
  [[nodiscard]] bool hides_box(const Vec3& low_world_m, const Vec3& high_world_m) const;

 private:
  std::array<Vec3, 5> inward_;  ///< unit normals: of the plane, away from the point; then of the shadow's sides
  std::array<double, 5> least_m_{};
  std::uint32_t planes_ = 0;
  double height_m_ = 0;  ///< of the plane over the point
  double beside_m_ = 0;  ///< margin where the plane is crossed
};

}  // namespace luxrig
