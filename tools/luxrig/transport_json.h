#pragma once
/// Report on a computation of transport, for `evaluate --json` and plans.

#include <nlohmann/json.hpp>
#include <string>

#include "core/tasks/session.h"

namespace luxrig {

/// "model", "model_reason"
/// "rms_error", "relative_error": standard errors over max(a point's lux, floor): root mean square over the points, and
/// largest
/// "wanted", "wanted_of" ("rms" or "worst"), "reached" (for the worst: two standard errors are within it)
/// "error_floor_lux": a standard error that is small enough at any point (absent when all is exact)
/// "ended_by_time" and "warning" if it was not reached
[[nodiscard]] inline nlohmann::ordered_json transport_json(const ModelUsed& used) {
  nlohmann::ordered_json out = {{"model", used.name},          {"model_reason", used.reason},
                                {"wanted", used.wanted},       {"wanted_of", used.of_worst ? "worst" : "rms"},
                                {"rms_error", used.rms_error}, {"relative_error", used.relative_error},
                                {"reached", used.reached()}};
  if (used.error_floor_lx > 0) out["error_floor_lux"] = used.error_floor_lx;
  if (!used.reached()) {
    out["ended_by_time"] = used.time_was_up;
    out["warning"] = used.warning();
  }
  return out;
}

/// A plan with this report under "transport".
[[nodiscard]] inline std::string with_transport(const std::string& plan_json, const ModelUsed& used) {
  auto plan = nlohmann::ordered_json::parse(plan_json);
  plan["transport"] = transport_json(used);
  return plan.dump(1);
}

}  // namespace luxrig
