#include "tools/luxrigd/guardian/smooth_return.h"

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

constexpr double kMinRate_per_s = 0.25;
/// Factor on the fastest rate of the running fade; an s-curve is fastest in its middle.
constexpr double kFasterThanTheFade = 1.25, kPeakOfSCurve = 1.5;
constexpr Duration kShortestStall = std::chrono::milliseconds(100);

double fade_rate_per_s(const OutputProgram& program, Time now) {
  if (program.duration <= Duration{} || program.done(now)) return 0;
  double most = 0;
  const std::size_t count = std::min(program.from_level.size(), program.to_level.size());
  for (std::size_t f = 0; f < count; ++f) most = std::max(most, std::abs(program.to_level[f] - program.from_level[f]));
  return kFasterThanTheFade * kPeakOfSCurve * most / to_seconds(program.duration);
}

}  // namespace

SmoothReturn::SmoothReturn(std::size_t fixtures, Duration cycle)
    : cycle_(cycle), stall_(std::max(4 * cycle, kShortestStall)), last_(fixtures), wanted_(fixtures) {}

void SmoothReturn::apply(Time now, const OutputProgram& program, bool dark, std::span<double> level) {
  if (sent_ && now - last_at_ > stall_ && last_at_ != Time{}) returning_ = true;
  last_at_ = now;
  if (dark || !sent_) returning_ = false;
  sent_ = true;
  if (returning_) {
    std::copy(level.begin(), level.end(), wanted_.begin());
    const auto on_or_off = [&](std::size_t f) { return f < program.switched.size() && program.switched[f] != 0; };
    double way = 0;
    for (std::size_t f = 0; f < level.size(); ++f)
      if (!on_or_off(f)) way = std::max(way, std::abs(wanted_[f] - last_[f]));
    const double step = std::max(kMinRate_per_s, fade_rate_per_s(program, now)) * to_seconds(cycle_);
    returning_ = way > step;
    if (returning_) {
      for (std::size_t f = 0; f < level.size(); ++f)
        if (!on_or_off(f)) level[f] = last_[f] + (wanted_[f] - last_[f]) * (step / way);
      for (const HeadDim& dim : program.dims)
        if (dim.fixture < level.size()) level[dim.fixture] = std::min(level[dim.fixture], wanted_[dim.fixture]);
      scale_to_limits(program.worst_lux_per_level, program.max_lx, level, 0, program.switched, program.worth);
    }
  }
  std::copy(level.begin(), level.end(), last_.begin());
}

}  // namespace luxrig
