#pragma once
/// Lights that votes on a domain suggest: at each cell's centre, in the directions where its votes cluster (thesis
/// §6.5.3).

#include <vector>

#include "core/highlight/lights/domain_votes.h"
#include "core/run.h"

namespace luxrig {

struct PotentialLightOptions : Run {
  /// Full angle of the luminaire's beam: cone_of_flux_rad(intensity, 0.9) of core/photometry/beam.h.
  double beam_angle_rad = rad_from_deg(30);
  /// Lights with fewer votes than this, or less weight than this share of the heaviest in their cell, are dropped.
  std::uint32_t min_votes = 8;
  double min_share = 0.1;
};

struct PotentialLight {
  Vec3 position_world_m;
  Vec3 direction;       ///< unit, of its beam: opposite to its votes' mean
  std::uint32_t cell;   ///< of DomainVotes
  std::uint32_t votes;  ///< within its beam
  double weight;        ///< of these votes [1/m²]
};

/// Votes of one feature for a light: their weight, and the number of points that voted.
struct LightVote {
  std::uint32_t feature, points;
  double weight;
};

struct PotentialLights {
  std::vector<PotentialLight> lights;      ///< by cell, heaviest first within each
  std::vector<std::uint64_t> begin = {0};  ///< per light, plus one: of its entries in `votes`
  std::vector<LightVote> votes;            ///< by light, then by feature, rising
  std::uint32_t features = 0;
  std::vector<std::uint32_t> points_of_feature;
  [[nodiscard]] std::span<const LightVote> of(std::size_t light) const {
    return std::span(votes).subspan(begin[light], begin[light + 1] - begin[light]);
  }
};

/// Mean-shift in each cell over its vote directions, weighted, with half the beam angle as window (direction_modes). A
/// light has exactly the votes of its cell within its beam; its direction is their mean. A vote may be in the beams of
/// two lights. The result does not depend on the number of threads. Refuses a beam angle outside 0.1° to 360°, a share
/// outside 0…1, and votes whose lights are all dropped.
[[nodiscard]] Result<PotentialLights> potential_lights(const DomainVotes& votes, const PotentialLightOptions& options);

}  // namespace luxrig
