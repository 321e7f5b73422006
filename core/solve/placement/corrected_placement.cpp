#include "core/solve/placement/corrected_placement.h"

namespace luxrig {

Result<CorrectedPlacement> place_and_correct(const PlacementMethod& method, const PlacementProblem& problem,
                                             const PlacementOptions& options,
                                             const CorrectedPlacementOptions& correction) {
  auto found = method.run(problem, options);
  if (!found) return tl::unexpected(std::move(found.error()));
  CorrectedPlacement placed{std::move(*found), {}, {}, 0};
  placed.columns = placed.found.columns;
  if (!correction.lux_of || options.watch.stop.stop_requested()) return placed;
  const auto search_again = [&](const LightingGoal& goal, const PlacedLights& from) {
    PlacementProblem again = problem;
    again.goal = &goal;
    PlacementOptions how = options;
    how.better = {};
    how.whole_curve = false;
    how.start = from.poses();
    how.max_columns = static_cast<std::size_t>(correction.share * static_cast<double>(options.max_columns));
    const auto more = method.run(again, how);
    if (!more) return from;
    placed.columns += more->columns;
    return more->lights;
  };
  CorrectOptions rounds;
  rounds.max_rounds = correction.max_rounds;
  auto corrected =
      correct_lights(*problem.light, *problem.goal, placed.found.lights, correction.lux_of, search_again, rounds);
  if (corrected)
    placed.corrected = std::move(*corrected);
  else
    placed.failed = std::move(corrected.error());
  return placed;
}

}  // namespace luxrig
