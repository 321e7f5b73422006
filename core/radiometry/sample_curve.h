#pragma once
/// How a camera's samples grow with light, and the conversion back to light.
///
/// A sample is a share of full scale, 0…1, as the camera gives it (encoded). Light is a share of the light that fills a
/// sample. Sources: IEC 61966-2-1 (sRGB), Rec. ITU-R BT.709.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.h"

namespace luxrig {

class SampleCurve {
 public:
  /// Proportional above dark_share; requires 0 ≤ dark_share < 1, as for all below.
  [[nodiscard]] static SampleCurve linear(double dark_share = 0);
  [[nodiscard]] static SampleCurve srgb(double dark_share = 0);
  [[nodiscard]] static SampleCurve bt709(double dark_share = 0);
  /// Light grows as the sample to this power.
  [[nodiscard]] static SampleCurve power(double exponent, double dark_share = 0);
  /// Points (sample, light) with straight lines between them and beyond. Refuses fewer than two points, samples that do
  /// not grow or are outside 0…1, light that falls or never grows, and values that are not finite.
  [[nodiscard]] static Result<SampleCurve> through(std::vector<std::pair<double, double>> points);

  /// 0 for a sample without light; negative below that, so that noise around dark has no bias.
  [[nodiscard]] double light(double sample) const;
  /// Light per sample.
  [[nodiscard]] double slope(double sample) const;
  [[nodiscard]] const std::vector<std::pair<double, double>>& points() const { return points_; }

 private:
  explicit SampleCurve(std::vector<std::pair<double, double>> points);
  [[nodiscard]] std::size_t segment(double sample) const;

  std::vector<std::pair<double, double>> points_;
  std::vector<std::size_t> first_segment_;  ///< by intervals of the samples' range
};

/// As text: a header line "sample,light", then one line per point.
[[nodiscard]] std::string to_csv(const SampleCurve& curve);
/// Refuses text that to_csv cannot have written, naming the line.
[[nodiscard]] Result<SampleCurve> sample_curve_from_csv(std::string_view text);

}  // namespace luxrig
