#include "core/plan/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

constexpr double kNormal95 = 1.96;   ///< of a normal distribution, in standard deviations
constexpr double kUniform95 = 0.95;  ///< of an even distribution, in half widths
constexpr double kToleranceRounding = 1e-9;   ///< of the tolerance: a goal met exactly is met

std::string share_text(double lux, double goal_lx) {
  if (!(goal_lx > 0)) return fmt::format("{:.3g} lx too bright", lux);
  return fmt::format("{:.1f} % too {}", 100 * std::abs(lux / goal_lx - 1), lux < goal_lx ? "dark" : "bright");
}

}  // namespace

const char* name_of(Verdict verdict) {
  constexpr const char* kNames[] = {"met", "missed", "unknown"};
  return kNames[static_cast<int>(verdict)];
}

std::optional<Verdict> verdict_named(const std::string& name) {
  for (const Verdict verdict : {Verdict::met, Verdict::missed, Verdict::unknown})
    if (name == name_of(verdict)) return verdict;
  return std::nullopt;
}

const char* name_of(LimitVerdict verdict) {
  constexpr const char* kNames[] = {"kept", "exceeded", "unknown"};
  return kNames[static_cast<int>(verdict)];
}

LuxEstimate estimate_of(double lux, double standard_error_lx) { return {lux, kNormal95 * standard_error_lx}; }

LuxEstimate estimate_of_reading(double lux, double repeatability, double tolerance, double step_lx) {
  return {lux, std::hypot(kNormal95 * repeatability * lux, kUniform95 * tolerance * lux, kUniform95 * step_lx / 2)};
}

double tolerance_lx(double goal_lx, double tolerance, double largest_goal_lx) {
  return tolerance * (goal_lx > 0 ? goal_lx : largest_goal_lx);
}

Verdict verdict_of(const LuxEstimate& estimate, double goal_lx, double tolerance_lx) {
  const double off_lx = std::abs(estimate.lux - goal_lx), allowed_lx = tolerance_lx * (1 + kToleranceRounding);
  // Unknown is never met, nor is NaN.
  if (!std::isfinite(off_lx) || !std::isfinite(estimate.half_width_lx)) return Verdict::unknown;
  if (off_lx + estimate.half_width_lx <= allowed_lx) return Verdict::met;
  if (off_lx - estimate.half_width_lx > allowed_lx) return Verdict::missed;
  return Verdict::unknown;
}

std::string reason_of(Verdict verdict, const LuxEstimate& estimate, double goal_lx, double tolerance_lx,
                      const std::string& binding, const std::string& settles) {
  if (verdict == Verdict::met) return {};
  if (verdict == Verdict::missed) {
    const std::string how = share_text(estimate.lux, goal_lx);
    return binding.empty() ? how : how + ": " + binding;
  }
  const double scale_lx = goal_lx > 0 ? goal_lx : tolerance_lx;
  std::string known = "not known";
  if (std::isfinite(estimate.lux) && std::isfinite(estimate.half_width_lx) && scale_lx > 0)
    known = fmt::format("{:.4g} lx known to ± {:.0f} %, tolerance {:.0f} %", estimate.lux,
                        std::max(1.0, 100 * estimate.half_width_lx / scale_lx), 100 * tolerance_lx / scale_lx);
  return settles.empty() ? known : known + ": " + settles;
}

std::string text_of(const VerdictCounts& counts) {
  const int goals = counts.goals();
  if (goals == 0) return "no goals";
  if (counts.met == goals) return goals == 1 ? "the goal is met" : fmt::format("all {} goals met", goals);
  const std::string unknown = counts.unknown > 0 ? fmt::format(", {} unknown", counts.unknown) : "";
  if (counts.missed > 0) return fmt::format("{} of {} goals missed{}", counts.missed, goals, unknown);
  return fmt::format("no goal missed: {} of {} met{}", counts.met, goals, unknown);
}

std::string tolerance_text(std::pair<double, double> least_and_most) {
  const auto [least, most] = least_and_most;
  if (most <= least) return fmt::format("within {:.3g} %", 100 * most);
  return fmt::format("within {:.3g} to {:.3g} %", 100 * least, 100 * most);
}

}  // namespace luxrig
