#include "core/output/output_program.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace luxrig {
namespace {

/// 0…1; NaN counts as 0 (dark).
double clamped_share(double x) { return x > 0 ? std::min(x, 1.0) : 0.0; }

double smooth_step(double x) { return std::min(x * x * (3 - 2 * x), 1.0); }

const std::vector<std::uint8_t> kNobody;

bool is_on_or_off(std::span<const std::uint8_t> switched, Eigen::Index i) {
  return static_cast<std::size_t>(i) < switched.size() && switched[static_cast<std::size_t>(i)] != 0;
}

double at_or_zero(const std::vector<double>& values, std::size_t i) { return i < values.size() ? values[i] : 0.0; }

/// Light at a point from fixtures that dim, and from those that are on or off.
struct OfRow {
  double dimmed = 0, switched = 0;
};

/// On-or-off lamps cannot be scaled: while they alone exceed `most`, the brightest of them goes off.
OfRow switch_off_above(double most, Eigen::Index row, const Eigen::MatrixXd& worst_lux_per_level,
                       std::span<const std::uint8_t> switched, std::span<double> level) {
  const auto lights = std::min<Eigen::Index>(worst_lux_per_level.cols(), static_cast<Eigen::Index>(level.size()));
  for (;;) {
    OfRow sum;
    std::size_t brightest = level.size();
    double brightest_lx = 0;
    for (Eigen::Index j = 0; j < lights; ++j) {
      const auto f = static_cast<std::size_t>(j);
      const double worst = worst_lux_per_level(row, j);
      if (!(level[f] > 0) || worst <= 0) continue;
      const double lux = std::isfinite(worst) ? worst * level[f] : HUGE_VAL;
      (is_on_or_off(switched, j) ? sum.switched : sum.dimmed) += lux;
      if (!is_on_or_off(switched, j) || lux <= brightest_lx) continue;
      brightest = f;
      brightest_lx = lux;
    }
    if (brightest == level.size() || sum.switched <= most) return sum;
    level[brightest] = 0;
  }
}

/// Calls `call` for each lamp that dims at a row, with its light there and its worth. Emitters of one housing are one
/// lamp.
template <class Call>
void each_dimmed(const Eigen::MatrixXd& worst_lux_per_level, Eigen::Index row, std::span<const double> level,
                 std::span<const std::uint8_t> switched, const LampWorth& worth, Call call) {
  const auto lights = static_cast<std::size_t>(
      std::min<Eigen::Index>(worst_lux_per_level.cols(), static_cast<Eigen::Index>(level.size())));
  const auto housing = [&](std::size_t j) { return j < worth.housing.size() ? worth.housing[j] : j; };
  for (std::size_t first = 0, end = 0; first < lights; first = end) {
    double lux = 0, value = 1;
    for (end = first; end < lights && (end == first || housing(end) == housing(first)); ++end) {
      const auto j = static_cast<Eigen::Index>(end);
      if (is_on_or_off(switched, j)) continue;
      if (const double worst = worst_lux_per_level(row, j); worst > 0) lux += worst * level[end];
      if (end < worth.per_level_squared.size()) value += worth.per_level_squared[end] * level[end] * level[end];
    }
    if (lux > 0) call(first, end, lux, value);
  }
}

/// Dims lamps until they give `room_lx` at the row; now they give `dimmed_lx` > 0. A lamp with share p of that light
/// and worth v dims by min(1, λ p / v). λ by Newton's method, which converges from below, since the remaining light is
/// convex in λ.
void dim_by_worth(double room_lx, double dimmed_lx, const Eigen::MatrixXd& worst_lux_per_level, Eigen::Index row,
                  std::span<const std::uint8_t> switched, const LampWorth& worth, std::span<double> level) {
  constexpr int kPasses = 100;
  double strength = 0;
  for (int pass = 0; pass < kPasses; ++pass) {
    double left_lx = 0, slope_lx = 0;
    each_dimmed(worst_lux_per_level, row, level, switched, worth,
                [&](std::size_t, std::size_t, double lux, double value) {
                  const double cut = lux / dimmed_lx / value;
                  if (strength * cut >= 1) return;
                  left_lx += lux;
                  slope_lx += lux * cut;
                });
    const double next = slope_lx > 0 ? (left_lx - room_lx) / slope_lx : strength;
    if (!(next > strength * (1 + 1e-12))) break;
    strength = next;
  }
  double kept_lx = 0;
  each_dimmed(worst_lux_per_level, row, level, switched, worth,
              [&](std::size_t first, std::size_t end, double lux, double value) {
                const double kept = std::clamp(1 - strength * (lux / dimmed_lx / value), 0.0, 1.0);
                kept_lx += kept * lux;
                for (std::size_t j = first; j < end; ++j)
                  if (!is_on_or_off(switched, static_cast<Eigen::Index>(j))) level[j] *= kept;
              });
  if (kept_lx <= room_lx) return;
  const double rest = room_lx / kept_lx;
  for (std::size_t j = 0; j < level.size(); ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    if (column < worst_lux_per_level.cols() && worst_lux_per_level(row, column) > 0 && !is_on_or_off(switched, column))
      level[j] *= rest;
  }
}

/// scale_to_limits() with a limit for each row by max_lx_of(row).
template <class Limit>
void scale_rows(const Eigen::MatrixXd& worst_lux_per_level, Eigen::Index rows, const Limit& max_lx_of,
                std::span<double> level, double relief, std::span<const std::uint8_t> switched,
                const LampWorth& worth) {
  const auto lights = std::min<Eigen::Index>(worst_lux_per_level.cols(), static_cast<Eigen::Index>(level.size()));
  // Allows for rounding, so that the limit holds in whatever order the contributions are added up.
  const double rounding = 2.0 * static_cast<double>(lights + 2) * std::numeric_limits<double>::epsilon();
  // One row after the other: scaling only takes light away, so a row that is met stays met.
  for (Eigen::Index row = 0; row < rows; ++row) {
    const double max_lx = max_lx_of(row);
    double lux = 0;
    bool unknown = false;
    for (Eigen::Index j = 0; j < lights; ++j) {
      const double worst = worst_lux_per_level(row, j);
      if (level[static_cast<std::size_t>(j)] > 0) {
        if (!std::isfinite(worst)) unknown = true;
        lux += worst > 0 ? worst * level[static_cast<std::size_t>(j)] : 0.0;
      }
    }
    if (!unknown && lux <= max_lx * (1 - rounding)) continue;
    if (!unknown && lux <= 0 && max_lx >= 0) continue;
    // Below the smallest normal number, products lose their relative accuracy, so dark is good enough.
    double most = max_lx > 1e-290 && !unknown ? max_lx * (1 - 2 * rounding) : 0.0;
    if (relief > 0 && std::isfinite(lux)) most += relief * (lux - most);
    const OfRow set = switch_off_above(most, row, worst_lux_per_level, switched, level);
    const double room_lx = most - set.switched;
    if (std::isfinite(lux) && set.dimmed > 0 && room_lx > 0) {
      if (set.dimmed > room_lx) dim_by_worth(room_lx, set.dimmed, worst_lux_per_level, row, switched, worth, level);
      continue;
    }
    for (Eigen::Index j = 0; j < lights; ++j) {
      const double worst = worst_lux_per_level(row, j);
      if ((worst > 0 || !std::isfinite(worst)) && !is_on_or_off(switched, j)) level[static_cast<std::size_t>(j)] = 0;
    }
  }
}

}  // namespace

