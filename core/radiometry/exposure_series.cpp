#include "core/radiometry/exposure_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace luxrig {
namespace {

constexpr std::size_t kMinPixels = 64, kGroupPixels = 8, kMaxGroups = 256;
constexpr double kGroupWidth = 0.03;  // a pixel brighter by this much starts another group
constexpr double kNearlyAll = 0.999, kPlateau = 0.01, kClippedAllowed = 0.001;
constexpr double kSharesOfRatios[2] = {1.0, 1.7};

Result<void> check_series(const ExposureSeries& series) {
  if (series.steps.size() < 3) return refusal("a series needs three exposures at least");
  if (series.full_scale_counts < 1) return refusal("a converter without steps");
  const std::size_t pixels = series.steps[0].frames.empty() ? 0 : series.steps[0].frames[0].size();
  if (pixels < kMinPixels) return refusal(fmt::format("pictures of {} pixels", pixels));
  double last_s = 0;
  for (const ExposureStep& step : series.steps) {
    if (!std::isfinite(step.exposure_s) || !(step.exposure_s > last_s))
      return refusal(fmt::format("exposures that do not rise: {} s after {} s", step.exposure_s, last_s));
    last_s = step.exposure_s;
    if (step.frames.size() < 3) return refusal("a series needs three pictures of each exposure at least");
    for (const std::vector<float>& frame : step.frames) {
      if (frame.size() != pixels) return refusal("a series with pictures of different sizes");
      for (const float sample : frame)
        if (!std::isfinite(sample)) return refusal("a series with samples that are no numbers");
    }
  }
  return {};
}

double nearly_largest(const ExposureStep& step) {
  std::vector<float> all = step.frames.back();
  const auto at = static_cast<std::ptrdiff_t>(kNearlyAll * static_cast<double>(all.size() - 1));
  std::nth_element(all.begin(), all.begin() + at, all.end());
  return static_cast<double>(all[static_cast<std::size_t>(at)]);
}

/// Finds the level at which samples stop rising although the exposure does.
void find_saturation(const ExposureSeries& series, SampleGroups& out) {
  const double count = 1.0 / series.full_scale_counts;
  const ExposureStep &longest = series.steps.back(), &before = series.steps[series.steps.size() - 2];
  const double top = nearly_largest(longest), top_before = nearly_largest(before);
  const bool at_full_scale = top >= 1 - 0.5 * count;
  const bool plateau =
      top <= top_before * (1 + kPlateau) && longest.exposure_s > before.exposure_s * (1 + 5 * kPlateau);
  out.saturates = at_full_scale || plateau;
  out.saturation = at_full_scale ? 1.0 : top;
  if (!out.saturates) return;
  const std::vector<float>& shortest = series.steps.front().frames.back();
  std::size_t clipped = 0;
  for (const float sample : shortest)
    clipped += static_cast<double>(sample) >= out.saturation * (1 - kPlateau) - 0.5 * count;
  out.clipped_share = static_cast<double>(clipped) / static_cast<double>(shortest.size());
}

/// If many samples are as dark as the darkest, noise is cut off: by zero, or by electronics before they add a dark
/// level.
void find_floor(const ExposureSeries& series, SampleGroups& out) {
  const double half_count = 0.5 / series.full_scale_counts;
  out.floor = half_count;
  float least = 1;
  std::size_t at_least = 0, all = 0;
  for (const std::vector<float>& frame : series.steps.front().frames)
    for (const float sample : frame) {
      if (sample < least) least = sample, at_least = 0;
      at_least += sample == least;
      ++all;
    }
  if (static_cast<double>(at_least) > kClippedAllowed * static_cast<double>(all))
    out.floor = std::max(out.floor, static_cast<double>(least) + half_count);
}

/// First pixels of groups in `order`, and the end of `order`. brightness: sum of a pixel's samples over all exposures.
std::vector<std::size_t> cuts_of(const ExposureSeries& series, const SampleGroups& of,
                                 const std::vector<std::size_t>& order, const std::vector<double>& brightness) {
  const double darkest = brightness[order.front()] / static_cast<double>(series.steps.size());
  // Full samples do not show how bright a pixel is.
  const auto told = [&](std::size_t pixel) {
    double sum = 0;
    for (const ExposureStep& step : series.steps)
      if (const auto sample = static_cast<double>(step.frames[0][pixel]);
          !of.saturates || sample < 0.95 * of.saturation)
        sum += sample - darkest;
    return sum;
  };
  const auto width_from = [&](std::size_t pixel) {
    return std::max(kGroupWidth * told(pixel), 1.0 / series.full_scale_counts);
  };
  const std::size_t most = std::max(kGroupPixels, order.size() / kMaxGroups);
  std::vector<std::size_t> cuts = {0};
  double width = width_from(order.front());
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (i - cuts.back() < most && brightness[order[i]] <= brightness[order[cuts.back()]] + width) continue;
    cuts.push_back(i);
    width = width_from(order[i]);
  }
  cuts.push_back(order.size());
  return cuts;
}

