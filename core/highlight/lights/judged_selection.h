#pragma once
/// Lights chosen for the local contrast that they make together: arithmetic on what each gives at every sample.

#include <optional>

#include "core/highlight/shadow/contrast_samples.h"
#include "core/highlight/surface/feature_clusters.h"

namespace luxrig {

/// A luminaire as it would hang, and its light.
struct JudgedLight {
  Vec3 position_world_m = Vec3::Zero();
  Vec3 direction = -Vec3::UnitZ();  ///< unit, in which it shines
  std::uint32_t place = 0;          ///< of JudgedLights
  std::vector<float> lux;           ///< at each of the samples' points
};

struct JudgedWishes {
  /// Of choices much alike in contrast the one that shows more features: what is made large is contrast × (1 + this ×
  /// coverage). So for coverage no more than this share of the contrast is given away.
  double coverage_weight = 0.1;
  /// Lights are so far apart as seen from the object. Contrast is convex in the lights' levels: without it the best of
  /// several are one place many times over.
  double least_angle_rad = rad_from_deg(30);
  double seen_lx = 0;            ///< a shadow's edge shows its feature where its lit side gets more than this
  std::vector<float> fixed_lux;  ///< light that stays, at each of the samples' points; empty: darkness
};

struct JudgedScore {
  double local_contrast_lx = 0, exposed_contrast = 0;  ///< as in SampleContrast
  double coverage = 0;                                 ///< share of features where one of the lights draws an edge seen
  double judged = 0;                                   ///< contrast × (1 + weight × coverage)
};

/// Lights taken so far. Local contrast is a seminorm of the illuminance: the sum of two has no more than both together.
/// So a candidate whose own contrast would not lift what there is above the best so far is never added up; which of
/// them is taken does not depend on that.
class JudgedSelection {
 public:
  /// All must stay.
  /// features     one cluster per interest point of the samples (asserted)
  /// candidates   each with lux for all samples (asserted)
  /// middle_world_m   of the object: where angles between lights are measured
  JudgedSelection(const ContrastSamples& samples, const FeatureClusters& features,
                  std::span<const JudgedLight> candidates, const Vec3& middle_world_m, JudgedWishes wishes);

  /// Takes the candidate that is best beside those taken, which stay as they are. Nothing when none is left that keeps
  /// its distance from them and lights anything. Ties: the one that has more contrast of its own.
  std::optional<std::uint32_t> add();
  void add(std::uint32_t candidate);
  /// Whether it keeps its distance from those taken.
  [[nodiscard]] bool stands_apart(std::uint32_t candidate) const;
  void remove(std::size_t i);  ///< the i-th taken; those after it move up
  /// Each light in turn gives way to the candidate that is best beside the others, until none does or so many rounds
  /// are over. Whether any did.
  bool settle(int most_rounds = 8);
  /// The i-th taken shines otherwise, if that is judged better. Whether it was.
  bool improve(std::size_t i, const JudgedLight& light);

  [[nodiscard]] std::span<const JudgedLight> taken() const { return taken_; }
  [[nodiscard]] JudgedScore score() const;
  [[nodiscard]] const JudgedWishes& wishes() const { return wishes_; }
  /// Contrast of each candidate alone, above that of light that stays at most so much is gained by it [lx].
  [[nodiscard]] const std::vector<double>& alone_lx() const { return alone_lx_; }
  [[nodiscard]] std::uint64_t added_up() const { return added_up_; }  ///< candidates beside others, by all steps so far

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