double fade_share(FadeCurve curve, double x) {
  x = clamped_share(x);
  return curve == FadeCurve::s_curve ? smooth_step(x) : x;
}

std::vector<std::uint8_t> switched_fixtures(const Rig& rig) {
  std::vector<std::uint8_t> switched;
  for (const Fixture& fixture : rig.fixtures) switched.push_back(fixture.switched ? 1 : 0);
  return switched;
}

double level_on_the_way(double from, double to, double share, bool switched) {
  // from + (to − from) · 1 may differ from `to` in floating point.
  if (share >= 1) return to;
  if (share <= 0) return from;
  return switched ? std::min(from, to) : from + (to - from) * share;
}

void scale_to_limits(const Eigen::MatrixXd& worst_lux_per_level, const Eigen::VectorXd& max_lx, std::span<double> level,
                     double relief, std::span<const std::uint8_t> switched, const LampWorth& worth) {
  scale_rows(
      worst_lux_per_level, std::min(worst_lux_per_level.rows(), max_lx.size()),
      [&](Eigen::Index row) { return max_lx[row]; }, level, relief, switched, worth);
}

/// An on-or-off lamp that is given less than full level is off.
void OutputProgram::switch_off_partial(std::span<double> level) const {
  const std::size_t known = std::min(level.size(), switched.size());
  for (std::size_t i = 0; i < known; ++i)
    if (switched[i] != 0 && level[i] < 1) level[i] = 0;
}

