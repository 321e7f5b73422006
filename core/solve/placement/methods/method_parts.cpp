#include "core/solve/placement/methods/method_parts.h"

namespace luxrig {

std::optional<Fault> missing_number(const PlacementOptions& options) {
  if (options.lights > 0) return std::nullopt;
  Fault fault;
  fault.cause = Cause::invalid;
  fault.detail = "this method does not choose the number of lights";
  return fault;
}

SimplexOptions simplex_of(const PlacementProblem& problem, const PlacementOptions& options, std::size_t max_columns,
                          std::size_t columns, const std::function<void(const BestSoFar&)>& better) {
  SimplexOptions simplex;
  simplex.subplex = options.subplex;
  simplex.cell_m = problem.spacing_m;
  simplex.wanted_error = options.number.wanted_error;
  simplex.max_columns = max_columns > columns ? max_columns - columns : 0;
  simplex.stop = options.watch.stop;
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

std::size_t fewest_worth_it(const std::vector<std::pair<std::size_t, double>>& cuts, const PlacementOptions& options) {
  return fewest_worth_it(
      cuts.size(), [&](std::size_t i) { return cuts[i].second; }, options.number);
}

}  // namespace luxrig
