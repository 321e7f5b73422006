#include "core/highlight/lights/domain_votes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/highlight/lights/vote_gathering.h"
#include "core/parallel.h"
#include "core/transport/progress.h"

namespace luxrig {
namespace {

constexpr std::size_t kPointsPerDomainTask = 8;

std::optional<std::string> fault_of_points(const ShadowEdges& edges, std::span<const OrientedPoint> points,
                                           std::span<const std::uint32_t> feature_of_point,
                                           const DomainVoteOptions& options) {
  LUXRIG_CHECK(edges.begin.size() == points.size() + 1, "edges of {} points, {} points", edges.begin.size() - 1,
               points.size());
  LUXRIG_CHECK(feature_of_point.size() == points.size(), "features of {} points, {} points", feature_of_point.size(),
               points.size());
  if (points.empty()) return "there are no interest points: the object has no recesses that a light could bring out";
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!points[i].position_world_m.allFinite() || !points[i].normal.allFinite())
      return fmt::format("interest point {} is not finite", i);
  if (!(options.nearest_m >= 0) || !std::isfinite(options.nearest_m) || !(options.reach_m > options.nearest_m))
    return fmt::format("luminaires cannot be {} to {} m from the target", options.nearest_m, options.reach_m);
  if (!options.reflectance.empty() && options.reflectance.size() != points.size())
    return fmt::format("{} reflectances for {} interest points", options.reflectance.size(), points.size());
  for (const double reflectance : options.reflectance)
    if (!(reflectance >= 0 && reflectance <= 1)) return fmt::format("a reflectance of {}", reflectance);
  if (edges.edges.empty())
    return fmt::format(
        "none of the {} interest points has a shadow edge: seen from them the target blocks every direction (a closed "
        "box from inside), or none",
        points.size());
  return std::nullopt;
}

/// Buffers of one task.
struct DomainTrace {
  std::vector<Vec3f> directions;
  std::vector<DomainHit> hits;
  std::vector<Vec3> places_world_m;
  std::vector<Blocked> blocked;
};

void trace_point(const LightDomain& domain, const DomainVoteOptions& options, double nearest_m, std::uint32_t point,
                 const Vec3& from_world_m, DomainTrace& trace, GatheredPart& part) {
  DomainVoteCounts& counts = part.counts;
  trace.hits.clear();
  trace.places_world_m.clear();
  domain.hits_along(from_world_m, trace.directions, trace.hits);
  counts.rays += trace.directions.size();
  counts.missed_domain += trace.directions.size();
  for (std::size_t k = 0; k < trace.hits.size(); ++k)
    if (k == 0 || trace.hits[k].ray != trace.hits[k - 1].ray) --counts.missed_domain;
  std::erase_if(trace.hits, [&](const DomainHit& hit) {
    const bool near = hit.distance_m < nearest_m;
    const bool far = hit.distance_m > options.reach_m;
    counts.too_near += near ? 1 : 0;
    counts.out_of_reach += far ? 1 : 0;
    return near || far;
  });
  for (const DomainHit& hit : trace.hits)
    trace.places_world_m.push_back(from_world_m +
                                   hit.distance_m * trace.directions[hit.ray].cast<double>().normalized());
  trace.blocked.resize(trace.hits.size());
  find_blocked(options.surroundings, from_world_m, trace.places_world_m, trace.blocked);
  for (std::size_t k = 0; k < trace.hits.size(); ++k) {
    const DomainHit& hit = trace.hits[k];
    counts.behind_environment += trace.blocked[k] == Blocked::by_environment ? 1 : 0;
    counts.behind_occluders += trace.blocked[k] == Blocked::by_occluders ? 1 : 0;
    if (trace.blocked[k] != Blocked::by_nothing) continue;
    ++counts.votes;
    part.votes.push_back({domain.cell_of(trace.places_world_m[k], domain.triangles()[hit.triangle].group), point,
                          trace.directions[hit.ray].normalized(), static_cast<float>(hit.distance_m * hit.distance_m)});
  }
}

Vec3 place_of(const DomainVote& vote, std::span<const OrientedPoint> points) {
  return points[vote.point].position_world_m +
         std::sqrt(static_cast<double>(vote.squared_distance_m2)) * vote.direction.cast<double>();
}

void find_centres(DomainVotes& votes, std::span<const OrientedPoint> points, const Vec3& about_world_m, int threads) {
  parallel_for(votes.cells.size(), threads, [&](std::size_t c) {
    Vec3 sum = Vec3::Zero();
    double weights = 0;
    for (const DomainVote& vote : votes.of(c)) {
      sum += votes.weight(vote) * (place_of(vote, points) - about_world_m);
      weights += votes.weight(vote);
    }
    const Vec3 mean_world_m = about_world_m + (weights > 0 ? Vec3(sum / weights) : Vec3::Zero());
    double nearest_m2 = std::numeric_limits<double>::infinity();
    for (const DomainVote& vote : votes.of(c)) {
      const Vec3 place_world_m = place_of(vote, points);
      const double squared_m2 = (place_world_m - mean_world_m).squaredNorm();
      if (!(squared_m2 < nearest_m2)) continue;
      nearest_m2 = squared_m2;
      votes.cells[c].centre_world_m = place_world_m;
    }
  });
}

}  // namespace

