#include "core/calibration/meter_timing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/check.h"

namespace luxrig {
namespace {

constexpr double kSmallestError_lx = 0.02;
/// Samples that go up or down by more than this, as a share and in standard errors of that drift, are not steady.
constexpr double kWanders = 0.02, kWandersErrors = 3;
/// A change is clear if it is so many times the scatter; the light has arrived within this share of it.
constexpr double kClear = 10, kBegun = 0.03, kArrivedWithin = 0.01;
/// A meter has settled when this share of the change is left.
constexpr double kUnsettled = 0.005;
/// A lag of first order describes the meter if what it leaves is at most so many times its noise.
constexpr double kFits = 1.5;
constexpr std::size_t kFewest = 4;  ///< samples at the end, and in the dark
/// Without a sample for so many periods, and for so long, the meter or its line was held up. Then it is not known how late
/// its next samples are.
constexpr double kGapPeriods = 4, kGap_s = 1;

struct SampleScatter {
  double mean = 0, deviation = 0;
};

SampleScatter scatter_of_samples(std::span<const TimedLux> samples) {
  SampleScatter scatter;
  const auto count = static_cast<double>(samples.size());
  for (const TimedLux& sample : samples) scatter.mean += sample.lux / count;
  for (const TimedLux& sample : samples)
    scatter.deviation += (sample.lux - scatter.mean) * (sample.lux - scatter.mean) / (count - 1);
  scatter.deviation = std::hypot(std::sqrt(scatter.deviation), kSmallestError_lx);
  return scatter;
}

/// Mean, variance of a sample, and by how much they go up or down from the first to the last.
struct Samples {
  double mean = 0, variance = 0, drift = 0;
  double about_drift = 0;  ///< sum of squares about the line through them
  double drift_error = 0;  ///< of that drift, in deviations of a sample
};

Samples of(std::span<const double> lux) {
  Samples samples;
  const auto count = static_cast<double>(lux.size());
  double slope = 0, times = 0;
  for (const double sample : lux) samples.mean += sample / count;
  for (std::size_t k = 0; k < lux.size(); ++k) {
    const double time = static_cast<double>(k) - (count - 1) / 2;
    samples.variance += (lux[k] - samples.mean) * (lux[k] - samples.mean) / (count - 1);
    slope += time * lux[k];
    times += time * time;
  }
  samples.drift = slope / times * (count - 1);
  samples.drift_error = (count - 1) / std::sqrt(times);
  samples.about_drift = std::max(0.0, (count - 1) * samples.variance - slope * slope / times);
  return samples;
}

/// Below, a meter's last digit is more than its noise.
constexpr double kBrightForNoise_lx = 2;
/// The noise of all readings together counts like so many samples of each.
constexpr double kFreedomOfNoise = 10;

/// Square of a meter's noise as a share of its light: the median over its lights, so that those that wander do not count.
double relative_noise_squared(std::span<const std::vector<double>> lights) {
  std::vector<double> shares;
  for (const auto& lux : lights) {
    if (lux.size() < kSteadySamples) continue;
    const Samples samples = of(lux);
    if (!(samples.mean > kBrightForNoise_lx)) continue;
    // Median of χ² over its mean (Wilson and Hilferty 1931).
    const double freedom = static_cast<double>(lux.size() - 1);
    shares.push_back(samples.variance / (samples.mean * samples.mean) / std::pow(1 - 2 / (9 * freedom), 3));
  }
  if (shares.empty()) return 0;
  const auto middle = shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 2);
  std::nth_element(shares.begin(), middle, shares.end());
  return *middle;
}

/// A meter with a lag of first order, after a step: it begins at `from_s`, and this much later 1/e of the step is left.
struct FirstOrderLag {
  double from_s = 0, constant_s = 0, rms_lx = 0;
};

/// By least squares, over ever finer grids about the best of the last.
FirstOrderLag lag_of(std::span<const TimedLux> samples, double dark_lx, double lit_lx, double begun_s) {
  constexpr int kSteps = 20, kGrids = 6;
  constexpr double kLongest_s = 1.5, kFiner = 2.5;
  const auto rms_lx = [&](double from_s, double constant_s) {
    double sum = 0;
    for (const TimedLux& sample : samples) {
      const double left = sample.at_s > from_s ? std::exp(-(sample.at_s - from_s) / constant_s) : 1;
      const double off = sample.lux - lit_lx - (dark_lx - lit_lx) * left;
      sum += off * off;
    }
    return std::sqrt(sum / static_cast<double>(samples.size()));
  };
  double from_width_s = samples.back().at_s - begun_s, constant_width_s = kLongest_s;
  FirstOrderLag best{begun_s + from_width_s / 2, constant_width_s / 2, std::numeric_limits<double>::infinity()};
  for (int grid = 0; grid < kGrids; ++grid) {
    const FirstOrderLag middle = best;
    for (int i = 0; i <= kSteps; ++i)
      for (int j = 0; j <= kSteps; ++j) {
        const double from_s = std::max(begun_s, middle.from_s + from_width_s * (static_cast<double>(i) / kSteps - 0.5));
        const double constant_s =
            std::max(1e-3, middle.constant_s + constant_width_s * (static_cast<double>(j) / kSteps - 0.5));
        if (const double rms = rms_lx(from_s, constant_s); rms < best.rms_lx) best = {from_s, constant_s, rms};
      }
    from_width_s /= kFiner;
    constant_width_s /= kFiner;
  }
  return best;
}

}  // namespace

