#pragma once
/// How well an object's form can be seen in given light, as an adapted eye or an exposed camera gets it.
///
/// Luminance (reflectance × illuminance / π) of every sample, from all views; one exposure, metered on the object: x =
/// luminance / mean luminance of the object's samples; then the response R = x / (x + 1). That is the response of a
/// receptor adapted to the mean (Naka and Rushton, J. Physiol. 185, 1966, with exponent 1) and the photographic tone
/// curve (Reinhard et al., SIGGRAPH 2002): a toe and a shoulder, steepest at the mean per unit of log luminance.
///
/// Contrast is that of a pyramid of R (Burt and Adelson, IEEE Trans. Comm. 31, 1983; Peli, JOSA A 7, 1990): each level
/// less its own blur, over the object's pixels only. A contrast c counts as |c| / (|c| + h): what is seen already is not
/// seen better for being black. h falls with the contrast sensitivity at the level's frequency (Mannos and Sakrison, IEEE
/// Trans. IT 20, 1974; the object 10° wide). A contrast counts where the object has form at that scale: its weight is the
/// same pyramid of the surface's normals. So a shadow's edge or a beam's end across a flat place shows nothing of the
/// object, and a flat plane has no contrast in any light.
///
/// Source of the two groups of scales: faces and objects are told by 8 to 16 cycles per object (Costen, Parker and Craw,
/// Perception & Psychophysics 58, 1996), broad form by fewer.

#include <span>
#include <vector>

#include "core/highlight/seen/seen_view.h"

namespace luxrig {

/// Luminance over the metered mean. Middle grey is 18 %, so white is 1 / 0.18 (A. Adams, The Negative, 1981). A print's
/// black is 1 %, four stops down. Two stops down a shadow still reads as lit.
inline constexpr double kBurntOverMean = 1 / 0.18, kCrushedOverMean = 1.0 / 16, kLitOverMean = 1.0 / 4;

/// Weight of each term; all of them are 0…1. Relief and form are around 0.1 to 0.25 in usual light, a lit share 0.5 to 1.
struct SeenWishes {
  double fine_weight = 6, form_weight = 6, lit_weight = 1, edge_weight = 0.1;
  double clipped_weight = 1;  ///< of the burnt and crushed share beyond the stated one
  double max_clipped = 0.02;  ///< of the object's seen samples
  double even_weight = 0, shadows_weight = 0;
};

struct SeenScore {
  double fine = 0;       ///< contrast of relief: the two finest levels, 0…1
  double form = 0;       ///< of broad shapes: the next two levels, 0…1
  double lit_share = 0;  ///< of the object's samples: 1 from kLitOverMean up, falling to 0 at kCrushedOverMean
  double edge = 0;       ///< contrast of the object's outline against what is beside it, 0…1
  double burnt_share = 0, crushed_share = 0;  ///< of the object's samples
  double even = 0;       ///< 2 e / (e + mean) of illuminance e, mean over the object's samples: 1 = even, 0 = dark
  double shadows = 0;    ///< second_shadows(); 0 if their weight is
  double mean_lx = 0;    ///< mean illuminance of the object's samples, weighted by reflectance
  double objective = 0;  ///< weighted sum
};

/// Made once per object and views; a score is then arithmetic on lux (tens of microseconds for one view). May be used
/// from many threads.
class SeenContrast {
 public:
  /// views   at least one, each with samples of the object (asserted)
  SeenContrast(std::vector<SeenView> views, const SeenWishes& wishes);

  /// All views' samples, in order.
  [[nodiscard]] std::span<const OrientedPoint> samples() const { return samples_; }
  [[nodiscard]] const SeenWishes& wishes() const { return wishes_; }
  [[nodiscard]] bool of_object(std::size_t sample) const { return of_object_[sample] != 0; }
  /// Samples of the object along its outline, each once.
  [[nodiscard]] std::vector<std::uint32_t> outline() const;

  /// lux         at each sample, of all light, direct and reflected; finite and ≥ 0
  /// darkest_lx  an eye or a camera does not adapt to a darker object (mean illuminance)
  /// lights      the same of each light, for SeenScore::shadows; may be empty without a weight of theirs
  [[nodiscard]] SeenScore score(std::span<const float> lux, double darkest_lx = 0,
                                std::span<const std::vector<float>> lights = {}) const;
  /// Double and crossing shadows on the object: how long the edges of all cast shadows are but those of the light that
  /// draws most, weighted by their contrast, over the object's width; at most 1. An edge is where a light ends between
  /// neighbours that face alike, so a surface that turns away from a light has none.
  [[nodiscard]] double second_shadows(std::span<const float> lux, std::span<const std::vector<float>> lights) const;

 private:
  /// One level of a view's pyramid: constants of the object's form.
  struct Level {
    int width_px = 0, height_px = 0;
    std::vector<float> over_mask, over_blurred_mask;  ///< 1 / mask and 1 / its blur; 0 outside the object
    std::vector<float> weight;                        ///< of the object's form at this scale; sums to 1, or all are 0
    float half_contrast = 1;                          ///< counts as a half
  };
  struct View {
    SeenView seen;
    std::size_t first_sample = 0;
    std::vector<Level> levels;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> outline;  ///< samples inside and outside; kNothing = black
    std::vector<std::pair<std::uint32_t, std::uint32_t>> alike;    ///< of all views: neighbours that face alike
  };
  void add_levels(View& view) const;
  void score_view(const View& view, std::span<const float> response, SeenScore& score) const;

  SeenWishes wishes_;
  std::vector<View> views_;
  std::vector<OrientedPoint> samples_;
  std::vector<float> reflectance_;
  std::vector<std::uint8_t> of_object_;
  double object_samples_ = 0, reflectance_sum_ = 0;
};

}  // namespace luxrig
