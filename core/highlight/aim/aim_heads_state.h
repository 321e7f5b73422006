#pragma once
/// Private to aim_heads: an objective over some of the samples, and the search with it.

#include <memory>

#include "core/highlight/aim/aim_heads.h"
#include "core/highlight/aim/head_sight.h"

namespace luxrig {

/// Samples, with each head's view of them.
struct AimJudge {
  ContrastSamples samples;
  FeatureClusters features;
  AimWishes wishes;  ///< fixed_lux matches the samples
  std::vector<HeadSight> sights, limit_sights, seen_sights;
  std::unique_ptr<AimObjective> objective;

  [[nodiscard]] AimColumn column(const HangingHead& head, std::size_t index, const HeadSetting& setting) const;
};

struct HeadAims::State {
  std::vector<HangingHead> heads;
  std::vector<std::vector<double>> cone_rad;  ///< per head and zoom stop: full angle of the beam
  AimOptions options;
  Vec3 middle_world_m = Vec3::Zero();  ///< of the interest points
  double reference_lx = 0, all_watts = 0;
  AimJudge full;
  std::unique_ptr<AimJudge> thinned;  ///< empty if there are few samples and no coarser picture
  [[nodiscard]] const AimJudge& search_judge() const { return thinned ? *thinned : full; }

  [[nodiscard]] AimSum sum(const AimJudge& judge, std::span<const HeadSetting> settings) const;
};

/// First aims of a head with this narrowest beam: unit, by falling votes, then the middle of what it sees. Only
/// directions that it can reach.
[[nodiscard]] std::vector<Vec3> voted_aims(const HangingHead& head, double narrowest_rad, const HeadSight& sight,
                                           const ContrastSamples& samples, std::size_t most);

/// Settings found with search_judge(), and the number tried; of what is seen, refined with all samples.
struct SearchedAims {
  std::vector<HeadSetting> settings;
  std::size_t tried = 0;
};
[[nodiscard]] SearchedAims search_aims(const HeadAims::State& state, const std::vector<std::vector<Vec3>>& first_aims);

}  // namespace luxrig
