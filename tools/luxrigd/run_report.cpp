#include "tools/luxrigd/run_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/luxrigd/api/status_json.h"
#include "tools/terminal/table.h"

namespace luxrig {
namespace {

std::optional<double> error_of(const PointStatus& status) {
  if (!status.goal_lx || *status.goal_lx <= 0) return {};
  return status.measured_lx.value_or(status.predicted_lx) / *status.goal_lx - 1;
}

}  // namespace

void RunReport::say(const std::string& line) const {
  teller_.tell(fmt::format("{:6.1f} s  {}\n", to_seconds(now() - start_), line));
}

void RunReport::say_readings(const ShowStatus& status) const {
  for (std::size_t i = 0; i < status.points.size(); ++i) {
    const Point& point = rig_->points[i];
    const PointStatus& p = status.points[i];
    if (!p.measured_lx) continue;
    const auto error = error_of(p);
    say(fmt::format("  {:<24} {:7.1f} lx measured{}{}", point.name, *p.measured_lx,
                    p.goal_lx ? fmt::format(", goal {:.4g}", *p.goal_lx) : "",
                    error ? fmt::format(" ({:+.1f} %)", 100 * *error) : ""));
  }
}

void RunReport::follow(const ShowStatus& status, Time at) {
  for (const Alarm& alarm : alarms_.to_say(status.alarms, at))
    say((alarm.severe ? "ALARM  " : "warning  ") + alarm.text);
  if (status.phase == phase_ && status.round == round_) return;
  const Phase before = phase_;
  phase_ = status.phase;
  round_ = status.round;
  // The readings before the first correction, and after the last.
  if (phase_ == Phase::correcting || (phase_ == Phase::holding && before != Phase::holding)) say_readings(status);
  say(fmt::format("{}: {}", name_of(status.phase), status.detail));
}

std::string RunReport::table(const ShowStatus& status, const std::optional<SimTruth>& truth) const {
  Table table({"point", ">goal lx", ">predicted lx", ">± se", ">measured lx", ">error", "goal", ">limit lx",
               truth ? ">truth lx" : "", truth ? ">truth max" : "", ""});
  for (std::size_t i = 0; i < status.points.size(); ++i) {
    const Point& point = rig_->points[i];
    const PointStatus& p = status.points[i];
    const auto error = error_of(p);
    std::string note = p.reason;
    if (!p.limit_reason.empty()) note += (note.empty() ? "" : "; ") + p.limit_reason;
    const PointTruthSeen* seen = truth && i < truth->points.size() ? &truth->points[i] : nullptr;
    table.row({point.name, p.goal_lx ? fmt::format("{:.4g}", *p.goal_lx) : "-", fmt::format("{:.1f}", p.predicted_lx),
               fmt::format("{:.1f}", p.standard_error_lx), p.measured_lx ? fmt::format("{:.1f}", *p.measured_lx) : "-",
               error ? fmt::format("{:+.1f} %", 100 * *error) : "-", p.verdict ? name_of(*p.verdict) : "-",
               point.max_lx ? fmt::format("{:g}", *point.max_lx) : "-",
               seen != nullptr ? fmt::format("{:.1f}", seen->lux) : "",
               seen != nullptr ? fmt::format("{:.1f}", seen->max_lux_seen) : "", note});
  }
  return table.text();
}

std::string RunReport::json(const ShowStatus& status, const std::optional<SimTruth>& truth, double converged_s) const {
  nlohmann::json out = {{"rig", rig_->name},
                        {"goals_met", status.goals.met == status.goals.goals()},
                        {"converged", status.converged},
                        {"rounds", status.round},
                        {"seconds_to_converged", converged_s}};
  put_counts(out, status, rig_->control.goal_tolerance);
  if (truth) out["limit_violations_in_truth"] = truth->violations;
  auto& points = out["points"] = nlohmann::json::array();
  const auto set = [](nlohmann::json& object, const char* key, std::optional<double> value) {
    if (value && std::isfinite(*value)) object[key] = *value;
  };
  for (std::size_t i = 0; i < status.points.size(); ++i) {
    const Point& point = rig_->points[i];
    const PointStatus& p = status.points[i];
    nlohmann::json entry = {{"name", point.name}, {"met", p.met()}, {"why", p.why}};
    put_verdicts(entry, p);
    set(entry, "goal_lux", p.goal_lx);
    set(entry, "predicted_lux", p.predicted_lx);
    set(entry, "standard_error_lux", p.standard_error_lx);
    set(entry, "measured_lux", p.measured_lx);
    set(entry, "error", error_of(p));
    set(entry, "max_lux", point.max_lx);
    if (truth && i < truth->points.size()) {
      set(entry, "truth_lux", truth->points[i].lux);
      set(entry, "truth_max_lux", truth->points[i].max_lux_seen);
    }
    points.push_back(std::move(entry));
  }
  return out.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace luxrig
