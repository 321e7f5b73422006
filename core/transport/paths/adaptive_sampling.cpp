#include "core/transport/paths/adaptive_sampling.h"

#include <algorithm>

#include "core/transport/error_floor.h"
#include "core/transport/paths/record_bias.h"

namespace luxrig {
namespace {

/// First number of samples per replicate: 128 paths show the approximate illuminance for later rounds.
constexpr std::uint32_t kFirstRoundSamples = 8;
/// A path seldom has more than 4 vertices, each with one ray to reach it, one to a lamp and one to a light vertex.
constexpr std::uint64_t kRaysPerPath = 12;
/// If no reflected light was found, an error of zero is believed only from this many samples on.
constexpr std::uint32_t kSamplesToBelieveNothing = 256;
constexpr std::uint32_t kMaxRoundSamples = 1u << 30;
/// Rounds multiply samples by 1 to 2 in this many steps, ending slightly beyond the need.
constexpr int kStepsToDouble = 8;
constexpr double kStepMargin = 1.05;
/// More paths that end in records do not reduce a receiver's error when there is no room for more records: once error²
/// × samples has grown by this factor, it continues without records.
constexpr double kMaxScatter = 3;
constexpr std::uint32_t kSamplesToTellScatter = 32;
/// With a wanted rms error, a receiver is left out of a round if it would get less than its samples divided by this.
constexpr double kMaxSamplesPerNew = 32;

}  // namespace

std::uint64_t AdaptiveSampling::rays_left(std::uint64_t rays_cast) const {
  return options_.max_rays > rays_cast ? options_.max_rays - rays_cast : 0;
}

std::vector<PathTask> AdaptiveSampling::first(std::uint64_t rays_cast) const {
  const std::uint64_t rays_per_sample = kRaysPerPath * progress_.size() * RecordBias::kReplicates;
  std::uint32_t samples = kFirstRoundSamples;
  while (samples > 1 && rays_per_sample * samples > rays_left(rays_cast)) samples /= 2;
  std::vector<PathTask> all;
  for (std::size_t r = 0; r < progress_.size(); ++r) all.push_back({r, 0, samples});
  return all;
}

std::vector<PathTask> AdaptiveSampling::wanting() const {
  std::vector<PathTask> wanting;
  if (by_rms()) {
    const std::vector<double> wanted = samples_by_rms();
    for (std::size_t r = 0; r < progress_.size(); ++r) {
      const std::uint32_t have = progress_[r].samples;
      const double more = overshoot(r) == HUGE_VAL ? have : std::min<double>(have, wanted[r] - have);
      if (!(more * kMaxSamplesPerNew > have) || have >= kMaxRoundSamples) continue;
      wanting.push_back({r, have, have + static_cast<std::uint32_t>(std::ceil(more))});
    }
    return wanting;
  }
  for (std::size_t r = 0; r < progress_.size(); ++r) {
    const std::uint32_t have = progress_[r].samples;
    const double over = overshoot(r);
    if (!(over > 1) || have >= kMaxRoundSamples) continue;
    const double parts = std::ceil(kStepsToDouble * (over * over * kStepMargin - 1));
    const double share = std::clamp(parts, 1.0, static_cast<double>(kStepsToDouble)) / kStepsToDouble;
    wanting.push_back({r, have, have + std::max(1u, static_cast<std::uint32_t>(have * share))});
  }
  return wanting;
}

std::vector<double> AdaptiveSampling::samples_by_rms() const {
  std::vector<double> wanted(progress_.size()), weights(progress_.size(), 0.0);
  for (std::size_t r = 0; r < progress_.size(); ++r) {
    wanted[r] = progress_[r].samples;
    const double rays = static_cast<double>(progress_[r].rays) / std::max(1u, progress_[r].samples);
    if (rays > 0) weights[r] = std::sqrt(progress_[r].scatter / rays);
  }
  if (rms_error() <= options_.wanted_rms_error) return wanted;
  // From the scatter of the last rounds, corrected by one common factor to the present error: shared error also falls
  // with the receivers' samples.
  double scattered = 0;
  for (const ReceiverProgress& one : progress_) scattered += one.scatter / std::max(1u, one.samples);
  const double aim = scattered / kStepMargin * std::pow(options_.wanted_rms_error / rms_error(), 2);
  double low = 1e-12, high = 1e15;
  while (high > 1.001 * low) {
    const double factor = std::sqrt(low * high);
    double squares = 0;
    for (std::size_t r = 0; r < progress_.size(); ++r)
      squares += progress_[r].scatter / std::max<double>(progress_[r].samples, factor * weights[r]);
    (squares <= aim ? high : low) = factor;
  }
  for (std::size_t r = 0; r < progress_.size(); ++r) wanted[r] = std::max(wanted[r], high * weights[r]);
  return wanted;
}

double AdaptiveSampling::rms_error() const {
  double squares = 0;
  for (std::size_t r = 0; r < progress_.size(); ++r) squares += relative_error(r) * relative_error(r);
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, progress_.size())));
}

