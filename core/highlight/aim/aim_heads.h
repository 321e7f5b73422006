#pragma once
/// Aims mounted heads: finds where they look, their zoom and their level, so that an object's relief shows.
///
/// Votes give the first aims. An interest point votes for the direction from a head to it if that head, where it hangs,
/// draws a shadow edge there; the directions with most votes are the head's first aims. The measured objective
/// (aim_objective.h) decides: head by head, every aim, zoom and level within the limits is tried with the other heads
/// fixed, until nothing gains. Then the aims are refined between the candidates. Visibility from each head is found
/// once (head_sight.h), so all of this is arithmetic.
///
/// Direct light of heads as points. Reflected light is fixed light, or the same everywhere (HangingHead::reflected_lx);
/// only what is seen takes the latter into account.

#include "core/highlight/aim/aim_objective.h"
#include "core/highlight/aim/hanging_head.h"
#include "core/result.h"
#include "core/run.h"

namespace luxrig {

/// This many interest points are enough to judge real lights; more take longer and change little.
constexpr std::size_t kAimPoints = 1000;

/// A stop ends the search with the best so far.
struct AimOptions : Run {
  std::size_t search_points = 800;  ///< interest points used by the search, evenly strided; the score uses all
  std::size_t max_aims = 24;        ///< candidates per head
};

struct AimedHead {
  HeadSetting setting;              ///< a dark head keeps its present aim
  Vec3 aim_world_m = Vec3::Zero();  ///< on the beam, at the distance of the object
  bool reaches = true;              ///< it can turn towards a part of the object that it sees
};

struct AimResult {
  std::vector<AimedHead> heads;  ///< one per head
  AimScore score;                ///< by all samples; within limits
  std::size_t tried = 0;         ///< settings of one head that were tried
  std::vector<AimScore> without;  ///< per head: the score with that head dark and the others as they are
  /// Per head: of a dark one, the most that the objective would change by if it were lit, over its first aims and some
  /// levels within the limits; NaN if the limits leave it none, and of a lit one.
  std::vector<double> gain_if_lit;
};

class HeadAims {
 public:
  /// samples, features   of the object (contrast_samples.h, feature_clusters.h)
  /// room                everything, including the object
  /// All must outlive it.
  /// Refuses: no interest points, no heads, no head that sees the object, numbers that are not finite, sizes that
  /// disagree, a key that is not a head, and fixed light that alone exceeds a limit.
  [[nodiscard]] static Result<HeadAims> make(const ContrastSamples& samples, const FeatureClusters& features,
                                             const RayScene& room, std::vector<HangingHead> heads, AimWishes wishes,
                                             const AimOptions& options);
  ~HeadAims();
  HeadAims(HeadAims&&) noexcept;
  HeadAims& operator=(HeadAims&&) noexcept;

  /// Score of these settings, one per head. Movements start from each head's present aim.
  [[nodiscard]] AimScore score(std::span<const HeadSetting> settings) const;
  /// The best settings found. Refuses if no head can turn to any part of the object that it sees.
  [[nodiscard]] Result<AimResult> solve() const;
  [[nodiscard]] double reference_lx() const;  ///< lux of the strongest head on the object, at full level

  struct State;  ///< aim_heads_state.h

 private:
  explicit HeadAims(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace luxrig
