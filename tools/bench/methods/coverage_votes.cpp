#include "tools/bench/methods/coverage_votes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/highlight/lights/vote_gathering.h"
#include "core/parallel.h"

namespace luxrig {
namespace {

constexpr std::size_t kPointsPerCoverageTask = 8;

void vote_from(const Vec3& from_world_m, const Vec3& normal, std::uint32_t point,
               std::span<const LightDomain::CellCentre> centres, const TargetRays& target,
               const CoverageVoteOptions& options, double nearest_m, GatheredPart& part) {
  std::vector<std::uint32_t> asked;
  std::vector<Vec3> places_world_m;
  for (std::uint32_t c = 0; c < centres.size(); ++c) {
    const Vec3 way_m = centres[c].position_world_m - from_world_m;
    if (!(way_m.dot(normal) > 0)) continue;
    ++part.counts.rays;
    const double distance_m = way_m.norm();
    part.counts.too_near += distance_m < nearest_m ? 1 : 0;
    part.counts.out_of_reach += distance_m > options.reach_m ? 1 : 0;
    if (distance_m < nearest_m || distance_m > options.reach_m) continue;
    asked.push_back(c);
    places_world_m.push_back(centres[c].position_world_m);
  }
  std::vector<std::uint8_t> shaded(asked.size());
  target.blocked_before(from_world_m, normal, 0, places_world_m, shaded);
  std::size_t left = 0;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    if (shaded[i]) continue;
    asked[left] = asked[i];
    places_world_m[left++] = places_world_m[i];
  }
  asked.resize(left);
  places_world_m.resize(left);
  std::vector<Blocked> blocked(left);
  find_blocked(options.surroundings, from_world_m, places_world_m, blocked);
  for (std::size_t i = 0; i < left; ++i) {
    part.counts.behind_environment += blocked[i] == Blocked::by_environment ? 1 : 0;
    part.counts.behind_occluders += blocked[i] == Blocked::by_occluders ? 1 : 0;
    if (blocked[i] != Blocked::by_nothing) continue;
    ++part.counts.votes;
    const Vec3 way_m = places_world_m[i] - from_world_m;
    part.votes.push_back(
        {centres[asked[i]].cell, point, way_m.normalized().cast<float>(), static_cast<float>(way_m.squaredNorm())});
  }
}

}  // namespace

Result<CoverageVotes> vote_for_coverage(const LightDomain& domain, const TargetSurface& surface,
                                        const TargetRays& target, const CoverageVoteOptions& options) {
  const std::size_t all = surface.points_m.size();
  if (all == 0) return refusal("the target has no surface that could be lit");
  Eigen::AlignedBox3d box_m;
  for (const Vec3& point_m : surface.points_m) box_m.extend(point_m);
  const double nearest_m = nearest_luminaire_m(options.nearest_m, box_m);
  if (!(options.nearest_m >= 0) || !std::isfinite(options.nearest_m) || !(options.reach_m > nearest_m))
    return refusal(fmt::format("luminaires cannot be {} to {} m from the target", nearest_m, options.reach_m));
  const std::vector<LightDomain::CellCentre> centres = domain.cell_centres();
  std::size_t count = options.max_points == 0 ? all : std::min(all, options.max_points);
  if (options.max_votes > 0) count = std::min(count, std::max<std::size_t>(1, 2 * options.max_votes / centres.size()));

  CoverageVotes result;
  double area_m2 = 0;
  for (std::size_t k = 0; k < count; ++k) {
    result.surface_point.push_back(static_cast<std::uint32_t>(k * all / count));
    area_m2 += surface.areas_m2[result.surface_point.back()];
  }
  for (const std::uint32_t point : result.surface_point)
    result.votes.point_factor.push_back(surface.areas_m2[point] / area_m2);
  std::vector<GatheredPart> parts((count + kPointsPerCoverageTask - 1) / kPointsPerCoverageTask);
  parallel_for(parts.size(), options.threads, [&](std::size_t p) {
    if (options.watch.stop.stop_requested()) return;
    const std::size_t end = std::min(count, (p + 1) * kPointsPerCoverageTask);
    for (std::size_t k = p * kPointsPerCoverageTask; k < end; ++k) {
      const std::uint32_t point = result.surface_point[k];
      if (surface.normals[point].isZero(0)) continue;
      vote_from(surface.point_world_m(point), surface.normals[point], static_cast<std::uint32_t>(k), centres, target,
                options, nearest_m, parts[p]);
    }
  });
  if (options.watch.stop.stop_requested())
    return tl::unexpected(Fault{Cause::cancelled, "", "the votes of the surface were stopped", {}});
  std::vector<std::uint32_t> feature_of_point(count);
  std::iota(feature_of_point.begin(), feature_of_point.end(), 0u);
  sort_into_cells(domain, parts, feature_of_point, result.votes, options.threads);
  if (result.votes.votes.empty())
    return refusal("nothing of the target can be lit from the light domain: " + result.votes.counts.text());
  // Both are in the order of cells.
  std::size_t next = 0;
  for (DomainVotes::Cell& cell : result.votes.cells) {
    while (centres[next].cell != cell.cell) ++next;
    cell.centre_world_m = centres[next].position_world_m;
  }
  return result;
}

}  // namespace luxrig
