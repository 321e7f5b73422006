#include "core/solve/placement/methods/method_parts.h"

namespace luxrig {

std::optional<Fault> missing_number(const PlacementOptions& options) {
  if (options.lights > 0) return std::nullopt;
  Fault fault;
  fault.cause = Cause::invalid;
  fault.detail = "this method does not choose the number of lights";
  return fault;
}

SimplexOptions simplex_of(const PlacementProblem& problem, const PlacementOptions& options, std::size_t most_columns,
                          std::size_t columns, const std::function<void(const BestSoFar&)>& better) {
  SimplexOptions simplex;
  simplex.subplex = options.subplex;
  simplex.cell_m = problem.spacing_m;
  simplex.wanted_error = options.wanted_error;
  simplex.most_columns = most_columns > columns ? most_columns - columns : 0;
  simplex.stop = options.stop;
  if (better)
    simplex.better = [better, columns](const BestSoFar& best) {
      BestSoFar with_former = best;
      with_former.columns += columns;
      better(with_former);
    };
  return simplex;
}

std::function<void(const ChosenCandidates&)> reporter(const std::function<void(const BestSoFar&)>& better,
                                                      const std::size_t& columns) {
  if (!better) return {};
  return [&](const ChosenCandidates& best) { better({best.error(), best.poses(), best.levels(), columns}); };
}

std::size_t fewest_that_do(const std::vector<std::pair<std::size_t, double>>& cuts, const PlacementOptions& options) {
  for (std::size_t i = 0; i < cuts.size(); ++i)
    if (cuts[i].second <= options.wanted_error) return i;
  const double keep = 1 - options.least_improvement;
  bool any_fine = false;
  for (const auto& cut : cuts) any_fine = any_fine || cut.second <= options.coarse_error;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const double error = cuts[i].second;
    if (any_fine && error > options.coarse_error) continue;
    if (cuts[i + 1].second > keep * error && (i + 2 >= cuts.size() || cuts[i + 2].second > keep * keep * error))
      return i;
  }
  return cuts.empty() ? 0 : cuts.size() - 1;
}

}  // namespace luxrig
