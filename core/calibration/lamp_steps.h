#pragma once
/// One lamp at a time, at a few levels: which levels, and the dimmer's curve that follows from light read at them.

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "core/rig/rig.h"

namespace luxrig {

/// Light of one fixture alone; level 0 = every lamp is dark.
struct LampStep {
  std::size_t fixture = 0;
  double level = 0;
};

/// For a person: "spot-3" alone at level 0.62.
[[nodiscard]] std::string words_of(const LampStep& step, const Rig& rig);
/// Levels of all fixtures.
[[nodiscard]] std::vector<double> levels_of(const LampStep& step, const Rig& rig);
/// The same for several lamps at once; none = every lamp is dark.
[[nodiscard]] std::vector<double> levels_of(std::span<const LampStep> lit, const Rig& rig);

/// The most that a lamp may give at a place at this level, over what is stated there at full level: half as much again, as
/// its output and its mount are off, and its dimmer the flattest of the field, whose light is level^0.8.
[[nodiscard]] double most_share(double level);

/// Per fixture, the brightest level at which it may be measured alone: no limit is exceeded, even if it gives
/// most_share(). stated_lux: RigLight::stated_lux().
[[nodiscard]] std::vector<double> brightest_levels(const Rig& rig, const Eigen::MatrixXd& stated_lux);

/// All lamps that dim, at once, as bright as their sum may be. brightest: of each alone.
[[nodiscard]] std::vector<double> levels_together(const Rig& rig, const Eigen::MatrixXd& stated_lux,
                                                  std::span<const double> brightest);

/// Shares of the brightest level at which a curve is read, brightest first. Few: a dimmer is nearly a power of the level
/// above a dead band, which curve_of() finds; what of a reading departs from that by more than its noise stays.
inline constexpr double kCurveShares[] = {1, 0.4, 0.12, 0.05};

/// Mean of a luxmeter's readings under steady light.
struct SteadyReading {
  double lux = 0, standard_error_lx = 0;
};

/// A reading under one lamp at this level, the dark taken off.
struct ReadAtLevel {
  double level = 0;
  SteadyReading light;
};

struct LampCurve {
  MeasuredCurve of_level{};  ///< share of full light by level; empty = not measured, the maker's holds
  double error = 0;          ///< standard error of a share, relative, from `known_from` on
  double error_in_use = 0;   ///< of one near 0.4, where lamps mostly are
  double known_from = 0;     ///< below this level readings tell less: there it is what the dimmer's law makes of them
};

/// brightest_first: all by the same meter at the same place. Readings that are too uncertain for a curve are left out.
/// Above the brightest level, if that is below full, a dimmer is taken to go on as it does below.
/// used_over_brightest: light that it may give in use, over that at its brightest here; ≥ 1.
[[nodiscard]] LampCurve curve_of(std::span<const ReadAtLevel> brightest_first, double used_over_brightest = 1);

}  // namespace luxrig
