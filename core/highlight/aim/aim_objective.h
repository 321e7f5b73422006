#pragma once
/// The objective for aimed heads: what is seen of the object (seen_contrast.h), or local contrast and covered features
/// as in the thesis; against energy, darkness and long moves, under limits of lux.

#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/highlight/seen/seen_contrast.h"
#include "core/highlight/seen/seen_role.h"
#include "core/highlight/shadow/contrast_samples.h"
#include "core/highlight/surface/feature_clusters.h"

namespace luxrig {

/// A place with limited light: on a surface, or (normal zero) an eye or a camera, which no beam may blind.
struct AimLimit {
  std::string name;
  OrientedPoint at;
  double max_lx = 0;    ///< 0 = stays dark
  double fixed_lx = 0;  ///< of light that stays on
};

/// What is made large. With `seen` and `relative` heads are as bright as the limits allow, unless energy has a weight.
enum class AimMeasure {
  lux,       ///< local contrast in lux
  relative,  ///< local contrast relative to both places
  seen,      ///< SeenScore::objective; covered features count nothing
};

struct AimWishes {
  AimMeasure measure = AimMeasure::lux;
  /// Needed if `measure` is seen; otherwise both are empty. `quick` is a coarser picture for the first search.
  std::shared_ptr<const SeenContrast> seen, seen_quick;
  std::vector<AimLimit> limits;
  double max_object_lx = std::numeric_limits<double>::infinity();  ///< at every sample of the object
  double max_watts = std::numeric_limits<double>::infinity();      ///< of all heads together
  /// Mean illuminance of the interest points by the key light, over that by everything else.
  std::optional<std::size_t> key;  ///< a head
  double min_key_to_fill = 0, max_key_to_fill = std::numeric_limits<double>::infinity();
  /// Weight of each term against a local contrast of HeadAims::reference_lx(), or a relative contrast of 1.
  double coverage_weight = 0.25, energy_weight = 0, base_weight = 0, travel_weight = 0.01;
  double base_lx = 0;  ///< wanted at interest points, with base_weight
  /// Fixed light (daylight, lights that stay on) at each sample [lx]; empty = darkness.
  std::vector<double> fixed_lux;
  std::vector<float> seen_fixed_lux, seen_quick_fixed_lux;  ///< the same at the samples of `seen` and `seen_quick`
  SeenRole role, quick_role;                                ///< of all heads together, at the same samples

  [[nodiscard]] bool limited() const {
    return !limits.empty() || std::isfinite(max_object_lx) || std::isfinite(max_watts) || key.has_value() ||
           role.wanted_lx > 0;
  }
};

enum class HeadRole { any, key, fill };
[[nodiscard]] inline HeadRole role_in(const AimWishes& wishes, std::size_t head) {
  if (!wishes.key) return HeadRole::any;
  return *wishes.key == head ? HeadRole::key : HeadRole::fill;
}

/// Score of heads at their settings.
struct AimScore {
  double local_contrast_lx = 0;  ///< largest difference in illuminance to a neighbour, mean over interest points
  /// Mean of the largest |E - E'| / (E + E' + a tenth of the mean): an eye sees anything darker as dark, and in reality
  /// reflected light would fill it.
  double relative_contrast = 0;
  double coverage = 0;    ///< share of features where a head draws a visible shadow edge
  double mean_lx = 0;     ///< of interest points
  double below_base = 0;  ///< share of base_lx that is missing, mean over interest points, 0…1
  double watts = 0;
  double travel_s = 0;                                            ///< until the last head has arrived
  double key_to_fill = std::numeric_limits<double>::quiet_NaN();  ///< NaN without a key
  double object_lx = 0;                                           ///< of the brightest sample
  std::vector<double> limit_lx;                                   ///< at each of AimWishes::limits
  bool within_limits = true;
  std::optional<SeenScore> seen;  ///< if the measure is `seen`
  std::optional<RoleScore> role;  ///< if a role is asked for
  double objective = 0;  ///< the measure (contrast in lux over reference_lx) + weighted terms; the search maximises it
};

/// Light of one head at full level at everything that is judged.
struct AimColumn {
  std::vector<double> sample_lux, limit_lux;
  std::vector<double> feature_lux;  ///< in each feature: on the lit side of the head's brightest shadow edge
  double mean_lux = 0;              ///< over interest points
  std::vector<float> seen_lux;      ///< at the samples of AimWishes::seen
};

/// Light of all heads together.
struct AimSum {
  std::vector<double> sample_lux, limit_lux;
  std::vector<float> seen_lux;
  std::vector<std::vector<float>> seen_lux_of_each;  ///< the light that stays, then each head's; only if shadows count
  std::vector<std::uint8_t> covered;                 ///< per feature
  double mean_lux = 0, key_mean_lux = 0, levels = 0, watts = 0, travel_s = 0, travel_total_s = 0;
};

class AimObjective {
 public:
  /// All must outlive it.
  /// reference_lx   the strongest head's lux on the object, which is the unit of contrast; > 0
  AimObjective(const ContrastSamples& samples, const FeatureClusters& features, const AimWishes& wishes,
               double reference_lx, double all_watts);

  [[nodiscard]] std::size_t samples() const { return samples_.points.size(); }
  /// The fixed light alone.
  [[nodiscard]] AimSum nothing() const;
  /// lux   of a head at every sample, and at every limit
  [[nodiscard]] AimColumn column(std::vector<double> sample_lux, std::vector<double> limit_lux,
                                 std::vector<float> seen_lux) const;
  void add(AimSum& sum, const AimColumn& column, double level, HeadRole role, double watts, double travel_s) const;

  /// Largest level at which the added light breaks no limit; 0 if one is already broken.
  /// watts    of the head at full level
  /// ratios   also keep the ratio of key to fill, and the role's lux
  [[nodiscard]] double highest_level(const AimSum& others, const AimColumn& column, HeadRole role, double max_level,
                                     double watts, bool ratios = true) const;
  [[nodiscard]] AimScore score(const AimSum& sum) const { return scored(sum, true); }
  /// AimScore::objective, without measures that do not count in it.
  [[nodiscard]] double objective(const AimSum& sum) const { return scored(sum, false).objective; }

  /// Mean over what the role wants lit, by the heads' own light.
  [[nodiscard]] double own_wanted_lx(const AimSum& sum) const;

 private:
  [[nodiscard]] AimScore scored(const AimSum& sum, bool all) const;
  void measure_contrast(const AimSum& sum, AimScore& score) const;

  const ContrastSamples& samples_;
  const FeatureClusters& features_;
  const AimWishes& wishes_;
  double reference_lx_, all_watts_;
};

}  // namespace luxrig
