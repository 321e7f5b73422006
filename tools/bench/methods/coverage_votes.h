#pragma once
/// Votes of a whole surface for luminaires that light it: maximum surface coverage on a light domain, the method to
/// compare highlighting with (thesis §6.5.5).

#include "core/highlight/lights/domain_votes.h"
#include "core/highlight/shadow/target_rays.h"
#include "core/highlight/surface/target_surface.h"
#include "core/run.h"

namespace luxrig {

struct CoverageVoteOptions : Run {
  Surroundings surroundings;
  double nearest_m = 0;  ///< as in DomainVoteOptions
  double reach_m = std::numeric_limits<double>::infinity();
  std::size_t max_points = 2000;                 ///< a larger surface is judged by evenly strided points
  std::size_t max_votes = std::size_t{1} << 23;  ///< even fewer points, if half of all cells reach each
};

struct CoverageVotes {
  DomainVotes votes;
  std::vector<std::uint32_t> surface_point;  ///< per voting point
};

/// Every point votes, with its share of the area / d², for the middle of each cell of the domain from which light
/// reaches it. Each point is a feature of its own, so that LightSelection strikes votes by point. Points are numbered
/// in the order of the surface. The same for any number of threads. Refuses a surface without points, meaningless
/// numbers, and a domain from which nothing is lit.
[[nodiscard]] Result<CoverageVotes> vote_for_coverage(const LightDomain& domain, const TargetSurface& surface,
                                                      const TargetRays& target, const CoverageVoteOptions& options);

}  // namespace luxrig
