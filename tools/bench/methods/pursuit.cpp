#include "core/solve/placement/methods/method_parts.h"
#include "tools/bench/methods/compared_methods.h"

namespace luxrig {

Result<FoundLights> place_by_pursuit(const PlacementProblem& problem, const PlacementOptions& options) {
  const auto candidates = CandidateLights::make(problem);
  if (!candidates) return tl::unexpected(candidates.error());
  std::size_t columns = 0;
  const auto report = reporter(options.better, columns);
  ChosenCandidates chosen(*candidates);
  std::vector<std::pair<std::size_t, double>> cuts = {{0, chosen.error()}};
  pursue(chosen, options.lights > 0 ? options.lights : options.max_lights, options.number.wanted_error,
         options.watch.stop, [&](const ChosenCandidates& so_far) {
           cuts.emplace_back(so_far.size(), so_far.error());
           if (report) report(so_far);
         });
  if (options.lights == 0)
    while (chosen.size() > cuts[fewest_worth_it(cuts, options)].first) chosen.drop(chosen.size() - 1);
  FoundLights found{chosen.placed(columns)};
  found.columns = columns;
  found.tree = std::move(cuts);
  return found;
}

}  // namespace luxrig
