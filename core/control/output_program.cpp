#include "core/control/output_program.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace luxrig {
namespace {

/// 0…1; what is not a number counts as 0 (dark).
double clamped_share(double x) { return x > 0 ? std::min(x, 1.0) : 0.0; }

double smooth_step(double x) { return std::min(x * x * (3 - 2 * x), 1.0); }

const std::vector<std::uint8_t> kNobody;

double at_or_zero(const std::vector<double>& values, std::size_t i) { return i < values.size() ? values[i] : 0.0; }

}  // namespace

double fade_share(FadeCurve curve, double x) {
  x = clamped_share(x);
  return curve == FadeCurve::s_curve ? smooth_step(x) : x;
}

double level_from_drive(DimmerCurve curve, double drive) {
  drive = clamped_share(drive);
  switch (curve) {
    case DimmerCurve::square:
      return drive * drive;
    case DimmerCurve::s_curve:
      return smooth_step(drive);
    case DimmerCurve::linear:
      break;
  }
  return drive;
}

double drive_from_level(DimmerCurve curve, double level) {
  level = clamped_share(level);
  switch (curve) {
    case DimmerCurve::square:
      return std::sqrt(level);
    case DimmerCurve::s_curve: {
      // y = 3x² − 2x³ has the root x = 1/2 − sin(asin(1 − 2y) / 3). With y = sin²(a/2) that becomes
      // sin²(a/6) + √3/2 sin(a/3), which loses no digits for small y as the textbook form does.
      if (level >= 1) return 1;  // the sum below rounds to 1 − 1e-16 there
      const double third = 2.0 / 3.0 * std::asin(std::sqrt(level));
      const double half_sine = std::sin(third / 2);
      return std::min(half_sine * half_sine + std::sqrt(0.75) * std::sin(third), 1.0);
    }
    case DimmerCurve::linear:
      break;
  }
  return level;
}

void scale_to_limits(const Eigen::MatrixXd& worst_lux_per_level, const Eigen::VectorXd& max_lx, std::span<double> level,
                     double relief) {
  const auto lights = std::min<Eigen::Index>(worst_lux_per_level.cols(), static_cast<Eigen::Index>(level.size()));
  const Eigen::Index rows = std::min(worst_lux_per_level.rows(), max_lx.size());
  // Room for rounding, so that the limit holds in whatever order somebody adds the contributions up.
  const double rounding = 2.0 * static_cast<double>(lights + 2) * std::numeric_limits<double>::epsilon();
  // Rows one after the other: scaling only takes light away, so a row once met stays met.
  for (Eigen::Index row = 0; row < rows; ++row) {
    double lux = 0;
    bool unknown = false;
    for (Eigen::Index j = 0; j < lights; ++j) {
      const double worst = worst_lux_per_level(row, j);
      if (level[static_cast<std::size_t>(j)] > 0) {
        if (!std::isfinite(worst)) unknown = true;
        lux += worst > 0 ? worst * level[static_cast<std::size_t>(j)] : 0.0;
      }
    }
    if (!unknown && lux <= max_lx[row] * (1 - rounding)) continue;
    if (!unknown && lux <= 0 && max_lx[row] >= 0) continue;
    // Below the smallest normal number, products lose their relative accuracy: dark is as good.
    double most = max_lx[row] > 1e-290 && !unknown ? max_lx[row] * (1 - 2 * rounding) : 0.0;
    if (relief > 0 && std::isfinite(lux)) most += relief * (lux - most);
    const double share = std::isfinite(lux) && lux > 0 ? std::clamp(most / lux, 0.0, 1.0) : 0.0;
    for (Eigen::Index j = 0; j < lights; ++j) {
      const double worst = worst_lux_per_level(row, j);
      if (worst > 0 || !std::isfinite(worst)) level[static_cast<std::size_t>(j)] *= share;
    }
  }
}

void OutputProgram::own_levels_at(Time now, std::span<double> level) const {
  const double share =
      done(now) ? 1.0
      : now <= start
          ? 0.0
          : fade_share(curve, static_cast<double>((now - start).count()) / static_cast<double>(duration.count()));
  for (std::size_t i = 0; i < level.size(); ++i) {
    const double from = at_or_zero(from_level, i), to = at_or_zero(to_level, i);
    // Each end is met exactly: from + (to − from) · 1 need not be `to` in floating point.
    const double wanted = share >= 1 ? to : share <= 0 ? from : from + (to - from) * share;
    const double most = at_or_zero(max_level, i);
    level[i] = wanted > 0 && most > 0 ? std::min(wanted, std::min(most, 1.0)) : 0.0;
  }
  scale_to_limits(worst_lux_per_level, max_lx, level);
}

bool OutputProgram::desk_has_a_say(Time now) const {
  return std::any_of(desks.begin(), desks.end(), [now](const DeskBlend& desk) { return !desk.is_own(now); });
}

double HeadDim::share(Time now) const {
  if (now >= start + duration) return to;
  if (now <= start) return from;
  return from + (to - from) * (to_seconds(now - start) / to_seconds(duration));
}

void OutputProgram::levels_at(Time now, std::span<double> level) const {
  if (blackout) {
    std::fill(level.begin(), level.end(), 0.0);
    return;
  }
  wanted_levels_at(now, level);
  for (const HeadDim& dim : dims) {
    if (dim.fixture < level.size()) level[dim.fixture] *= dim.share(now);
  }
}

void OutputProgram::wanted_levels_at(Time now, std::span<double> level) const {
  shared_levels_at(now, level);
  const std::size_t staged = std::min(level.size(), lamp_starts.size());
  for (std::size_t i = 0; i < staged; ++i)
    level[i] = std::min(level[i], lamp_starts[i].ceiling(now) * std::min(at_or_zero(max_level, i), 1.0));
}

void OutputProgram::shared_levels_at(Time now, std::span<double> level) const {
  own_levels_at(now, level);
  if (desks.empty()) return;
  if (!desk_has_a_say(now)) {
    // What goes out now is Luxrig's own and within limits by what meters taught, which may be brighter than the limits
    // for any levels let through until now.
    Time last{};
    for (const DeskBlend& desk : desks) last = std::max(last, desk.start + desk.duration);
    if (now >= last + limits_released) return;
    const double relief = fade_share(curve, to_seconds(now - last) / to_seconds(limits_released));
    return scale_to_limits(any_lux_per_level, any_max_lx, level, relief);
  }
  for (const DeskBlend& desk : desks) {
    if (!desk.is_own(now)) desk.apply(now, now < heads_arrive ? heads_guarded : kNobody, level);
  }
  for (std::size_t i = 0; i < level.size(); ++i) {
    const double most = at_or_zero(max_level, i);
    level[i] = level[i] > 0 && most > 0 ? std::min(level[i], std::min(most, 1.0)) : 0.0;
  }
  scale_to_limits(any_lux_per_level, any_max_lx, level);
}

void OutputProgram::joints_at(Time now, std::span<Joints> out) const {
  wanted_joints_at(now, out);
  for (const HeadDim& dim : dims) {
    if (dim.held && dim.fixture < out.size()) out[dim.fixture] = dim.held_at;
  }
}

void OutputProgram::wanted_joints_at(Time now, std::span<Joints> out) const {
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = i < joints.size() ? joints[i] : Joints{};
  for (const DeskBlend& desk : desks) {
    if (!desk.is_own(now)) desk.turn(now, out);
  }
  const std::size_t known = std::min({out.size(), parked.size(), joints.size()});
  for (std::size_t i = 0; i < known; ++i) {
    if (parked[i] != 0) out[i] = joints[i];
  }
}

}  // namespace luxrig
