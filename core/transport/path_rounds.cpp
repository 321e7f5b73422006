#include "core/transport/path_rounds.h"

#include <algorithm>

#include "core/transport/record_bias.h"

namespace luxrig {
namespace {

/// First number of samples per replicate: 128 paths say roughly how bright it is, which later rounds build on.
constexpr std::uint32_t kFirstRoundSamples = 8;
/// A path has seldom more than 4 vertices, each with a ray to reach it, one to a lamp and one to a light hit.
constexpr std::uint64_t kRaysPerPath = 12;
/// Where nothing reflected was found at all, an error of zero proves nothing yet; it is believed from here on.
constexpr std::uint32_t kSamplesToBelieveNothing = 256;
constexpr std::uint32_t kMostRoundSamples = 1u << 30;
/// Rounds end at so many steps between as many samples as before and twice as many, a little beyond what is needed.
constexpr int kStepsToDouble = 8;
constexpr double kStepMargin = 1.05;

}  // namespace

std::uint64_t PathRounds::rays_left(std::uint64_t rays_cast) const {
  return options_.max_rays > rays_cast ? options_.max_rays - rays_cast : 0;
}

std::vector<PathTask> PathRounds::first(std::uint64_t rays_cast) const {
  const std::uint64_t rays_per_sample = kRaysPerPath * progress_.size() * RecordBias::kReplicates;
  std::uint32_t samples = kFirstRoundSamples;
  while (samples > 1 && rays_per_sample * samples > rays_left(rays_cast)) samples /= 2;
  std::vector<PathTask> all;
  for (std::size_t r = 0; r < progress_.size(); ++r) all.push_back({r, 0, samples});
  return all;
}

std::vector<PathTask> PathRounds::next(std::uint64_t rays_cast) const {
  std::vector<PathTask> wanting;
  for (std::size_t r = 0; r < progress_.size(); ++r) {
    const std::uint32_t have = progress_[r].samples;
    const double over = overshoot(r);
    if (!(over > 1) || have >= kMostRoundSamples) continue;
    const double parts = std::ceil(kStepsToDouble * (over * over * kStepMargin - 1));
    const double share = std::clamp(parts, 1.0, static_cast<double>(kStepsToDouble)) / kStepsToDouble;
    wanting.push_back({r, have, have + std::max(1u, static_cast<std::uint32_t>(have * share))});
  }
  // As many as the remaining rays allow, the worst first.
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

void PathRounds::find_brightest() {
  brightest_lx_ = 0;
  for (const ReceiverProgress& one : progress_) brightest_lx_ = std::max(brightest_lx_, one.lux);
}

double PathRounds::relative_error(std::size_t receiver) const {
  const double scale_lx = std::max(progress_[receiver].lux, 0.001 * brightest_lx_);
  return scale_lx > 0 ? progress_[receiver].error_lx / scale_lx : 0;
}

double PathRounds::overshoot(std::size_t receiver) const {
  const ReceiverProgress& one = progress_[receiver];
  if (one.error_lx == 0) return one.found || one.samples >= kSamplesToBelieveNothing ? 0 : HUGE_VAL;
  return relative_error(receiver) * kStopMargin / options_.wanted_relative_error;
}

double PathRounds::done_after(const std::vector<PathTask>& round, double before) const {
  double spent = 0, left = 0;
  for (std::size_t r = 0; r < progress_.size(); ++r) {
    spent += progress_[r].samples;
    const double factor = std::min(overshoot(r), 1e3);
    if (factor > 1) left += progress_[r].samples * std::max(1.0, factor * factor - 1);
  }
  double part = 0;
  for (const PathTask& task : round) part += task.end - task.begin;
  if (spent == 0) return round.empty() ? before : 0.1;
  return std::clamp((spent + part) / (spent + std::max(left, part)), before, 1.0);
}

}  // namespace luxrig
