#pragma once
/// Votes of shadow edges for the places on a light domain where a luminaire brings out relief (thesis §6.5.2).

#include <limits>
#include <string>
#include <vector>

#include "core/highlight/lights/light_domain.h"
#include "core/highlight/shadow/shadow_edges.h"
#include "core/highlight/shadow/surroundings.h"
#include "core/run.h"

namespace luxrig {

struct DomainVote {
  std::uint32_t point;
  std::uint32_t feature;  ///< all votes of a feature are removed together when a light is chosen
  Vec3f direction;        ///< unit, from the point to the domain
  float squared_distance_m2;
};

/// Outcome of rays on their way to the domain: each hit with a layer counts once.
struct DomainVoteCounts {
  std::uint64_t rays = 0;
  std::uint64_t missed_domain = 0;  ///< rays
  std::uint64_t too_near = 0, out_of_reach = 0, behind_environment = 0, behind_occluders = 0, votes = 0;
  void add(const DomainVoteCounts& other);
  [[nodiscard]] std::string text() const;  ///< "of 812 rays 800 miss the light domain, …"
};

/// Votes by cell. 24 bytes each; 24 + 28 while they are gathered.
struct DomainVotes {
  struct Cell {
    DomainCell cell;
    std::uint32_t layer;
    Vec3 centre_world_m;  ///< place of its candidate lights
  };
  std::vector<Cell> cells;                 ///< cells with votes, rising
  std::vector<std::uint64_t> begin = {0};  ///< per cell, plus one: its votes are votes[begin[i]…begin[i + 1])
  std::vector<DomainVote> votes;           ///< within a cell by point, then by ray
  std::vector<double> point_factor;        ///< per point: its reflectance, or share of area; empty = 1
  std::uint32_t features = 0;              ///< features are 0…features - 1, including those without a vote
  std::vector<std::uint32_t> points_of_feature;  ///< points per feature
  std::uint32_t every = 1;                       ///< only every n-th ray was traced
  DomainVoteCounts counts;

  /// Weight of a vote [1/m²]: falls with distance as illuminance does.
  [[nodiscard]] double weight(const DomainVote& vote) const {
    return (point_factor.empty() ? 1 : point_factor[vote.point]) / static_cast<double>(vote.squared_distance_m2);
  }
  [[nodiscard]] std::span<const DomainVote> of(std::size_t cell) const {
    return std::span(votes).subspan(begin[cell], begin[cell + 1] - begin[cell]);
  }
};

struct DomainVoteOptions : Run {
  Surroundings surroundings;
  /// Luminaires are no nearer to a point than this, and no farther than reach_m. 0 = a hundredth of the diagonal of the
  /// points' bounding box, at least 1 mm.
  double nearest_m = 0;
  double reach_m = std::numeric_limits<double>::infinity();
  std::span<const double> reflectance;  ///< per point, 0…1; empty = unknown, taken as 1
  /// If rays times layers exceed this, only every n-th ray is traced, with the least n that does not exceed it. This
  /// limits the memory, here to 218 MB (twice that if every ray crosses every layer twice). 0 = all.
  std::size_t max_votes = std::size_t{1} << 22;
};

/// Continues the open ray of each shadow edge, which the target lets pass, to every layer of the domain. A hit votes
/// for its cell unless environment or occluders are in the way. A cell's centre is the hit nearest to the weighted mean
/// of its hits: a place in the cell, on the domain, that a vote reached. The result does not depend on the number of
/// threads.
/// feature_of_point   of FeatureClusters
/// Refuses: no points (an object without recesses), no shadow edges (a closed box from inside; a plain sphere with
/// points chosen by hand), no vote that reaches the domain (with counts of the reasons), numbers that are not finite.
[[nodiscard]] Result<DomainVotes> vote_on_domain(const LightDomain& domain, const ShadowEdges& edges,
                                                 std::span<const OrientedPoint> points,
                                                 std::span<const std::uint32_t> feature_of_point,
                                                 const DomainVoteOptions& options);

}  // namespace luxrig
