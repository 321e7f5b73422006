#include "tools/bench/loop/stepped_rig.h"

#include "core/output/dimming.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kSamplePeriod_s = 0.2;
/// Lamps have arrived after this; what the daemon's own fade would take.
constexpr double kRamp_s = 0.2, kDark_s = 1;
/// Longer than the slowest meter's delay and the lamps' ramps.
constexpr double kSettle_s = 4;

}  // namespace

std::vector<std::vector<std::optional<SteadyReading>>> SteppedRig::read(std::span<const std::vector<double>> plan,
                                                                        std::span<const double> together) {
  if (timing_.empty()) timing_ = learn_timing(together);
  const double dwell = dwell_s(timing_);
  for (auto& samples : samples_) samples.clear();
  ReadingLog log(timing_);
  for (const std::vector<double>& level : plan) {
    send(level);
    watch(kRamp_s);
    const double arrived_s = seconds();
    watch(dwell);
    log.light(arrived_s, seconds());
  }
  watch(log.whole_at_s() - seconds());
  for (std::size_t m = 0; m < samples_.size(); ++m)
    for (const TimedLux& sample : samples_[m]) log.sample(m, sample);
  return log.readings();
}

void SteppedRig::measure(MeterRun& run, std::span<const double> together) {
  for (std::size_t taken = 0; taken < run.plan().size();) {
    std::vector<std::vector<double>> lights;
    for (const auto& lit : std::span(run.plan()).subspan(taken)) lights.push_back(levels_of(lit, rig_));
    const auto readings = read(lights, together);
    for (std::size_t k = 0; k < readings.size(); ++k) run.take(lights[k], readings[k]);
    taken += readings.size();
  }
}

VectorXd SteppedRig::truth_lx(std::span<const double> level) {
  set(level);
  const auto points = world_.points();
  VectorXd lux(static_cast<Index>(rig_.points.size()));
  for (Index p = 0; p < lux.size(); ++p) lux[p] = points[static_cast<std::size_t>(p)].lux;
  return lux;
}

std::vector<double> SteppedRig::outputs(std::span<const double> level) {
  set(level);
  return world_.levels();
}

void SteppedRig::pass(double seconds) {
  now_ += from_seconds(seconds);
  world_.advance(now_);
}

void SteppedRig::send(std::span<const double> level) {
  for (std::size_t f = 0; f < level.size(); ++f) world_.set_drive(f, drive_for(rig_.fixtures[f], level[f]));
}

void SteppedRig::set(std::span<const double> level) {
  send(level);
  pass(kSettle_s);
}

void SteppedRig::watch(double duration_s) {
  for (const double end_s = seconds() + duration_s; seconds() < end_s;) {
    pass(kSamplePeriod_s);
    for (std::size_t m = 0; m < samples_.size(); ++m) samples_[m].push_back({seconds(), world_.meter_reading_lx(m)});
  }
}

std::vector<std::optional<MeterTiming>> SteppedRig::learn_timing(std::span<const double> together) {
  set(std::vector<double>(together.size(), 0.0));
  watch(kDark_s);
  const double begun_s = seconds();
  send(together);
  watch(kRamp_s);
  const double arrived_s = seconds();
  watch(kSettle_s);
  std::vector<std::optional<MeterTiming>> timing;
  for (const auto& samples : samples_) timing.push_back(timing_of(samples, begun_s, arrived_s));
  return timing;
}

}  // namespace luxrig