std::optional<MeterTiming> timing_of(std::span<const TimedLux> samples, double begun_s, double arrived_s) {
  const auto first_after =
      std::find_if(samples.begin(), samples.end(), [&](const TimedLux& sample) { return sample.at_s > begun_s; });
  const auto dark_count = static_cast<std::size_t>(first_after - samples.begin());
  if (dark_count < kFewest || samples.size() < dark_count + 2 * kFewest) return std::nullopt;
  const SampleScatter dark = scatter_of_samples(samples.first(dark_count));
  const SampleScatter lit = scatter_of_samples(samples.last(std::max(kFewest, (samples.size() - dark_count) / 3)));
  const double change = std::abs(lit.mean - dark.mean);
  if (!(change > kClear * std::hypot(dark.deviation, lit.deviation))) return std::nullopt;

  const double begins_at = std::max(kBegun * change, 4 * dark.deviation);
  const double within = std::max(kArrivedWithin * change, 4 * lit.deviation);
  std::size_t begins = dark_count;
  while (begins < samples.size() && std::abs(samples[begins].lux - dark.mean) < begins_at) ++begins;
  const auto outside = [&](std::size_t k) { return std::abs(samples[k].lux - lit.mean) > within; };
  // One stray sample is noise, two in a row are not.
  std::size_t arrives = begins < samples.size() && outside(begins) ? begins + 1 : begins;
  for (std::size_t k = begins; k + 1 < samples.size(); ++k)
    if (outside(k) && outside(k + 1)) arrives = k + 2;
  if (arrives + kFewest > samples.size()) return std::nullopt;
  MeterTiming timing;
  timing.period_s =
      (samples.back().at_s - samples[dark_count].at_s) / static_cast<double>(samples.size() - 1 - dark_count);
  // It began somewhere between two samples.
  timing.delay_s = std::max(0.0, samples[begins - 1].at_s - begun_s);
  // All samples together tell a lag of first order far better than the one that noise lets be the last on the way.
  const FirstOrderLag lag = lag_of(samples.subspan(dark_count), dark.mean, lit.mean, begun_s);
  if (lag.rms_lx < kFits * std::max(lit.deviation, kArrivedWithin * change)) {
    // How fast a meter is that needs less than a period is not known.
    const double settled_s = lag.from_s - lag.constant_s * std::log(kUnsettled) + timing.period_s / 2 - arrived_s;
    timing.settled_s = std::max({0.0, timing.delay_s, settled_s});
    return timing;
  }
  // Another way of settling: what noise hides of it is taken to go on as a lag of first order does.
  const double seen_s = samples[arrives].at_s - arrived_s - timing.delay_s;
  const double longer = std::max(1.0, std::log(kUnsettled) / std::log(std::min(0.5, within / change)));
  timing.settled_s = std::max(0.0, timing.delay_s + longer * std::max(0.0, seen_s));
  return timing;
}

