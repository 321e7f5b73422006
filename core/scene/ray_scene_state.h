#pragma once
/// Internal to ray_scene*.cpp: the data of a RayScene, and the position error of surfaces in float.

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <vector>

#include "core/scene/ray_scene.h"

namespace luxrig {

// Derivation. u = 2^-24 (half a unit in the last place), p = the point considered, L = the longest edge of a triangle
// there. All vertices of that triangle are within |p| + L of the origin.
//   vertices rounded to float                       √3 u (|p| + L)
//   start of the ray rounded to float               √3 u |p|
//   Embree subtracts the start from the vertices    √3 u L
//   its triangle normal (cross product of edges)     6 u L   a sliver's normal is worse, but only about its
//                                                            long side, where it moves points within the
//                                                            sliver by no more than this
//   its dot product with that normal, and division   6 u L
// Together u (3.5 |p| + 15.5 L), rounded up. L is at most the scene's longest edge. It is also at most the larger of
// 0.92 √3 |p|∞ and the longest "near" edge: one longer than k = 0.51 of its distance from the origin. For if a
// triangle's longest edge l is not near, then l ≤ k (|p| + √3/2 l), since p is no farther from that edge than the
// height of the triangle over it. So l ≤ k |p| / (1 - k √3/2) < 0.92 √3 |p|∞. large_faces.h cuts faces this way,
// except for the rounding of corners. World coordinates, in double, are off by 2^-53 of their size; points computed
// from others there, by a few times that.
inline constexpr double kUnit = 0x1p-24;
inline constexpr double kPerPosition = 4;
inline constexpr double kPerEdge = 16;
inline constexpr double kWorldUnit = 0x1p-50;
inline constexpr double kNearEdgePerDistance = 0.51;  // k
inline constexpr double kFarEdgePerPosition = 1.6;    // 0.92 √3

inline constexpr double kStartErrors = 2;  // the start is lifted by this many e, then set back by one (see `start`)

struct RayScene::State {
  /// A hit triangle in one cache line.
  struct alignas(64) Triangle {
    std::array<Vec3f, 3> corners_m;
    std::uint32_t material = 0;
    std::array<double, 3> normal{};  ///< unit; zero if the triangle has no area
  };

  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  Vec3 origin_world_m = Vec3::Zero();
  std::vector<Vec3f> vertices_m;  // shared with Embree; one more than used, since it reads 16 bytes per vertex
  std::vector<std::array<std::uint32_t, 3>> indices;
  std::vector<Triangle> triangles;
  std::vector<Material> materials;
  Panes panes;
  Eigen::AlignedBox3d bounds_m;  // relative to the origin
  double edge_error_m = 0, near_edge_error_m = 0;  // from the longest edge of all, and of the near ones
  double world_error_m = 0;                        // from the rounding of world coordinates
  mutable std::once_flag tree_built;
  mutable TriangleTree tree;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }

  void measure(const std::vector<std::uint32_t>& material_of_triangle);
  void build();

  // Shadow rays: ray_scene_occlusion.cpp.
  struct Targets;
  static void pass_what_holds_the_target(const RTCFilterFunctionNArguments* arguments);
  [[nodiscard]] bool aim(const Vec3& from_m, const Vec3& normal, const Vec3& to_m, double error_m, RTCRay& ray) const;

  [[nodiscard]] double error_m(const Vec3& point_m) const {
    const double reach_m = point_m.cwiseAbs().maxCoeff();
    return kUnit * kPerPosition * reach_m + world_error_m +
           std::min(edge_error_m, std::max(near_edge_error_m, kUnit * kPerEdge * kFarEdgePerPosition * reach_m));
  }

  /// Lifts the start off its surface by 2 e along the normal, then sets it back by e along the ray. It is then still e
  /// above the surface, but in front of any other surface that it touches in a corner; otherwise the ray would slip
  /// through that one.
  [[nodiscard]] Vec3 start(const Vec3& from_m, const Vec3& direction, const Vec3& normal) const {
    if (normal.isZero(0)) return from_m;
    return from_m + error_m(from_m) * (kStartErrors * normal - direction);
  }
};

}  // namespace luxrig
