#pragma once
/// Aiming what hangs: where given heads look, how far they zoom and how bright they are, so that an object's relief
/// reads.
///
/// Votes are where it begins: an interest point votes for the direction from a head to it when that head, where it
/// hangs, draws a shadow's edge there; each head's directions with most votes are its first aims. The measured
/// objective (aim_objective.h) is the judge: head by head, every aim, zoom and level that the limits leave is tried
/// with the others as they are, until none gains; then the aims are refined between the candidates. What a head can see
/// is found once (head_sight.h), so that all of this is arithmetic.
///
/// Direct light of heads that are points. What is reflected counts as fixed light when it is given.

#include "core/highlight/aim/aim_objective.h"
#include "core/highlight/aim/hanging_head.h"
#include "core/result.h"
#include "core/run.h"

namespace luxrig {

/// So many interest points are enough to judge real lights by: more take longer and change little.
constexpr std::size_t kAimPoints = 1000;

/// A stop ends the search with the best so far.
struct AimOptions : Run {
  std::size_t search_points = 800;  ///< interest points that the search judges by, evenly strided; the answer by all
  std::size_t most_aims = 24;       ///< candidates per head
};

struct AimedHead {
  HeadSetting setting;              ///< a head that stays dark stays where it looks
  Vec3 aim_world_m = Vec3::Zero();  ///< on the beam, as far away as the object
  bool reaches = true;              ///< it can be turned towards something of the object that it sees
};

struct AimResult {
  std::vector<AimedHead> heads;  ///< one per head
  AimScore score;                ///< by all samples; within limits
  std::size_t tried = 0;         ///< settings of one head
};

class HeadAims {
 public:
  /// samples, features   of the object (contrast_samples.h, feature_clusters.h); room: everything, the object too. All
  /// must stay.
  /// Refuses: no interest points, no heads, heads none of which sees any of the object, numbers that are not finite,
  /// sizes that disagree, a key that is no head, and light that stays which is alone above a limit.
  [[nodiscard]] static Result<HeadAims> make(const ContrastSamples& samples, const FeatureClusters& features,
                                             const RayScene& room, std::vector<HangingHead> heads, AimWishes wishes,
                                             const AimOptions& options);
  ~HeadAims();
  HeadAims(HeadAims&&) noexcept;
  HeadAims& operator=(HeadAims&&) noexcept;

  /// Of these settings, one per head: movements are from where each head looks now.
  [[nodiscard]] AimScore score(std::span<const HeadSetting> settings) const;
  /// The best settings found. A refusal when no head can be turned to anything that it sees of the object.
  [[nodiscard]] Result<AimResult> solve() const;
  [[nodiscard]] double reference_lx() const;  ///< lux of the strongest head on the object, at full level

  struct State;  ///< aim_heads_state.h

 private:
  explicit HeadAims(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace luxrig