GroupSample measure(const ExposureStep& step, const std::vector<std::size_t>& order, std::size_t begin, std::size_t end,
                    const SampleGroups& of, double count) {
  GroupSample out;
  const auto pixels = static_cast<double>(end - begin);
  std::size_t clipped = 0;
  double sum = 0, variance = 0;
  int pairs = 0;
  for (std::size_t f = 1; f < step.frames.size(); ++f) {
    double together = 0, squares = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const auto sample = static_cast<double>(step.frames[f][order[i]]);
      sum += sample;
      clipped += sample <= of.floor || (of.saturates && sample >= of.saturation - 0.5 * count);
      if (f < 2) continue;
      const double difference = sample - static_cast<double>(step.frames[f - 1][order[i]]);
      together += difference;
      squares += difference * difference;
    }
    if (f < 2) continue;
    variance += (squares - together * together / pixels) / (2 * (pixels - 1));
    ++pairs;
  }
  out.samples = (end - begin) * (step.frames.size() - 1);
  const auto samples = static_cast<double>(out.samples);
  out.mean = sum / samples;
  out.variance = variance / pairs;
  // Rounding to counts does not average out if noise is smaller than a count.
  const double rounding = 0.1 * count;
  out.mean_variance = out.variance / samples + rounding * rounding;
  const double room = 4 * std::sqrt(out.variance);
  out.usable = static_cast<double>(clipped) <= kClippedAllowed * samples &&
               (!of.saturates || out.mean + room < of.saturation * (1 - 2 * kPlateau));
  return out;
}

/// Variation of whole frames, where nothing is clipped.
double flicker_of(const ExposureStep& step, const std::vector<std::size_t>& pixels) {
  if (pixels.empty()) return 0;
  std::vector<double> means;
  for (const std::vector<float>& frame : step.frames) {
    double sum = 0;
    for (const std::size_t p : pixels) sum += static_cast<double>(frame[p]);
    means.push_back(sum / static_cast<double>(pixels.size()));
  }
  const double mean = std::accumulate(means.begin(), means.end(), 0.0) / static_cast<double>(means.size());
  if (!(mean > 0)) return 0;
  double squares = 0;
  for (const double m : means) squares += (m - mean) * (m - mean);
  return std::sqrt(squares / static_cast<double>(means.size() - 1)) / mean;
}

}  // namespace

std::vector<double> exposures_between(double shortest_s, double longest_s, int count) {
  double whole = 0;
  for (int i = 1; i < count; ++i) whole += kSharesOfRatios[i % 2];
  std::vector<double> exposures;
  double at = 0;
  for (int i = 0; i < count; ++i) {
    if (i > 0) at += kSharesOfRatios[i % 2];
    exposures.push_back(shortest_s * std::pow(longest_s / shortest_s, whole > 0 ? at / whole : 0));
  }
  return exposures;
}

Result<SampleGroups> group_samples(const ExposureSeries& series) {
  if (auto good = check_series(series); !good) return tl::unexpected(good.error());
  const double count = 1.0 / series.full_scale_counts;
  SampleGroups out;
  find_saturation(series, out);
  find_floor(series, out);
  const std::size_t pixels = series.steps[0].frames[0].size();
  std::vector<double> brightness(pixels, 0.0);
  for (const ExposureStep& step : series.steps) {
    out.exposures_s.push_back(step.exposure_s);
    for (std::size_t p = 0; p < pixels; ++p) brightness[p] += static_cast<double>(step.frames[0][p]);
  }
  std::vector<std::size_t> order(pixels);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return brightness[a] < brightness[b]; });
  const std::vector<std::size_t> cuts = cuts_of(series, out, order, brightness);
  for (std::size_t c = 0; c + 1 < cuts.size(); ++c) {
    if (cuts[c + 1] - cuts[c] < kGroupPixels) continue;
    std::vector<GroupSample> group;
    for (const ExposureStep& step : series.steps)
      group.push_back(measure(step, order, cuts[c], cuts[c + 1], out, count));
    out.groups.push_back(std::move(group));
  }
  for (std::size_t s = 0; s < series.steps.size(); ++s) {
    // Pixels with light well above noise: the upper half of the usable ones.
    std::vector<std::size_t> bright;
    for (const std::size_t p : order) {
      const auto& frames = series.steps[s].frames;
      const bool inside = std::all_of(frames.begin(), frames.end(), [&](const std::vector<float>& f) {
        const auto sample = static_cast<double>(f[p]);
        return sample > out.floor && sample < (out.saturates ? 0.95 * out.saturation : 2.0);
      });
      if (inside) bright.push_back(p);
    }
    if (bright.size() < kMinPixels) continue;
    bright.erase(bright.begin(), bright.begin() + static_cast<std::ptrdiff_t>(bright.size() / 2));
    out.flicker = std::max(out.flicker, flicker_of(series.steps[s], bright));
  }
  double first = 0, last = 0;
  for (const std::vector<GroupSample>& group : out.groups) {
    if (!group.front().usable || !group.back().usable) continue;
    first += group.front().mean;
    last += group.back().mean;
  }
  out.follows = first > 0 ? last / first : 0;
  return out;
}

}  // namespace luxrig
