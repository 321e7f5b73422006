#pragma once
/// Pictures of a still scene at several exposures, prepared for judging a camera: groups of pixels with equal light,
/// the mean of their samples at each exposure, and their variation between frames.

#include <vector>

#include "core/result.h"

namespace luxrig {

struct ExposureStep {
  double exposure_s = 0;
  std::vector<std::vector<float>> frames;  ///< samples of one channel as shares of full scale, in pixel order
};

struct ExposureSeries {
  int full_scale_counts = 255;      ///< steps of the digitiser
  std::vector<ExposureStep> steps;  ///< exposures rising
};

/// Exposures from shortest to longest, whose ratios alternate between two values without a common power. With a
/// geometric series, a response curve could not be distinguished from one with a ripple whose period is the ratio.
/// Source: M. Grossberg and S. Nayar, What is the space of camera response functions? (2003), on ambiguities.
[[nodiscard]] std::vector<double> exposures_between(double shortest_s, double longest_s, int count);

/// One group at one exposure.
struct GroupSample {
  double mean = 0;           ///< share of full scale
  double variance = 0;       ///< of a sample over time, without variation common to the group
  double mean_variance = 0;  ///< of `mean`
  std::size_t samples = 0;
  bool usable = false;  ///< not clipped at either end
};

struct SampleGroups {
  std::vector<double> exposures_s;
  std::vector<std::vector<GroupSample>> groups;  ///< [group][step], from dark to bright
  double saturation = 1;                         ///< share of full scale at which samples stop rising
  bool saturates = false;                        ///< saturation was reached; false = it is the largest sample seen
  double flicker = 0;        ///< relative standard deviation of whole frames at one exposure; the worst
  double clipped_share = 0;  ///< share of samples that are full at the shortest exposure
  double floor = 0;          ///< share of full scale; samples at or below it may be cut off
  double follows = 0;        ///< ratio of samples at the longest exposure to those at the shortest
};

/// Assigns pixels to groups by the first frames and measures them in all others, so that noise does not select its own
/// group. Cause::invalid: fewer than 3 exposures or 3 frames of each, frames of different sizes or fewer than 64
/// pixels, exposures that do not rise, samples that are not finite.
[[nodiscard]] Result<SampleGroups> group_samples(const ExposureSeries& series);

}  // namespace luxrig