std::vector<PathTask> AdaptiveSampling::next(std::uint64_t rays_cast) const {
  std::vector<PathTask> wanting = this->wanting();
  // As many as the remaining rays allow, worst first.
  std::stable_sort(wanting.begin(), wanting.end(),
                   [&](const PathTask& a, const PathTask& b) { return overshoot(a.receiver) > overshoot(b.receiver); });
  std::uint64_t left = rays_left(rays_cast);
  std::erase_if(wanting, [&](const PathTask& task) {
    const std::uint64_t rays = progress_[task.receiver].rays * (task.end - task.begin) / task.begin;
    if (rays > left) return true;
    left -= rays;
    return false;
  });
  std::sort(wanting.begin(), wanting.end(),
            [](const PathTask& a, const PathTask& b) { return a.receiver < b.receiver; });
  return wanting;
}

void AdaptiveSampling::judge_sharing(std::size_t receiver) {
  ReceiverProgress& one = progress_[receiver];
  if (one.samples < kSamplesToTellScatter) return;
  const double scatter = one.error_lx * one.error_lx * one.samples;
  one.min_scatter = std::min(one.min_scatter, scatter);
  one.alone = one.alone || scatter > kMaxScatter * one.min_scatter;
}

void AdaptiveSampling::find_floor() {
  std::vector<double> lux;
  for (const ReceiverProgress& one : progress_) lux.push_back(one.lux);
  floor_lx_ = error_floor_lx(options_, lux);
  brightest_lx_ = lux.empty() ? 0 : *std::max_element(lux.begin(), lux.end());
  if (!by_rms()) return;
  for (std::size_t r = 0; r < progress_.size(); ++r) {
    ReceiverProgress& one = progress_[r];
    if (one.samples == one.scatter_of) continue;
    // Estimates from 16 replicates are off by about a third: averaging the last ones reduces that.
    const double scatter = relative_error(r) * relative_error(r) * one.samples;
    one.scatter = one.scatter_of == 0 ? scatter : (one.scatter + 2 * scatter) / 3;
    one.scatter_of = one.samples;
  }
}

double AdaptiveSampling::relative_error(std::size_t receiver) const {
  const ReceiverProgress& one = progress_[receiver];
  const double scale_lx = std::max(one.lux, floor_lx_);
  const double own_lx = with_unfound_lx(one.error_lx, unfound_lx(receiver, brightest_lx_));
  return scale_lx > 0 ? std::hypot(own_lx, one.shared_error_lx) / scale_lx : 0;
}

double AdaptiveSampling::with_unfound_lx(double spread_lx, double unfound_lx) {
  return std::cbrt(spread_lx * spread_lx * spread_lx + unfound_lx * unfound_lx * unfound_lx);
}

double AdaptiveSampling::unfound_lx(std::size_t receiver, double brightest_lx) const {
  const ReceiverProgress& one = progress_[receiver];
  const double paths = RecordBias::kReplicates * static_cast<double>(one.samples) * (one.alone ? 1 : ways_each_);
  return paths > 0 ? sends_on_ * brightest_lx / paths : 0;
}

double AdaptiveSampling::overshoot(std::size_t receiver) const {
  const ReceiverProgress& one = progress_[receiver];
  if (one.error_lx == 0 && !one.found && one.samples < kSamplesToBelieveNothing) return HUGE_VAL;
  return relative_error(receiver) / options_.wanted_standard_error();
}

double AdaptiveSampling::done_after(const std::vector<PathTask>& round, double before) const {
  double spent = 0, left = 0;
  const double rms = by_rms() ? rms_error() / options_.wanted_standard_error() : 0;
  for (std::size_t r = 0; r < progress_.size(); ++r) {
    spent += progress_[r].samples;
    const double factor = std::min(by_rms() ? rms : overshoot(r), 1e3);
    if (factor > 1) left += progress_[r].samples * std::max(1.0, factor * factor - 1);
  }
  double part = 0;
  for (const PathTask& task : round) part += task.end - task.begin;
  if (spent == 0) return round.empty() ? before : 0.1;
  return std::clamp((spent + part) / (spent + std::max(left, part)), before, 1.0);
}

}  // namespace luxrig
