#pragma once
/// Uniformity of painted surfaces as JSON: "uniformities": [{"surface_goal", "uniformity", "low", "high", "wanted",
/// "verdict"}].

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "core/plan/uniformity.h"

namespace luxrig {

[[nodiscard]] inline nlohmann::ordered_json uniformities_json(std::span<const Uniformity> all) {
  auto out = nlohmann::ordered_json::array();
  for (const Uniformity& one : all)
    out.push_back({{"surface_goal", one.surface_goal},
                   {"uniformity", one.share},
                   {"low", one.low},
                   {"high", one.high},
                   {"wanted", one.wanted},
                   {"verdict", name_of(one.verdict)}});
  return out;
}

/// A plan with them, if there are any.
[[nodiscard]] inline std::string with_uniformities(const std::string& plan_json, std::span<const Uniformity> all) {
  if (all.empty()) return plan_json;
  auto plan = nlohmann::ordered_json::parse(plan_json);
  plan["uniformities"] = uniformities_json(all);
  return plan.dump(1);
}

}  // namespace luxrig
