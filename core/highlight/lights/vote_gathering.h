#pragma once
/// Internal: gathers votes point by point and sorts them into cells.

#include "core/highlight/lights/domain_votes.h"

namespace luxrig {

struct GatheredVote {
  DomainCell cell;
  std::uint32_t point;
  Vec3f direction;
  float squared_distance_m2;
};

struct GatheredPart {
  std::vector<GatheredVote> votes;
  DomainVoteCounts counts;
};

/// Fills cells (without their centres), begin, votes and counts. Parts are taken in order and emptied on the way.
void sort_into_cells(const LightDomain& domain, std::vector<GatheredPart>& parts,
                     std::span<const std::uint32_t> feature_of_point, DomainVotes& votes, int threads);

/// `wanted_m`, or, if that is 0, a hundredth of the diagonal of the box, at least 1 mm.
[[nodiscard]] double nearest_luminaire_m(double wanted_m, const Eigen::AlignedBox3d& points_m);

}  // namespace luxrig
