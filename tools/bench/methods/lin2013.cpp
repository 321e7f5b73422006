#include "core/solve/placement/methods/method_parts.h"
#include "tools/bench/methods/coarse_to_fine.h"
#include "tools/bench/methods/compared_methods.h"

namespace luxrig {
namespace {

class LinCuts {
 public:
  LinCuts(const PlacementProblem& problem, const PlacementOptions& options,
          const std::shared_ptr<const CandidateLights>& candidates)
      : problem_(problem), options_(options), candidates_(candidates) {}

  /// A cut, possibly empty, refined.
  PlacedLights refined(const TreeCut& cut) {
    ChosenCandidates state(candidates_);
    state.choose(cut.candidates);
    if (const auto report = reporter(options_.better, columns_)) report(state);
    PlacedLights lights = state.placed(columns_);
    columns_ +=
        refine_with_levels_by_simplex(lights, *problem_.light, *problem_.goal,
                                      simplex_of(problem_, options_, options_.max_columns, columns_, options_.better));
    return lights;
  }
  [[nodiscard]] bool ended() const { return options_.watch.stop.stop_requested() || columns_ >= options_.max_columns; }
  [[nodiscard]] std::size_t columns() const { return columns_; }

 private:
  const PlacementProblem& problem_;
  const PlacementOptions& options_;
  const std::shared_ptr<const CandidateLights>& candidates_;
  std::size_t columns_ = 0;
};

}  // namespace

Result<FoundLights> place_by_lin2013(const PlacementProblem& problem, const PlacementOptions& options) {
  const auto candidates = CandidateLights::make(problem);
  if (!candidates) return tl::unexpected(candidates.error());
  std::vector<TreeCut> cuts = coarse_to_fine_cuts(*candidates, options.watch.stop);
  const std::size_t most = options.lights > 0 ? options.lights : options.max_lights;
  std::vector<std::pair<std::size_t, double>> tree;
  for (const TreeCut& cut : cuts) tree.emplace_back(cut.candidates.size(), cut.error);
  while (!cuts.empty() && cuts.back().candidates.size() > most) cuts.pop_back();
  LinCuts at(problem, options, *candidates);
  FoundLights found{PlacedLights(*problem.light, *problem.goal)};
  if (!cuts.empty()) {
    std::size_t cut = cuts.size() - 1;
    if (options.lights == 0)
      cut = fewest_worth_it({tree.begin(), tree.begin() + static_cast<std::ptrdiff_t>(cuts.size())}, options);
    found.lights = at.refined(cuts[cut]);
    if (options.lights == 0) {
      found.cuts.push_back(found.lights);
      while (++cut < cuts.size() && !at.ended() && found.lights.error() > options.number.wanted_error) {
        found.cuts.push_back(at.refined(cuts[cut]));
        if (found.cuts.back().error() > (1 - options.number.min_improvement) * found.lights.error()) break;
        found.lights = found.cuts.back();
      }
    }
  }
  found.columns = at.columns();
  found.tree = std::move(tree);
  return found;
}

}  // namespace luxrig
