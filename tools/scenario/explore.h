#pragma once
/// Looks for shows that break a rule: random faults and commands. From each that breaks one, it keeps the smallest that
/// does.

#include <functional>
#include <string>
#include <vector>

#include "tools/scenario/outcome.h"
#include "tools/scenario/prepared_rig.h"
#include "tools/scenario/scenario.h"

namespace luxrig::scenario {

struct ExploreOptions {
  double minutes = 5;
  int jobs = 1;
  std::uint64_t seed = 1;  ///< of the first show; the next ones count on
  double length_s = 90;    ///< of a show
  std::uint64_t max_shows = UINT64_MAX;
};

struct Finding {
  std::string rule;   ///< the broken rule's sentence
  Scenario scenario;  ///< the smallest
  Outcome outcome;    ///< of that
};

struct Explored {
  std::vector<Finding> findings;  ///< one per broken rule
  std::uint64_t shows = 0;        ///< random ones
};

/// told   called now and then with the number of shows so far
[[nodiscard]] Explored explore(const PreparedRig& rig, const ExploreOptions& options,
                               const std::function<void(const Explored&)>& told = {});

/// A random show of the rig: the same for the same seed.
[[nodiscard]] Scenario random_show(const Rig& rig, std::uint64_t seed, double length_s);

/// The scenario as a file: parse_scenario of it gives the same show.
[[nodiscard]] std::string to_toml(const Scenario& scenario);

}  // namespace luxrig::scenario
