#pragma once
/// Pictures of a still scene at several exposures, and what of them a camera is judged by: groups of pixels that get
/// the same light, with the mean of their samples at each exposure and how they vary from frame to frame.

#include <vector>

#include "core/result.h"

namespace luxrig {

struct ExposureStep {
  double exposure_s = 0;
  std::vector<std::vector<float>> frames;  ///< samples of one channel as shares of full scale, pixel by pixel
};

struct ExposureSeries {
  int full_scale_counts = 255;      ///< steps of the converter
  std::vector<ExposureStep> steps;  ///< exposures rising
};

/// Exposures from shortest to longest whose ratios take turns between two that have no common power: of a geometric
/// series a response curve could not be told from one with a wave of the ratio's period.
/// Source: M. Grossberg and S. Nayar, What is the space of camera response functions? (2003), on ambiguities.
[[nodiscard]] std::vector<double> exposures_between(double shortest_s, double longest_s, int count);

/// One group at one exposure.
struct GroupSample {
  double mean = 0;           ///< share of full scale
  double variance = 0;       ///< of a sample in time, without what all of the group do together
  double mean_variance = 0;  ///< of `mean`
  std::size_t samples = 0;
  bool usable = false;  ///< nothing of it is clipped, at either end
};

struct SampleGroups {
  std::vector<double> exposures_s;
  std::vector<std::vector<GroupSample>> groups;  ///< [group][step], from dark to bright
  double saturation = 1;                         ///< share of full scale at which samples rise no more
  bool saturates = false;                        ///< it was reached; else the largest that was seen
  double flicker = 0;  ///< standard deviation of what frames of one exposure differ by as a whole, of their mean, worst
  double clipped_share = 0;  ///< of samples at the shortest exposure that are full
  double floor = 0;          ///< share of full scale; samples at or below it may have been cut off there
  double follows = 0;        ///< how many times brighter samples get from the shortest exposure to the longest
};

/// Pixels are put into groups by the first frames and measured by all others, so that noise does not choose its own
/// group. Cause::invalid: fewer than 3 exposures or 3 frames of each, frames of different sizes or fewer than 64
/// pixels, exposures that do not rise, samples that are not finite.
[[nodiscard]] Result<SampleGroups> group_samples(const ExposureSeries& series);

}  // namespace luxrig
