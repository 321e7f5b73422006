#pragma once
/// The status as JSON. Its keys are a contract; API.md beside this file lists them.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/rig/rig.h"
#include "core/show/show_controller.h"
#include "drivers/registry.h"
#include "tools/luxrigd/hand_question.h"

namespace luxrig {

struct OutputFigures {
  double rate_hz = 0;
  std::uint64_t frames = 0;
  std::int64_t p50_us = 0, p99_us = 0, max_us = 0;
  bool realtime = false;
};

struct StatusInput {
  const Rig& rig;
  const ShowStatus& show;
  const std::vector<Health>& devices;
  OutputFigures output;
  bool simulated = false;
  Time started{};
  Time now{};
  std::optional<Redirect> sim_control{};
  std::optional<AskedQuestion> question{};
};

[[nodiscard]] std::string status_json(const StatusInput& input);

/// One point: "lux" and "uncertainty_lux" (half of the 95 % interval), "verdict" and "reason", "limit" and
/// "limit_reason". Each only if it has a value.
void put_verdicts(nlohmann::json& out, const PointStatus& status);
/// "goals": {"met", "missed", "unknown", "tolerance"} and "limits": {"kept", "exceeded", "unknown"}.
void put_counts(nlohmann::json& out, const ShowStatus& show, double goal_tolerance);

}  // namespace luxrig
