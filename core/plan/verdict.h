#pragma once
/// Whether a goal is met and a limit is kept: the one definition, for solve, run, status, page, JSON and exit codes.
///
/// The true illuminance of a point lies in an interval [low, high] with 95 % confidence. A goal g with tolerance t
/// allows [g − t, g + t].
///   met      the interval is inside the allowed range
///   missed   the interval is outside it
///   unknown  it overlaps an edge, so too little is known; the reason says how to settle it
/// Source: ISO 14253-1, decision rules with measurement uncertainty. "As near as the limits allow" is a reason for
/// missed, not a kind of met.

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace luxrig {

enum class Verdict { met, missed, unknown };
[[nodiscard]] const char* name_of(Verdict verdict);
[[nodiscard]] std::optional<Verdict> verdict_named(const std::string& name);

/// Illuminance at a point: best estimate, and half the width of its 95 % interval.
struct LuxEstimate {
  double lux = 0, half_width_lx = 0;
};

/// From a model or a reading with this standard error; 95 % of a normal distribution.
[[nodiscard]] LuxEstimate estimate_of(double lux, double standard_error_lx);

/// From a luxmeter: its reading, its repeatability (standard deviation, share of the reading), its tolerance (the true
/// value lies within ± that share, evenly distributed) and its step.
[[nodiscard]] LuxEstimate estimate_of_reading(double lux, double repeatability, double tolerance, double step_lx);

/// Deviation that a goal allows: a share of it. For a goal of 0: of the largest goal beside it.
[[nodiscard]] double tolerance_lx(double goal_lx, double tolerance, double largest_goal_lx);

[[nodiscard]] Verdict verdict_of(const LuxEstimate& estimate, double goal_lx, double tolerance_lx);

/// One sentence for a person.
///   met      empty
///   missed   by how much, and `binding`: what keeps the point from its goal (may be empty)
///   unknown  how well the light is known, and `settles`: how to settle it
[[nodiscard]] std::string reason_of(Verdict verdict, const LuxEstimate& estimate, double goal_lx, double tolerance_lx,
                                    const std::string& binding, const std::string& settles);

enum class LimitVerdict { kept, exceeded, unknown };
[[nodiscard]] const char* name_of(LimitVerdict verdict);

/// Number of points with each verdict.
struct VerdictCounts {
  int met = 0, missed = 0, unknown = 0;
  [[nodiscard]] int goals() const { return met + missed + unknown; }
  void add(Verdict verdict) { ++(verdict == Verdict::met ? met : verdict == Verdict::missed ? missed : unknown); }
};

/// "all 6 goals met", "1 of 6 goals missed, 2 unknown", "no goal missed: 6 of 40 met, 34 unknown", "no goals".
[[nodiscard]] std::string text_of(const VerdictCounts& counts);
/// "within 10 %", "within 10 to 25 %": shares of the goals. least <= most.
[[nodiscard]] std::string tolerance_text(std::pair<double, double> least_and_most);

}  // namespace luxrig
