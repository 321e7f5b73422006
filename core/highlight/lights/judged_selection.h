#pragma once
/// Lights chosen for their joint local contrast: arithmetic on the light of each at every sample.

#include <optional>

#include "core/highlight/shadow/contrast_samples.h"
#include "core/highlight/surface/feature_clusters.h"

namespace luxrig {

/// A luminaire as it would hang, and its light.
struct JudgedLight {
  Vec3 position_world_m = Vec3::Zero();
  Vec3 direction = -Vec3::UnitZ();  ///< unit, of its beam
  std::uint32_t place = 0;          ///< index in JudgedLights
  std::vector<float> lux;           ///< at each of the samples' points
};

struct JudgedWishes {
  /// Of choices with similar contrast, prefers the one that shows more features: the objective is contrast × (1 + this
  /// × coverage). So coverage costs at most this share of the contrast.
  double coverage_weight = 0.1;
  /// Least angle between lights as seen from the object. Contrast is convex in the lights' levels: without a limit the
  /// best set is one place many times over.
  double min_angle_rad = rad_from_deg(30);
  double seen_lx = 0;            ///< a shadow edge shows its feature if its lit side gets more than this
  std::vector<float> fixed_lux;  ///< light that stays on, at each sample point; empty = darkness
};

struct JudgedScore {
  double local_contrast_lx = 0, exposed_contrast = 0;  ///< as in SampleContrast
  double coverage = 0;                                 ///< share of features where a light draws a visible edge
  double judged = 0;                                   ///< contrast × (1 + weight × coverage)
};

/// Lights chosen so far. Local contrast is a seminorm of the illuminance: the contrast of a sum is at most the sum of
/// the contrasts. So a candidate whose own contrast cannot lift the total above the best so far is skipped; that does
/// not change the choice.
class JudgedSelection {
 public:
  /// All must outlive it.
  /// features     one cluster per interest point of the samples (asserted)
  /// candidates   each with lux for all samples (asserted)
  /// middle_world_m   of the object: vertex of the angles between lights
  JudgedSelection(const ContrastSamples& samples, const FeatureClusters& features,
                  std::span<const JudgedLight> candidates, const Vec3& middle_world_m, JudgedWishes wishes);

  /// Adds the best candidate, with the chosen ones fixed. Empty when no candidate is left that stands apart from them
  /// and lights anything. Ties: the one with more contrast of its own.
  std::optional<std::uint32_t> add();
  void add(std::uint32_t candidate);
  /// Whether it keeps its distance from the chosen lights.
  [[nodiscard]] bool stands_apart(std::uint32_t candidate) const;
  void remove(std::size_t i);  ///< the i-th chosen; later ones move up
  /// Replaces each light in turn by the best candidate with the others fixed, until no replacement gains or after
  /// max_rounds. True if any light was replaced.
  bool settle(int max_rounds = 8);
  /// Replaces the i-th chosen light by this one if that is judged better. True if so.
  bool improve(std::size_t i, const JudgedLight& light);

  [[nodiscard]] std::span<const JudgedLight> taken() const { return taken_; }
  [[nodiscard]] JudgedScore score() const;
  [[nodiscard]] const JudgedWishes& wishes() const { return wishes_; }
  /// Contrast of each candidate alone: upper bound of its gain over fixed light [lx].
  [[nodiscard]] std::uint64_t added_up() const { return added_up_; }  ///< candidates added to others, in all steps so
                                                                      ///< far

 private:
  using Shown = std::vector<std::uint64_t>;  // a bit per feature
  struct Others {
    std::vector<float> lux;
    Shown shown;
    double contrast_lx = 0;
    std::vector<Vec3> from;
  };
  struct Choice {
    std::uint32_t candidate = 0;
    double judged = -1;
  };
  [[nodiscard]] Shown shown_by(const JudgedLight& light) const;
  [[nodiscard]] Vec3 from(const JudgedLight& light) const;
  [[nodiscard]] bool stands_apart(const JudgedLight& light, std::span<const Vec3> from_others) const;
  [[nodiscard]] Others others_than(std::size_t left_out) const;
  [[nodiscard]] double judged(double contrast_lx, const Shown& a, const Shown& b) const;
  [[nodiscard]] double beside(const Others& others, const JudgedLight& light, const Shown& shown) const;
  [[nodiscard]] std::optional<Choice> best_beside(const Others& others) const;

  const ContrastSamples& samples_;
  const FeatureClusters& features_;
  std::span<const JudgedLight> candidates_;
  Vec3 middle_world_m_;
  JudgedWishes wishes_;
  std::vector<double> alone_lx_;  // per candidate
  std::vector<Shown> shown_;
  std::vector<JudgedLight> taken_;
  std::vector<Shown> taken_shown_;
  mutable std::uint64_t added_up_ = 0;
};

}  // namespace luxrig
