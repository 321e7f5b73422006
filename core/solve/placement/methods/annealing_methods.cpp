#include "core/solve/placement/methods/baselines.h"
#include "core/solve/placement/methods/method_parts.h"
#include "core/solve/placement/methods/starts.h"

namespace luxrig {
namespace {

constexpr int kComplementIterations = 1000;  // as the thesis says

}  // namespace

Result<FoundLights> annealed_and_refined(const PlacementProblem& problem, const PlacementOptions& options,
                                         AnnealOptions annealing) {
  if (const auto missing = missing_number(options)) return tl::unexpected(*missing);
  const auto candidates = CandidateLights::make(problem);
  if (!candidates) return tl::unexpected(candidates.error());
  if (options.iterations > 0) annealing.iterations = options.iterations;
  annealing.wanted_error = options.number.wanted_error;
  annealing.stop = options.watch.stop;
  return best_of_starts(options, [&](const PlacementStart& start) {
    std::mt19937_64 random(start.seed);
    std::size_t columns = 0;
    AnnealOptions of_start = annealing;
    of_start.better = reporter(start.better, columns);
    ChosenCandidates first(*candidates);
    if (annealing.nearest > 0 && start.index == 0)
      pursue(first, options.lights, options.number.wanted_error, options.watch.stop, of_start.better);
    if (first.size() < options.lights && first.error() > options.number.wanted_error) {
      std::vector<std::size_t> lights = first.chosen();
      for (const std::size_t drawn : drawn_candidates(**candidates, options.lights, random))
        if (lights.size() < options.lights && !first.holds(drawn)) lights.push_back(drawn);
      first.choose(std::move(lights));
    }
    if (of_start.better) of_start.better(first);
    const ChosenCandidates best = anneal(std::move(first), of_start, random);
    FoundLights found{best.placed(columns)};
    columns += refine_by_simplex(found.lights, simplex_of(problem, options, start.max_columns, columns, start.better));
    found.columns = columns;
    return found;
  });
}

Result<FoundLights> place_by_gpk15(const PlacementProblem& problem, const PlacementOptions& options) {
  AnnealOptions annealing;
  annealing.iterations = kComplementIterations;
  return annealed_and_refined(problem, options, annealing);
}

}  // namespace luxrig