double dwell_s(std::span<const std::optional<MeterTiming>> timing) {
  double longest = 0;
  for (const auto& of : timing)
    if (of)
      longest = std::max(longest, of->settled_s - of->delay_s + static_cast<double>(kSteadySamples + 1) * of->period_s);
  return longest;
}

ReadingLog::ReadingLog(std::vector<std::optional<MeterTiming>> timing)
    : timing_(std::move(timing)), samples_(timing_.size()) {}

void ReadingLog::light(double arrived_s, double left_s) {
  LUXRIG_CHECK(left_s >= arrived_s && (lights_.empty() || arrived_s >= lights_.back().left_s),
               "a light from {} to {} s", arrived_s, left_s);
  lights_.push_back({arrived_s, left_s});
}

double ReadingLog::whole_at_s() const {
  double latest = 0;
  for (const auto& timing : timing_)
    if (timing) latest = std::max(latest, timing->delay_s + timing->period_s);
  return lights_.empty() ? 0 : lights_.back().left_s + latest;
}

bool ReadingLog::held_up(std::size_t luxmeter, const Span& light) const {
  const MeterTiming& timing = *timing_[luxmeter];
  const double longest_s = std::max(kGapPeriods * timing.period_s, kGap_s);
  double last_s = light.arrived_s;
  for (const TimedLux& sample : samples_[luxmeter]) {
    if (sample.at_s <= light.arrived_s) continue;
    if (std::min(sample.at_s, light.left_s + timing.delay_s) - last_s > longest_s) return true;
    if (sample.at_s > light.left_s + timing.delay_s) return false;
    last_s = sample.at_s;
  }
  return light.left_s + timing.delay_s - last_s > longest_s;
}

std::vector<double> ReadingLog::samples_of(std::size_t luxmeter, const Span& light) const {
  std::vector<double> lux;
  const MeterTiming& timing = *timing_[luxmeter];
  for (const TimedLux& sample : samples_[luxmeter])
    if (sample.at_s >= light.arrived_s + timing.settled_s && sample.at_s <= light.left_s + timing.delay_s)
      lux.push_back(sample.lux);
  return lux;
}

std::vector<std::vector<std::optional<SteadyReading>>> ReadingLog::readings() const {
  std::vector<std::vector<std::optional<SteadyReading>>> readings(lights_.size());
  for (auto& of_light : readings) of_light.resize(timing_.size());
  for (std::size_t m = 0; m < timing_.size(); ++m) {
    if (!timing_[m]) continue;
    std::vector<std::vector<double>> lux;
    for (const Span& light : lights_) lux.push_back(samples_of(m, light));
    const double noise_squared = relative_noise_squared(lux);
    const double freedom = noise_squared > 0 ? kFreedomOfNoise : 0;
    for (std::size_t k = 0; k < lights_.size(); ++k) {
      if (lux[k].size() < kSteadySamples || held_up(m, lights_[k])) continue;
      const Samples samples = of(lux[k]);
      const auto count = static_cast<double>(lux[k].size());
      const double variance = ((count - 1) * samples.variance + freedom * noise_squared * samples.mean * samples.mean) /
                              (count - 1 + freedom);
      const double error_lx = std::hypot(std::sqrt(variance / count), kSmallestError_lx);
      const double drift_lx = std::abs(samples.drift);
      const double noise_lx = std::sqrt((samples.about_drift + freedom * noise_squared * samples.mean * samples.mean) /
                                        (count - 2 + freedom));
      const double of_noise_lx = samples.drift_error * std::hypot(noise_lx, kSmallestError_lx);
      if (drift_lx > kWanders * std::abs(samples.mean) && drift_lx > kWandersErrors * of_noise_lx) continue;
      readings[k][m] = SteadyReading{samples.mean, error_lx};
    }
  }
  return readings;
}

}  // namespace luxrig
