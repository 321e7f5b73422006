#include "tools/bench/methods/compared_methods.h"

#include "core/solve/placement/methods/baselines.h"
#include "core/solve/placement/placement_methods.h"

namespace luxrig {
namespace {

/// The method as it could have been with a simplex for many unknowns.
template <Result<FoundLights> (*method)(const PlacementProblem&, const PlacementOptions&)>
Result<FoundLights> with_subplex(const PlacementProblem& problem, const PlacementOptions& options) {
  PlacementOptions changed = options;
  changed.subplex = true;
  return method(problem, changed);
}

}  // namespace

Result<FoundLights> place_by_annealing(const PlacementProblem& problem, const PlacementOptions& options) {
  AnnealOptions annealing;
  annealing.iterations = 100'000;
  annealing.nearest = 0;
  return annealed_and_refined(problem, options, annealing);
}

const std::vector<PlacementMethod>& compared_methods() {
  static const std::vector<PlacementMethod> all = [] {
    std::vector<PlacementMethod> methods(placement_methods().begin(), placement_methods().end());
    methods.insert(
        methods.end(),
        {{"gpk15-subplex", "gpk15, refined by subplex instead of Nelder-Mead", true, false,
          with_subplex<place_by_gpk15>},
         {"gp16-subplex", "gp16, refined by subplex instead of Nelder-Mead", true, true, with_subplex<place_by_gp16>},
         {"lin2013", "Lin et al. 2013: coarse to fine, light tree, simplex", true, true, place_by_lin2013},
         {"annealing", "annealing by random mutations", true, false, place_by_annealing},
         {"pursuit", "non-negative orthogonal matching pursuit over candidates", true, true, place_by_pursuit}});
    return methods;
  }();
  return all;
}

const PlacementMethod* find_compared_method(std::string_view name) {
  for (const PlacementMethod& method : compared_methods())
    if (name == method.name) return &method;
  return nullptr;
}

}  // namespace luxrig
