#pragma once
/// How a camera's samples grow with light, and light made of them again.
///
/// A sample is a share of full scale, 0…1, as the camera gives it (encoded); light is a share of what fills a sample.
/// Sources: IEC 61966-2-1 (sRGB), Rec. ITU-R BT.709.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.h"

namespace luxrig {

class SampleCurve {
 public:
  /// In proportion above dark_share; requires 0 ≤ dark_share < 1, as all below.
  [[nodiscard]] static SampleCurve linear(double dark_share = 0);
  [[nodiscard]] static SampleCurve srgb(double dark_share = 0);
  [[nodiscard]] static SampleCurve bt709(double dark_share = 0);
  /// Light grows as the sample to this power.
  [[nodiscard]] static SampleCurve power(double exponent, double dark_share = 0);
  /// Points (sample, light), straight lines between them and beyond. Refuses fewer than two, samples that do not grow
  /// or are outside 0…1, light that falls or does not grow at all, what is not finite.
  [[nodiscard]] static Result<SampleCurve> through(std::vector<std::pair<double, double>> points);

  /// 0 for a sample without light; below it negative, so that noise around dark stays without bias.
  [[nodiscard]] double light(double sample) const;
  /// Light per sample.
  [[nodiscard]] double slope(double sample) const;
  [[nodiscard]] const std::vector<std::pair<double, double>>& points() const { return points_; }

 private:
  explicit SampleCurve(std::vector<std::pair<double, double>> points);
  [[nodiscard]] std::size_t segment(double sample) const;

  std::vector<std::pair<double, double>> points_;
  std::vector<std::size_t> first_segment_;  ///< by slices of the samples' range
};

/// As text: a head line "sample,light", then a line per point.
[[nodiscard]] std::string to_csv(const SampleCurve& curve);
/// Refuses what to_csv cannot have written, by line.
[[nodiscard]] Result<SampleCurve> sample_curve_from_csv(std::string_view text);

}  // namespace luxrig
