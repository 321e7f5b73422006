#pragma once
/// Outcomes as files: JSON (also between processes), JUnit, traces.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/result.h"
#include "tools/scenario/outcome.h"
#include "tools/scenario/scenario.h"

namespace luxrig::scenario {

/// Every number of an outcome; a NaN of a trace becomes null.
[[nodiscard]] nlohmann::json to_json(const Outcome& outcome);
/// Of to_json; not for files of strangers.
[[nodiscard]] Outcome outcome_of(const nlohmann::json& json);

struct Tested {
  Scenario scenario;
  std::vector<Outcome> outcomes;  ///< per seed
};

/// {"rig", "passed", "scenarios": [{"file", "name", "passed", "runs": [outcome]}]}
[[nodiscard]] std::string results_json(const std::string& rig, const std::vector<Tested>& tested);
/// A test suite per scenario, a test case per expectation, and one for each rule that was broken.
[[nodiscard]] std::string junit_xml(const std::string& rig, const std::vector<Tested>& tested);
/// A line per instant.
[[nodiscard]] std::string trace_csv(const Trace& trace);
/// One page without scripts: what failed, what happened, and a picture of each kind of value over time.
[[nodiscard]] std::string trace_html(const Scenario& scenario, const Outcome& outcome);

}  // namespace luxrig::scenario