void DomainVoteCounts::add(const DomainVoteCounts& other) {
  rays += other.rays;
  missed_domain += other.missed_domain;
  too_near += other.too_near;
  out_of_reach += other.out_of_reach;
  behind_environment += other.behind_environment;
  behind_occluders += other.behind_occluders;
  votes += other.votes;
}

std::string DomainVoteCounts::text() const {
  return fmt::format(
      "of {} rays {} miss the light domain; of the hits of the others {} are nearer than a luminaire can be, {} out of "
      "reach, {} behind the environment, {} behind occluders",
      rays, missed_domain, too_near, out_of_reach, behind_environment, behind_occluders);
}

Result<DomainVotes> vote_on_domain(const LightDomain& domain, const ShadowEdges& edges,
                                   std::span<const OrientedPoint> points,
                                   std::span<const std::uint32_t> feature_of_point, const DomainVoteOptions& options) {
  if (const auto fault = fault_of_points(edges, points, feature_of_point, options)) return refusal(*fault);
  Eigen::AlignedBox3d box_m;
  for (const OrientedPoint& point : points) box_m.extend(point.position_world_m);
  const double nearest_m = nearest_luminaire_m(options.nearest_m, box_m);
  if (!(options.reach_m > nearest_m))
    return refusal(fmt::format("luminaires cannot be {} to {} m from the target", nearest_m, options.reach_m));

  DomainVotes votes;
  const std::uint64_t layers = domain.layer_of(domain.groups() - 1) + 1u;
  if (options.max_votes > 0) {
    const std::uint64_t expected = layers * edges.edges.size();
    votes.every = static_cast<std::uint32_t>((expected + options.max_votes - 1) / options.max_votes);
  }
  votes.point_factor.assign(options.reflectance.begin(), options.reflectance.end());
  std::vector<GatheredPart> parts((points.size() + kPointsPerDomainTask - 1) / kPointsPerDomainTask);
  CallingThreadProgress progress(options.watch, 0, 1, std::max<std::size_t>(1, parts.size()));
  parallel_for(parts.size(), options.threads, [&](std::size_t p) {
    if (options.watch.stop.stop_requested()) return;
    DomainTrace trace;
    const std::size_t end = std::min(points.size(), (p + 1) * kPointsPerDomainTask);
    for (std::size_t i = p * kPointsPerDomainTask; i < end; ++i) {
      trace.directions.clear();
      if (edges.of(i).empty()) continue;
      const ScanFrame frame(points[i].normal);
      const std::uint64_t first = edges.begin[i];
      for (std::uint64_t e = (first + votes.every - 1) / votes.every * votes.every; e < edges.begin[i + 1];
           e += votes.every)
        trace.directions.push_back(frame.direction(edges.edges[e].azimuth, edges.edges[e].elevation));
      trace_point(domain, options, nearest_m, static_cast<std::uint32_t>(i), points[i].position_world_m, trace,
                  parts[p]);
    }
    progress.one_done();
  });
  if (options.watch.stop.stop_requested())
    return tl::unexpected(Fault{Cause::cancelled, "", "the voting on the light domain was stopped", {}});
  sort_into_cells(domain, parts, feature_of_point, votes, options.threads);
  progress.report_end();
  if (votes.votes.empty())
    return refusal("no shadow edge of the target can be lit from the light domain: " + votes.counts.text());
  find_centres(votes, points, domain.centre_world_m(), options.threads);
  return votes;
}

}  // namespace luxrig
