#pragma once
/// Shadow edges of a point: directions at which the target's own relief begins to shade it (thesis §6.3).

#include <vector>

#include "core/highlight/shadow/horizon_mask.h"
#include "core/highlight/shadow/target_rays.h"
#include "core/result.h"
#include "core/run.h"
#include "core/scene/ray_scene.h"

namespace luxrig {

struct OrientedPoint {
  Vec3 position_world_m;
  Vec3 normal;  ///< unit, outwards
};

/// A step of a scan from blocked to open or back, between neighbouring elevations of one azimuth, stored as its open
/// ray.
struct ShadowEdge {
  std::uint16_t azimuth, elevation;  ///< of ScanFrame
  bool operator==(const ShadowEdge&) const = default;
};

struct ShadowEdges {
  std::vector<std::uint32_t> begin = {0};  ///< per point, plus one: its edges are edges[begin[i]…begin[i + 1])
  std::vector<ShadowEdge> edges;           ///< by azimuth, then elevation; twice if the sky opens for one step only
  std::uint64_t rays = 0;                  ///< cast
  [[nodiscard]] std::span<const ShadowEdge> of(std::size_t point) const {
    return std::span(edges).subspan(begin[point], begin[point + 1] - begin[point]);
  }
};

struct ShadowEdgeOptions : Run {
  /// 1 = every direction is traced, 32 400 rays per point. 2…8 = the search below, with first rays this many degrees
  /// apart. core/highlight/NOTES.md lists rays and error of each.
  int step = 4;
  double lift_m = 0;  ///< rays start this far off the surface; hides smaller relief
};

/// Search: rays `step` degrees apart over the hemisphere; directions between take the result of the nearest ray. Then
/// each direction that differs from a neighbour, in azimuth or elevation, is traced, until both directions of every
/// such pair have been. So every edge found is real, and the border of every blocked or open patch that a ray met is
/// followed all around. The search misses patches between the first rays. If a first ray differs from all four around
/// it, there are patches as small as that (pinholes between a mesh's parts), and every direction is traced. Points
/// without a normal (zero) have no edges. The result does not depend on the number of threads.
[[nodiscard]] Result<ShadowEdges> find_shadow_edges(const TargetRays& target, std::span<const OrientedPoint> points,
                                                    const ShadowEdgeOptions& options);

/// Directions that the target blocks from one point. The search adds the rays that it cast.
[[nodiscard]] HorizonMask scan_every_direction(const TargetRays& target, const OrientedPoint& point, double lift_m);
[[nodiscard]] HorizonMask search_horizon(const TargetRays& target, const OrientedPoint& point, double lift_m, int step,
                                         std::uint64_t& rays);

/// Edges of a mask, by azimuth, then elevation.
void append_edges(const HorizonMask& blocked, std::vector<ShadowEdge>& edges);

/// Only the edges whose open ray also passes the objects around the target: walls, visitors, a glass case's frame.
/// surroundings   without the target
/// reach_m        distance that the ray must be free; infinite = to the end of the surroundings' bounding box
[[nodiscard]] ShadowEdges reachable_edges(const ShadowEdges& edges, std::span<const OrientedPoint> points,
                                          const RayScene& surroundings, double reach_m, int threads);

}  // namespace luxrig
