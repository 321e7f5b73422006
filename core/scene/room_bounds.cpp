#include "core/scene/room_bounds.h"

#include <algorithm>
#include <array>
#include <vector>

namespace luxrig {
namespace {

using Box = Eigen::AlignedBox3d;

constexpr double kMaxThings = 0.8;                ///< share of the things that defines their spread
constexpr double kMinSpread_m = 5, kAround = 30;  ///< multiple of the spread that still counts as surroundings
constexpr std::size_t kMaxPlanes = 64;
/// Tolerance for faces of one plane: cutting a face of 20 km leaves differences this small.
constexpr double kSamePlane_m = 0.01, kSameNormal = 0.9999;

struct Plane {
  Vec3 normal_world;
  double at_m;
};

/// Most of the things, by their distance from the median on each axis.
struct Cluster {
  Vec3 middle_world_m;
  double spread_m;
};

Cluster cluster_of(std::span<const Vec3> things_world_m) {
  Cluster cluster{};
  std::vector<double> sorted(things_world_m.size());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::transform(things_world_m.begin(), things_world_m.end(), sorted.begin(),
                   [&](const Vec3& at) { return at[axis]; });
    std::sort(sorted.begin(), sorted.end());
    cluster.middle_world_m[axis] = sorted[sorted.size() / 2];
  }
  std::transform(things_world_m.begin(), things_world_m.end(), sorted.begin(),
                 [&](const Vec3& at) { return (at - cluster.middle_world_m).norm(); });
  std::sort(sorted.begin(), sorted.end());
  cluster.spread_m = sorted[static_cast<std::size_t>(kMaxThings * static_cast<double>(sorted.size() - 1))];
  return cluster;
}

class Faces {
 public:
  Faces(const Scene& scene, std::optional<std::uint32_t> object) : scene_(scene), object_(object) {}

  template <class Do>
  void each(const Do& with) const {
    for (std::size_t t = 0; t < scene_.triangles.size(); ++t) {
      if (object_ && scene_.object_of_triangle[t] != *object_) continue;
      const auto& [a, b, c] = scene_.triangles[t];
      with(std::array<Vec3, 3>{scene_.vertex_world_m(a), scene_.vertex_world_m(b), scene_.vertex_world_m(c)});
    }
  }
  [[nodiscard]] Box bounds() const {
    Box all;
    each([&](const std::array<Vec3, 3>& corners) {
      for (const Vec3& corner : corners) all.extend(corner);
    });
    return all;
  }
  /// Bounds of faces wholly within a box, without those that continue beyond it in the same plane.
  [[nodiscard]] Box bounds_within(const Box& box) const {
    const auto inside = [&](const std::array<Vec3, 3>& corners) {
      return std::all_of(corners.begin(), corners.end(), [&](const Vec3& corner) { return box.contains(corner); });
    };
    const Vec3 origin = box.center();
    std::vector<Plane> planes;
    each([&](const std::array<Vec3, 3>& corners) {
      if (planes.size() >= kMaxPlanes || inside(corners)) return;
      const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
      const Plane plane{normal, normal.dot(corners[0] - origin)};
      const bool known = std::any_of(planes.begin(), planes.end(), [&](const Plane& p) {
        return std::abs(p.normal_world.dot(normal)) > 1 - 1e-9 &&
               std::abs(std::abs(p.at_m) - std::abs(plane.at_m)) < kSamePlane_m / 2;
      });
      if (!known) planes.push_back(plane);
    });
    Box left;
    each([&](const std::array<Vec3, 3>& corners) {
      if (!inside(corners)) return;
      const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
      const bool goes_on = std::any_of(planes.begin(), planes.end(), [&](const Plane& plane) {
        return std::abs(plane.normal_world.dot(normal)) > kSameNormal &&
               std::all_of(corners.begin(), corners.end(), [&](const Vec3& corner) {
                 return std::abs(plane.normal_world.dot(corner - origin) - plane.at_m) < kSamePlane_m;
               });
      });
      if (!goes_on)
        for (const Vec3& corner : corners) left.extend(corner);
    });
    return left;
  }

 private:
  const Scene& scene_;
  std::optional<std::uint32_t> object_;
};

}  // namespace

RoomBounds room_bounds_of(const Scene& scene, std::span<const Vec3> things_world_m,
                          std::optional<std::uint32_t> object) {
  const Faces faces(scene, object);
  const Box all = faces.bounds();
  if (all.isEmpty() || things_world_m.empty()) return {all, all};
  const auto [middle_world_m, spread_m] = cluster_of(things_world_m);
  const Vec3 reach_m = Vec3::Constant(kAround * std::max(kMinSpread_m, spread_m));
  const Box about(middle_world_m - reach_m, middle_world_m + reach_m);
  if (about.contains(all)) return {all, all};
  const Box built = faces.bounds_within(about);
  if (built.isEmpty()) return {all, all};
  RoomBounds room{built, built};
  for (const Vec3& at : things_world_m)
    if ((at - middle_world_m).norm() <= spread_m) room.with_things_world_m.extend(at);
  return room;
}

}  // namespace luxrig
