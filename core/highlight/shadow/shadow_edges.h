#pragma once
/// From which directions the target's own relief just shades a point: its shadow edges (thesis §6.3).

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

/// A step of a scan from blocked to open or back, between neighbouring elevations of one azimuth: its open ray.
struct ShadowEdge {
  std::uint16_t azimuth, elevation;  ///< of ScanFrame
  bool operator==(const ShadowEdge&) const = default;
};

struct ShadowEdges {
  std::vector<std::uint32_t> begin = {0};  ///< per point, and one more: its edges are edges[begin[i]…begin[i + 1])
  std::vector<ShadowEdge> edges;           ///< by azimuth, then elevation; twice where the sky opens for one step only
  std::uint64_t rays = 0;                  ///< cast
  [[nodiscard]] std::span<const ShadowEdge> of(std::size_t point) const {
    return std::span(edges).subspan(begin[point], begin[point + 1] - begin[point]);
  }
};

struct ShadowEdgeOptions : Run {
  /// 1: every direction is asked, 32 400 rays per point. Above: the search below, whose first rays are so many degrees
  /// apart; 2…8. See core/highlight/NOTES.md for rays and error of each.
  int step = 4;
  double lift_m = 0;  ///< rays start so far off the surface; hides relief smaller than it
};

/// Search: rays `step` degrees apart over the hemisphere; what lies between is taken to be as the nearest of them. Then
/// each direction that differs from a neighbour, in azimuth or elevation, is asked, until every such pair consists of
/// two that were. So every edge found is one, and the border of every blocked or open patch that any ray met is
/// followed all around; missed are patches that lie between the first rays. Where one of these found otherwise than all
/// four around it, there are patches as small as that (pinholes between a mesh's parts): there every direction is
/// asked. Points without a normal (zero) have no edges. The same answer for any number of threads.
[[nodiscard]] Result<ShadowEdges> find_shadow_edges(const TargetRays& target, std::span<const OrientedPoint> points,
                                                    const ShadowEdgeOptions& options);

/// Which directions the target blocks from one point; the search adds the rays it took.
[[nodiscard]] HorizonMask scan_every_direction(const TargetRays& target, const OrientedPoint& point, double lift_m);
[[nodiscard]] HorizonMask search_horizon(const TargetRays& target, const OrientedPoint& point, double lift_m, int step,
                                         std::uint64_t& rays);

/// Edges of a mask, by azimuth, then elevation.
void append_edges(const HorizonMask& blocked, std::vector<ShadowEdge>& edges);

/// Only those edges whose open ray also gets past what stands around the target: walls, visitors, a glass case's frame.
/// surroundings   without the target
/// reach_m        how far it must get; infinite: out of the surroundings' bounding box
[[nodiscard]] ShadowEdges reachable_edges(const ShadowEdges& edges, std::span<const OrientedPoint> points,
                                          const RayScene& surroundings, double reach_m, int threads);

}  // namespace luxrig
