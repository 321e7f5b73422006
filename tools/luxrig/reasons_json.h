#pragma once
/// Why the lights of relief tasks are as they are, for `solve --explain --json`.

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "core/tasks/relief_reasons.h"

namespace luxrig {

/// A plan whose relief tasks have "explained": {"why": two sentences, "dark_lights", "gain_if_lit"?, "lights":
/// [{"name", "fine", "form", "lit", "edge"} or {"name", "contrast", "coverage"}]}, shares as in LightService.
[[nodiscard]] inline std::string with_reasons(const std::string& plan_json, std::span<const ReliefReasons> all) {
  auto plan = nlohmann::ordered_json::parse(plan_json);
  for (const ReliefReasons& reasons : all)
    for (auto& task : plan["tasks"]) {
      if (task.value("name", "") != reasons.task) continue;
      nlohmann::ordered_json explained = {{"why", in_two_sentences(reasons)}, {"dark_lights", reasons.dark}};
      if (reasons.gain_of_dark) explained["gain_if_lit"] = *reasons.gain_of_dark;
      explained["lights"] = nlohmann::ordered_json::array();
      for (const LightService& light : reasons.lights) {
        nlohmann::ordered_json one = {{"name", light.light}};
        if (reasons.seen) {
          one["fine"] = light.fine;
          one["form"] = light.form;
          one["lit"] = light.lit;
          one["edge"] = light.edge;
        } else {
          one["contrast"] = light.contrast;
          one["coverage"] = light.coverage;
        }
        explained["lights"].push_back(std::move(one));
      }
      task["explained"] = std::move(explained);
    }
  return plan.dump(1);
}

}  // namespace luxrig
