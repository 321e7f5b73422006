#include "core/calibration/scene_edges.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace luxrig {
namespace {

using Eigen::Vector2d;

constexpr int kEvery_px = 3;
constexpr int kHalved = 7;
/// An edge: normals differ by 25° or more, or one surface stands this share of its distance before the other's plane.
constexpr double kSameFace = 0.906, kBefore = 0.02;
/// The neighbouring lines on which an edge must go on, and how far it may move to the side between them.
constexpr int kNeighbour_px = 2, kMostSlant_px = 3;
constexpr double kStraight_px = 0.3;
/// Nearer to the picture's edge, the true camera may not see it.
constexpr int kMargin_px = 4;

using MaybeHit = std::optional<Hit>;

class EdgeFinder {
 public:
  EdgeFinder(const RayScene& rays, const Camera& camera) : rays_(rays), camera_(camera) {}

  /// Edges across the lines along x (along = 0) or y (1), every few lines.
  void add(int along, std::vector<SceneEdge>& edges) const {
    const int length = along == 0 ? camera_.width_px : camera_.height_px;
    const int lines = along == 0 ? camera_.height_px : camera_.width_px;
    for (int line = kMargin_px; line < lines - kMargin_px; line += kEvery_px) {
      MaybeHit before = seen(along, kMargin_px, line);
      for (int at = kMargin_px; at < length - kMargin_px - 1; ++at) {
        MaybeHit next = seen(along, at + 1, line);
        if (differ(before, next))
          if (const auto edge = edge_at(along, at, line)) edges.push_back(*edge);
        before = next;
      }
    }
  }

 private:
  struct Crossing {
    double at_px = 0;
    Vec3 position_world_m = Vec3::Zero();
  };

  /// From the middle of a pixel. along = 0: x is `at`, y is the line.
  [[nodiscard]] MaybeHit seen(int along, double at_px, double line_px) const {
    const double x_px = (along == 0 ? at_px : line_px) + 0.5, y_px = (along == 0 ? line_px : at_px) + 0.5;
    return rays_.nearest(camera_.eye_world_m, ray_direction(camera_, x_px, y_px), Vec3::Zero());
  }
  [[nodiscard]] bool differ(const MaybeHit& a, const MaybeHit& b) const {
    if (!a || !b) return a.has_value() != b.has_value();
    const Vec3 from_a_m = b->position_world_m - a->position_world_m;
    const double step_m = std::max(std::abs(from_a_m.dot(a->normal_world)), std::abs(from_a_m.dot(b->normal_world)));
    return rays_.material_index_of(a->triangle) != rays_.material_index_of(b->triangle) ||
           a->normal_world.dot(b->normal_world) < kSameFace ||
           step_m > kBefore * std::min(a->distance_m, b->distance_m);
  }
  /// Between two neighbouring pixels that see different surfaces.
  [[nodiscard]] std::optional<Crossing> crossing(int along, int at, int line) const {
    MaybeHit left = seen(along, at, line), right = seen(along, at + 1, line);
    if (!differ(left, right)) return std::nullopt;
    double from = at, to = at + 1;
    for (int k = 0; k < kHalved; ++k) {
      const double middle = (from + to) / 2;
      MaybeHit there = seen(along, middle, line);
      if (differ(left, there)) {
        to = middle;
        right = there;
      } else {
        from = middle;
        left = there;
      }
    }
    const bool left_is_nearer = left && (!right || left->distance_m <= right->distance_m);
    return Crossing{(from + to) / 2, left_is_nearer ? left->position_world_m : right->position_world_m};
  }
  /// The crossing of a neighbouring line nearest to `at`.
  [[nodiscard]] std::optional<Crossing> near(int along, int at, int line) const {
    for (int aside = 0; aside <= kMostSlant_px; ++aside)
      for (const int there : {at - aside, at + aside})
        if (const auto found = crossing(along, there, line)) return found;
    return std::nullopt;
  }
  [[nodiscard]] std::optional<SceneEdge> edge_at(int along, int at, int line) const {
    const auto here = crossing(along, at, line);
    const auto before = near(along, at, line - kNeighbour_px), after = near(along, at, line + kNeighbour_px);
    if (!here || !before || !after) return std::nullopt;
    if (std::abs(before->at_px - 2 * here->at_px + after->at_px) > 2 * kStraight_px) return std::nullopt;
    const double slant = (after->at_px - before->at_px) / (2 * kNeighbour_px);
    if (std::abs(slant) > 1) return std::nullopt;  // found along the other lines
    const Vector2d normal = Vector2d(1, -slant).normalized();
    return SceneEdge{here->position_world_m, along == 0 ? normal : Vector2d(normal.y(), normal.x())};
  }

  const RayScene& rays_;
  const Camera& camera_;
};

}  // namespace

std::vector<SceneEdge> scene_edges(const RayScene& rays, const Camera& camera) {
  std::vector<SceneEdge> edges;
  const EdgeFinder finder(rays, camera);
  for (const int along : {0, 1}) finder.add(along, edges);
  return edges;
}

}  // namespace luxrig
