#pragma once
/// Levels of fixed lights from goals in lux, under hard limits.
///
///   minimise  Σ_s w_s² (T_s c + b_s − max(g_s, b_s))²   over points with a goal
///   subject to 0 ≤ c_j ≤ u_j   and   T_s c + b_s ≤ m_s   for points with a limit   and   Σ_j p_j c_j ≤ P
///
/// With coloured goals the sum is over the three primaries of each, with w_s² / 3: an error in white light then counts
/// as it does without colour. Limits remain limits in lux.
///
/// Source: Lawson & Hanson, Solving Least Squares Problems (1974), ch. 23 (NNLS, LDP, LSI); thesis §2.7.2.

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "core/run.h"

namespace luxrig {

struct EmittanceProblem {
  Eigen::MatrixXd lux_per_level;  ///< T: points × lights, ≥ 0, finite
  Eigen::VectorXd fixed_lx;       ///< b: light from elsewhere; empty = 0
  Eigen::VectorXd goal_lx;        ///< g; NaN where a point has no goal
  Eigen::VectorXd weight;         ///< w ≥ 0; empty = 1
  Eigen::VectorXd max_lx;         ///< m; +inf where there is no limit
  Eigen::VectorXd max_level;      ///< u ≥ 0; empty = 1
  Eigen::VectorXd near_level;     ///< among levels that give the same light: nearest to these; empty = 0 (power)
  /// Colour, linear Rec. 709 with E in each primary for white of E lux. T by primary (three), points × lights; empty =
  /// goals without colour. lux_per_level and fixed_lx are the luminances of these.
  std::vector<Eigen::MatrixXd> rgb_per_level{};
  Eigen::MatrixXd fixed_rgb{};                                 ///< points × 3; empty = 0
  Eigen::MatrixXd goal_rgb{};                                  ///< points × 3: colour of each goal, luminance 1
  Eigen::VectorXd watts{};                                     ///< p ≥ 0: power of each light at level 1; empty = 0
  double max_watts = std::numeric_limits<double>::infinity();  ///< P ≥ 0
  /// Per light: it is either off or at max_level (finite), as on a relay; empty = all dim.
  std::vector<bool> switched{};
  std::vector<std::string> point_name, light_name;  ///< for the reasons; empty = "point 3", counted from 0
  /// Levels near the answer, as of a problem that differs a little. The answer is the same up to rounding, sooner; empty
  /// = from dark.
  Eigen::VectorXd start_level{};
  bool explained = true;  ///< false: no reasons. They take up to four more solves where a goal is missed
};

/// Why a point misses its goal.
enum class Binding {
  none,
  max_lux_here,
  max_lux_elsewhere,
  max_level,
  min_level,
  out_of_reach,
  traded,
  power,
  switched,  ///< lights that are on or off: the goal would be met if they could dim
  colour     ///< no mix of the lights that reach it comes near the colour
};

struct PointOutcome {
  double lux = 0;
  double shortfall_lx = 0;  ///< goal − lux where there is a goal (negative: too bright)
  Binding binding = Binding::none;
  std::string reason;             ///< one sentence; empty when met (within 1 %)
  std::vector<int> limit_points;  ///< points whose max_lx binds and limits this one
  std::vector<int> limit_lights;  ///< lights at max_level that limit this one
};

struct EmittanceSolution {
  Eigen::VectorXd level;  ///< within [0, u] and T c + b ≤ m, exactly (in floating point, as written)
  std::vector<PointOutcome> points;
  double normalised_error = 0;  ///< ‖T c + b − g‖ / ‖g‖ over points (and primaries) with a goal, unweighted (thesis)
  /// Largest violation of the KKT conditions, relative; see emittance.cpp. Of dimmable lights, with switched lights as
  /// set.
  double kkt_residual = 0;
  int iterations = 0;
  bool switches_proven = true;  ///< no other setting of switched lights is better; false = the search was cut off
};

/// Of levels that give the same light, those nearest to near_level are chosen, and equal lights share equally (a tie
/// term of 1e-5 of each light's column, which changes lux by about 1e-10 of it). A point without lights keeps b. Branch
/// and bound sets switched lights (switched_least_squares.h).
/// A goal is met within 1 % of it (a goal of 0: within 1 % of the largest goal). A coloured goal is met when the
/// distance of the primaries is within 1 % of their norm.
///
/// Cause::invalid when sizes disagree, an entry is negative, not finite (max_lx may be +inf) or beyond 1e100, or a
/// limit is below the fixed light (the detail then names the point). Cause::cancelled when stopped.
[[nodiscard]] Result<EmittanceSolution> solve_emittance(const EmittanceProblem& problem, const Watch& watch = {});

}  // namespace luxrig
