#pragma once
/// Lights that votes on a domain speak for: at each cell's centre, in the directions where its votes gather (thesis
/// §6.5.3).

#include <vector>

#include "core/highlight/lights/domain_votes.h"
#include "core/run.h"

namespace luxrig {

struct PotentialLightOptions : Run {
  /// Full angle of the luminaire's beam: cone_of_flux_rad(intensity, 0.9) of core/photometry/beam.h.
  double beam_angle_rad = rad_from_deg(30);
  /// Lights with fewer votes than this, or with less weight than this share of the heaviest in their cell, are dropped.
  std::uint32_t least_votes = 8;
  double least_share = 0.1;
};

struct PotentialLight {
  Vec3 position_world_m;
  Vec3 direction;       ///< unit, in which it shines: against its votes' mean
  std::uint32_t cell;   ///< of DomainVotes
  std::uint32_t votes;  ///< within its beam
  double weight;        ///< of these [1/m²]
};

/// What a light has from one feature: of its votes' weight, and how many of its points voted.
struct LightVote {
  std::uint32_t feature, points;
  double weight;
};

struct PotentialLights {
  std::vector<PotentialLight> lights;      ///< by cell, in each the heaviest first
  std::vector<std::uint64_t> begin = {0};  ///< per light, and one more: of its entries in `votes`
  std::vector<LightVote> votes;            ///< per light by feature, rising
  std::uint32_t features = 0;
  std::vector<std::uint32_t> points_of_feature;
  [[nodiscard]] std::span<const LightVote> of(std::size_t light) const {
    return std::span(votes).subspan(begin[light], begin[light + 1] - begin[light]);
  }
};

/// In each cell mean-shift over the directions of its votes, by weight, with half the beam angle as window
/// (direction_modes); a light has the votes of its cell that lie within its beam, which are asked exactly, and of which
/// its direction is the mean. A vote may be in the beams of two. The same for any number of threads. Refuses a beam
/// angle outside 0.1° to 360° and a share outside 0…1; and when all are dropped.
[[nodiscard]] Result<PotentialLights> potential_lights(const DomainVotes& votes, const PotentialLightOptions& options);

}  // namespace luxrig
