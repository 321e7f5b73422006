#pragma once
/// The levels and aims sent out, as a pure function of time. The controller makes one; the output thread evaluates it
/// every cycle. Blackout and limits are applied here, last, so that nothing earlier can undo them.

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

/// Cost of taking away a lamp's light: 1 for the lamp, plus per_level_squared · level² for the goals that it lights
/// (the sum of the squares of its shares of each goal). Emitters of one housing dim together, so that its colour stays.
/// Either vector may be empty: no goals, no housings.
struct LampWorth {
  std::vector<double> per_level_squared;  ///< per fixture, ≥ 0, finite
  std::vector<std::size_t> housing;       ///< per fixture: the first of those that change together, which are adjacent
};

/// Dims, in place, until worst_lux_per_level · level ≤ max_lx in every row, whatever the order of summation. At a point
/// above its limit, each lamp dims by a share proportional to its light there divided by its worth elsewhere. This
/// minimises the sum of squares of those shares, weighted by worth.
///
/// worst_lux_per_level  limited points × fixtures, ≥ 0; an entry that is not finite darkens its fixture
/// max_lx               per row; NaN or ≤ 0 darkens every fixture that lights that point
/// level                per fixture, ≥ 0, finite
/// relief               0…1: share of the excess over a limit that stays. For a fade back to levels known to be within
///                      limits. These rows hold for any levels and would still forbid them.
/// switched             per fixture, 1 = on or off. These stay on as long as dimming the others suffices. Then the
///                      brightest at that point goes off. May be empty
/// Allocates nothing. With a limit below 1e-290 lx, the point is darkened.
void scale_to_limits(const Eigen::MatrixXd& worst_lux_per_level, const Eigen::VectorXd& max_lx, std::span<double> level,
                     double relief = 0, std::span<const std::uint8_t> switched = {}, const LampWorth& worth = {});

/// Per fixture, 1 = on or off.
[[nodiscard]] std::vector<std::uint8_t> switched_fixtures(const Rig& rig);
/// The level of an on-or-off lamp for a wanted level.
[[nodiscard]] inline double switched_level(double level) { return level >= 0.5 ? 1 : 0; }
/// The level at share 0…1 of the way between two levels; exact at both ends. A switched lamp goes off when the way
/// begins and on when it ends, so there is never more light than on the straight way.
[[nodiscard]] double level_on_the_way(double from, double to, double share, bool switched);

/// Dims a head whose beam could meet a keep-out zone: on its way to dark, dark, or on its way back. It takes light
/// away, whoever wants it. While `held`, the head keeps its posture, so that it is dark before it turns.
struct HeadDim {
  std::size_t fixture = 0;
  double from = 1, to = 1;  ///< share of its light that is let out; linear in between
  Time start{};
  Duration duration{};
  bool held = false;
  Joints held_at;
  [[nodiscard]] double share(Time now) const;
};

/// Light that only now is known to be perhaps too much goes out within this: fast for paper, slow for an eye.
inline constexpr Duration kExcessFades = std::chrono::seconds(1);

struct OutputProgram {
  std::uint64_t revision = 0;                ///< grows with each change
  std::vector<double> from_level, to_level;  ///< per fixture
  Time start{};
  Duration duration{};  ///< 0 = at once
  FadeCurve curve = FadeCurve::s_curve;
  std::vector<double> max_level;         ///< per fixture, limits applied
  std::vector<std::uint8_t> switched{};  ///< per fixture, 1 = on or off, never between; may be empty
  std::vector<Joints> joints;            ///< per fixture; target joints of moving heads
  bool blackout = false;                 ///< all levels 0 at once; joints unchanged

  /// Conservation limits: rows = limited points. Matrix: the most lux per level that the model allows there now
  /// (including gain bounds, meter tolerance and standard errors). max_lx: the limit itself. A power limit is a row of
  /// its own, in watts per level and watts.
  Eigen::MatrixXd worst_lux_per_level;
  Eigen::VectorXd max_lx;
  LampWorth worth{};  ///< decides which lamps dim for a limit
  /// Light above `max_lx`, per row, that was already on when the rows were set: only now is it known to be perhaps too
  /// much. Each lamp gives its part up evenly within kExcessFades from `excess_since` on, so that none jumps. Empty:
  /// there is none.
  Eigen::VectorXd excess_lx{};
  Time excess_since{};

  /// Lighting desks in control, one per part of the rig that follows one.
  std::vector<DeskBlend> desks;
  /// The same limits for arbitrary levels, since a desk may send any. They apply while a desk is in control, and are
  /// released over `limits_released` afterwards.
  Eigen::MatrixXd any_lux_per_level;
  Eigen::VectorXd any_max_lx;
  Duration limits_released{};
  /// Heads that were turned by hand, of which these limits hold wherever they are aimed; and when all of them were back.
  /// Until then the limits apply in full. turned: per fixture, 1 = such a head; may be empty.
  std::vector<std::uint8_t> turned{};
  Time turned_until{};
  /// Until then, heads with limits round them are moving, and a desk cannot light them.
  Time heads_arrive{};
  std::vector<std::uint8_t> heads_guarded;  ///< per fixture, 1 = such a head; may be empty

  std::vector<HeadDim> dims;           ///< for keep-out zones, by fixture
  LampStarts lamp_starts;              ///< after power-up; empty = nothing is staged
  std::vector<std::uint8_t> parked{};  ///< per fixture, 1 = desks do not turn it; may be empty

  /// Levels at `now`, per fixture. Never above max_level, and worst_lux_per_level · level never above max_lx with what
  /// is left of excess_lx (scale_to_limits). Both limits apply to a desk's levels, too. Values that are missing or NaN
  /// count as 0. Times before `start` count as `start`. Allocates nothing.
  void levels_at(Time now, std::span<double> level) const;
  /// Target joints of heads at `now`, per fixture. Allocates nothing.
  void joints_at(Time now, std::span<Joints> joints) const;
  /// The same without `dims`: as wanted, before heads are dimmed for keep-out zones.
  void wanted_levels_at(Time now, std::span<double> level) const;
  void wanted_joints_at(Time now, std::span<Joints> joints) const;
  /// A desk is in control, or its fade back to Luxrig has not ended.
  [[nodiscard]] bool desk_has_a_say(Time now) const;
  [[nodiscard]] bool done(Time now) const { return now >= start + duration; }

 private:
  void switch_off_partial(std::span<double> level) const;
  /// Share of `excess_lx` that is still let out.
  [[nodiscard]] double excess_share(Time now) const;
  /// Of the fade alone, without limits.
  [[nodiscard]] double faded_level(std::size_t fixture, double share) const;
  void own_levels_at(Time now, std::span<double> level) const;
  void shared_levels_at(Time now, std::span<double> level) const;
};

}  // namespace luxrig
