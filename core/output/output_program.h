#pragma once
/// What goes out, as a pure function of time: the controller makes one, the output thread evaluates it
/// every cycle. Blackout and limits are applied here, last, so nothing that comes before can undo them.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/output/desk_blend.h"
#include "core/output/startup_stages.h"
#include "core/rig/rig.h"
#include "core/time.h"

namespace luxrig {

/// Share of a fade done, 0…1, at share `x` of its time (clamped): linear x, or s-curve 3x² − 2x³.
[[nodiscard]] double fade_share(FadeCurve curve, double x);

/// drive <-> level of a maker's nominal curve; both 0…1, strictly monotone, exact at 0 and 1.
[[nodiscard]] double level_from_drive(DimmerCurve curve, double drive);
[[nodiscard]] double drive_from_level(DimmerCurve curve, double level);

/// What is lost with a lamp's light: 1 for the lamp, and per_level_squared · level² for the goals that it lights (the
/// sum of the squares of the shares that it gives of each). Emitters of one housing dim together, so that its colour
/// stays. Either may be empty: no goals, no housings.
struct LampWorth {
  std::vector<double> per_level_squared;  ///< per fixture, ≥ 0, finite
  std::vector<std::size_t> housing;  ///< per fixture: the first of those that change together, which are neighbours
};

/// Dims, in place, until worst_lux_per_level · level ≤ max_lx in every row, whatever the order of summation. Of a point
/// above its limit the lamps that light it dim each by a share in proportion to what it gives there over what it is
/// worth elsewhere: least squares of those shares, each times the lamp's worth.
///
/// worst_lux_per_level  limited points × fixtures, ≥ 0; an entry that is not finite darkens its fixture
/// max_lx               per row; not a number or ≤ 0 darkens every fixture that lights that point
/// level                per fixture, ≥ 0, finite
/// relief               0…1: share of what is above a limit that stays; for a way back to levels that are known to be
///                      within limits although these rows, which hold for any levels, say otherwise
/// switched             per fixture, 1: it is on or off. Such ones are kept as long as the others can be dimmed enough;
///                      then the brightest at that point goes off. May be empty
/// Allocates nothing. With a limit below 1e-290 lx the point is darkened.
void scale_to_limits(const Eigen::MatrixXd& worst_lux_per_level, const Eigen::VectorXd& max_lx, std::span<double> level,
                     double relief = 0, std::span<const std::uint8_t> switched = {}, const LampWorth& worth = {});

/// Per fixture, 1: it is on or off.
[[nodiscard]] std::vector<std::uint8_t> switched_fixtures(const Rig& rig);
/// What a lamp that is on or off makes of a level that somebody wants.
[[nodiscard]] inline double switched_level(double level) { return level >= 0.5 ? 1 : 0; }
/// On the way from one level to another, at share 0…1 of it; each end is met exactly. What is switched goes off as the
/// way begins and on as it ends: between the two there is then never more light than on the straight way.
[[nodiscard]] double level_on_the_way(double from, double to, double share, bool switched);

/// A head whose beam could meet a keep-out zone: on its way to dark, dark, or on its way back. It takes light away from
/// whoever wants it, and while `held` keeps the head where it looks, so that it is dark before it turns.
struct HeadDim {
  std::size_t fixture = 0;
  double from = 1, to = 1;  ///< share of its light that goes out; linear in between
  Time start{};
  Duration duration{};
  bool held = false;
  Joints held_at;
  [[nodiscard]] double share(Time now) const;
};

struct OutputProgram {
  std::uint64_t revision = 0;                ///< grows with each change
  std::vector<double> from_level, to_level;  ///< per fixture
  Time start{};
  Duration duration{};  ///< 0: at once
  FadeCurve curve = FadeCurve::s_curve;
  std::vector<double> max_level;         ///< per fixture, limits applied
  std::vector<std::uint8_t> switched{};  ///< per fixture, 1: it is on or off, and never anything between; may be empty
  std::vector<Joints> joints;            ///< per fixture; where moving heads shall look
  bool blackout = false;                 ///< all levels 0, at once; joints unchanged

  /// Conservation limits: rows = limited points; the most lux per level that the model allows there now
  /// (gain bounds, meter tolerance, standard errors included), and the limit itself.
  /// A limit of power is a row of its own, of watts per level, and watts.
  Eigen::MatrixXd worst_lux_per_level;
  Eigen::VectorXd max_lx;
  LampWorth worth{};  ///< which lamps dim for a limit

  /// Lighting desks with a say, one for each part of the rig that follows one.
  std::vector<DeskBlend> desks;
  /// The same limits for levels that nobody has worked out: what a desk wants can be anything. They hold while a desk
  /// has a say; after that they are let go over `limits_released`.
  Eigen::MatrixXd any_lux_per_level;
  Eigen::VectorXd any_max_lx;
  Duration limits_released{};
  /// Until then heads with limits round them are on their way, and a desk cannot light them.
  Time heads_arrive{};
  std::vector<std::uint8_t> heads_guarded;  ///< per fixture: 1 for such a head; may be empty

  std::vector<HeadDim> dims;           ///< for keep-out zones, by fixture
  LampStarts lamp_starts;              ///< after power came; empty: nothing is staged
  std::vector<std::uint8_t> parked{};  ///< per fixture, 1: desks do not turn it; may be empty

  /// Levels at `now`, per fixture. Never above max_level; never with worst_lux_per_level · level above max_lx
  /// (scale_to_limits); what a desk wants is within both, too. Allocates
  /// nothing.
  /// Values that are missing or not numbers count as 0. The time before `start` counts as `start`.
  void levels_at(Time now, std::span<double> level) const;
  /// Where heads shall look at `now`; joints: per fixture. Allocates nothing.
  void joints_at(Time now, std::span<Joints> joints) const;
  /// The same but for `dims`: what they keep from happening.
  void wanted_levels_at(Time now, std::span<double> level) const;
  void wanted_joints_at(Time now, std::span<Joints> joints) const;
  /// Some desk has a say, or has just had it.
  [[nodiscard]] bool desk_has_a_say(Time now) const;
  [[nodiscard]] bool done(Time now) const { return now >= start + duration; }

 private:
  void switch_off_partial(std::span<double> level) const;
  void own_levels_at(Time now, std::span<double> level) const;
  void shared_levels_at(Time now, std::span<double> level) const;
};

}  // namespace luxrig
