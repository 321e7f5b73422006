#pragma once
/// Private to aim_heads: a judge for some of the samples, and the search by it.

#include <memory>

#include "core/highlight/aim/aim_heads.h"
#include "core/highlight/aim/head_sight.h"

namespace luxrig {

/// Samples with what each head sees of them.
struct AimJudge {
  ContrastSamples samples;
  FeatureClusters features;
  AimWishes wishes;  ///< fixed_lux as the samples
  std::vector<HeadSight> sights, limit_sights;
  std::unique_ptr<AimObjective> objective;

  [[nodiscard]] AimColumn column(const HangingHead& head, std::size_t index, const HeadSetting& setting) const;
};

struct HeadAims::State {
  std::vector<HangingHead> heads;
  std::vector<std::vector<double>> cone_rad;  ///< per head and stop of its zoom: full angle of what counts as its beam
  AimOptions options;
  Vec3 middle_world_m = Vec3::Zero();  ///< of the interest points
  double reference_lx = 0, all_watts = 0;
  AimJudge full;
  std::unique_ptr<AimJudge> thinned;  ///< none: there are few samples
  [[nodiscard]] const AimJudge& search_judge() const { return thinned ? *thinned : full; }

  [[nodiscard]] AimSum sum(const AimJudge& judge, std::span<const HeadSetting> settings) const;
};

/// First aims of a head whose narrowest beam is that wide: unit, those with most votes first, the middle of what it
/// sees last; only where it can look.
[[nodiscard]] std::vector<Vec3> voted_aims(const HangingHead& head, double narrowest_rad, const HeadSight& sight,
                                           const ContrastSamples& samples, std::size_t most);

/// Settings by the search's judge, and how many were tried.
struct SearchedAims {
  std::vector<HeadSetting> settings;
  std::size_t tried = 0;
};
[[nodiscard]] SearchedAims search_aims(const HeadAims::State& state, const std::vector<std::vector<Vec3>>& first_aims);

}  // namespace luxrig
