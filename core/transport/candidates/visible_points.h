#pragma once
/// Finds which of many points a receiver sees, with as few rays as possible.

#include <cmath>
#include <optional>

#include "core/transport/candidates/blockers.h"
#include "core/transport/candidates/candidate_transport.h"
#include "core/transport/candidates/point_tree.h"

namespace luxrig {

/// Data shared by all visibility tests.
struct VisibilityScene {
  const RayScene* rays;      ///< null = nothing can be in between
  const Blockers* blockers;  ///< null = no groups are decided together
};

class VisiblePoints {
 public:
  /// peak_cd, min_lux   skip groups so far away that a source of peak_cd there gives less than min_lux
  VisiblePoints(const VisibilityScene& scene, const Receiver& from, const CandidateSkips& skips, double peak_cd,
                double min_lux)
      : scene_(scene), from_(from), skips_(skips), peak_cd_(peak_cd), min_lux_(skips.reach ? min_lux : 0) {}

  /// Calls wants(point) for each point in front of the receiver that no group test decided. If it returns true, a
  /// shadow ray is cast, and seen(point) is called if nothing is in between. Counts skipped points by reason.
  template <class Wants, class Seen>
  void visit(const PointTree& tree, std::span<const Vec3> points_world_m, Wants&& wants, Seen&& seen) {
    if (!tree.nodes.empty()) visit_node(tree, points_world_m, 0, wants, seen);
  }

  std::uint64_t behind = 0, out_of_reach = 0, blocked_in_groups = 0, traced = 0, lit = 0, rays = 0;

 private:
  template <class Wants, class Seen>
  void visit_node(const PointTree& tree, std::span<const Vec3> points_world_m, std::uint32_t index, Wants& wants,
                  Seen& seen) {
    const PointTree::Node& node = tree.nodes[index];
    const std::uint32_t size = node.end - node.begin;
    if (skips_.behind && wholly_behind(node)) {
      behind += size;
      return;
    }
    if (min_lux_ > 0 && wholly_out_of_reach(node)) {
      out_of_reach += size;
      return;
    }
    if (scene_.blockers && skips_.blockers && hidden(node)) {
      blocked_in_groups += size;
      return;
    }
    if (node.right != 0) {
      visit_node(tree, points_world_m, index + 1, wants, seen);
      visit_node(tree, points_world_m, node.right, wants, seen);
      return;
    }
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      const std::uint32_t point = tree.order[i];
      const Vec3& at_m = points_world_m[point];
      if (!(from_.normal_world.dot(at_m - from_.position_world_m) > 0)) {
        ++behind;
        continue;
      }
      if (!wants(point)) continue;
      ++traced;
      if (scene_.rays) {
        ++rays;
        if (scene_.rays->occluded(from_.position_world_m, from_.normal_world, at_m)) continue;
      }
      ++lit;
      seen(point);
    }
  }

  [[nodiscard]] bool wholly_behind(const PointTree::Node& node) const;
  [[nodiscard]] bool wholly_out_of_reach(const PointTree::Node& node) const;
  /// In the shadow of a recently used blocker, or of the one that a ray to its centre meets.
  [[nodiscard]] bool hidden(const PointTree::Node& node);

  static constexpr std::size_t kRemembered = 6;

  VisibilityScene scene_;
  const Receiver& from_;
  const CandidateSkips& skips_;
  double peak_cd_, min_lux_;
  struct Remembered {
    std::uint32_t blocker = ~0u;
    BlockerShadow shadow;
  };
  std::array<Remembered, kRemembered> remembered_;
  std::size_t oldest_ = 0;
};

}  // namespace luxrig