double OutputProgram::faded_level(std::size_t fixture, double share) const {
  const bool on_or_off = is_on_or_off(switched, static_cast<Eigen::Index>(fixture));
  const double wanted =
      level_on_the_way(at_or_zero(from_level, fixture), at_or_zero(to_level, fixture), share, on_or_off);
  const double most = at_or_zero(max_level, fixture);
  return wanted > 0 && most > 0 ? std::min(wanted, std::min(most, 1.0)) : 0.0;
}

void OutputProgram::own_levels_at(Time now, std::span<double> level) const {
  const double share =
      done(now) ? 1.0
      : now <= start
          ? 0.0
          : fade_share(curve, static_cast<double>((now - start).count()) / static_cast<double>(duration.count()));
  for (std::size_t i = 0; i < level.size(); ++i) level[i] = faded_level(i, share);
  switch_off_partial(level);
  const double left = excess_share(now);
  if (left > 0) {
    // Rows alone would put out the lamps that goals need least one after the other, each in a part of the time.
    scale_to_limits(worst_lux_per_level, max_lx, level, 0, switched, worth);
    for (std::size_t i = 0; i < level.size(); ++i) {
      const double wanted = faded_level(i, share);
      const bool on_or_off = is_on_or_off(switched, static_cast<Eigen::Index>(i));
      level[i] = on_or_off ? wanted : level[i] + left * (wanted - level[i]);
    }
    switch_off_partial(level);
  }
  scale_rows(
      worst_lux_per_level, std::min(worst_lux_per_level.rows(), max_lx.size()),
      [&](Eigen::Index row) { return row < excess_lx.size() ? max_lx[row] + left * excess_lx[row] : max_lx[row]; },
      level, 0, switched, worth);
}

double OutputProgram::excess_share(Time now) const {
  if (excess_lx.size() == 0 || now >= excess_since + kExcessFades) return 0;
  if (now <= excess_since) return 1;
  return 1 - to_seconds(now - excess_since) / to_seconds(kExcessFades);
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
  switch_off_partial(level);
}

void OutputProgram::wanted_levels_at(Time now, std::span<double> level) const {
  shared_levels_at(now, level);
  const std::size_t staged = std::min(level.size(), lamp_starts.size());
  for (std::size_t i = 0; i < staged; ++i)
    level[i] = std::min(level[i], lamp_starts[i].ceiling(now) * std::min(at_or_zero(max_level, i), 1.0));
  switch_off_partial(level);
}

void OutputProgram::shared_levels_at(Time now, std::span<double> level) const {
  own_levels_at(now, level);
  if (desks.empty()) return;
  if (!desk_has_a_say(now)) {
    // The levels sent now are Luxrig's own. They are within the limits by meter readings, but may be brighter than the
    // limits for any levels allowed so far.
    if (now < turned_until) return scale_to_limits(any_lux_per_level, any_max_lx, level, 0, switched, worth);
    Time last = turned_until;
    for (const DeskBlend& desk : desks) last = std::max(last, desk.start + desk.duration);
    if (now >= last + limits_released) return;
    const double relief = fade_share(curve, to_seconds(now - last) / to_seconds(limits_released));
    return scale_to_limits(any_lux_per_level, any_max_lx, level, relief, switched, worth);
  }
  for (const DeskBlend& desk : desks) {
    if (!desk.is_own(now)) desk.apply(now, now < heads_arrive ? heads_guarded : kNobody, level);
  }
  for (std::size_t i = 0; i < level.size(); ++i) {
    const double most = at_or_zero(max_level, i);
    if (is_on_or_off(switched, static_cast<Eigen::Index>(i))) level[i] = switched_level(level[i]);
    level[i] = level[i] > 0 && most > 0 ? std::min(level[i], std::min(most, 1.0)) : 0.0;
  }
  switch_off_partial(level);
  scale_to_limits(any_lux_per_level, any_max_lx, level, 0, switched, worth);
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
