#include <algorithm>
#include <limits>

#include "core/solve/placement/methods/anneal_candidates.h"
#include "core/solve/placement/methods/baselines.h"
#include "core/solve/placement/methods/light_tree.h"
#include "core/solve/placement/methods/method_parts.h"
#include "core/solve/placement/methods/starts.h"

namespace luxrig {
namespace {

constexpr int kCutIterations = 1000;

class CutWalk {
 public:
  CutWalk(const PlacementProblem& problem, const PlacementOptions& options, const PlacementStart& start,
          const std::shared_ptr<const CandidateLights>& candidates)
      : problem_(problem), options_(options), start_(start), candidates_(candidates), random_(start.seed) {
    annealing_.iterations = options.iterations > 0 ? options.iterations : kCutIterations;
    annealing_.wanted_error = options.number.wanted_error;
    annealing_.stop = options.watch.stop;
    annealing_.better = reporter(start.better, columns_);
  }

  FoundLights at(const std::vector<TreeCut>& cuts, std::size_t lights) {
    ChosenCandidates state(candidates_);
    for (const TreeCut& cut : cuts)
      if (cut.candidates.size() <= lights) state.choose(cut.candidates);
    pursue(state, lights, options_.number.wanted_error, options_.watch.stop);
    return refined(anneal(std::move(state), annealing_, random_), {});
  }

  FoundLights down(const std::vector<TreeCut>& cuts) {
    ChosenCandidates chosen(candidates_);
    std::vector<PlacedLights> looked_at;
    std::size_t within = 0;
    while (within < cuts.size() && cuts[within].candidates.size() <= options_.max_lights) ++within;
    for (std::size_t i = first_cut(cuts, within); i < within; ++i) {
      ChosenCandidates state(candidates_);
      state.choose(cuts[i].candidates);
      state = anneal(std::move(state), annealing_, random_);
      const double was = chosen.error();
      looked_at.push_back(state.placed(columns_));
      if (chosen.size() > 0 && !(state.error() <= (1 - options_.number.min_improvement) * was)) break;
      chosen = std::move(state);
      if (chosen.error() <= options_.number.wanted_error || options_.watch.stop.stop_requested()) break;
    }
    return refined(chosen, std::move(looked_at));
  }

 private:
  /// The first cut below ε_opt. If the goal is too hard for that, the first that is nearly as good as any.
  [[nodiscard]] std::size_t first_cut(const std::vector<TreeCut>& cuts, std::size_t within) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < within; ++i) least = std::min(least, cuts[i].error);
    const double enough = std::max(options_.number.coarse_error, (1 + options_.number.min_improvement) * least);
    std::size_t first = 0;
    while (first < within && cuts[first].error > enough) ++first;
    return first;
  }
  FoundLights refined(const ChosenCandidates& chosen, std::vector<PlacedLights> looked_at) {
    FoundLights found{chosen.placed(columns_)};
    columns_ +=
        refine_by_simplex(found.lights, simplex_of(problem_, options_, start_.max_columns, columns_, start_.better));
    found.columns = columns_;
    found.cuts = std::move(looked_at);
    return found;
  }

  const PlacementProblem& problem_;
  const PlacementOptions& options_;
  const PlacementStart& start_;
  const std::shared_ptr<const CandidateLights>& candidates_;
  std::mt19937_64 random_;
  AnnealOptions annealing_;
  std::size_t columns_ = 0;
};

}  // namespace

Result<FoundLights> place_by_gp16(const PlacementProblem& problem, const PlacementOptions& options) {
  const auto candidates = CandidateLights::make(problem);
  if (!candidates) return tl::unexpected(candidates.error());
  const std::vector<TreeCut> cuts = light_tree_cuts(*candidates, options.watch.stop);
  FoundLights found = best_of_starts(options, [&](const PlacementStart& start) {
    CutWalk walk(problem, options, start, *candidates);
    return options.lights > 0 ? walk.at(cuts, options.lights) : walk.down(cuts);
  });
  for (const TreeCut& cut : cuts) found.tree.emplace_back(cut.candidates.size(), cut.error);
  return found;
}

}  // namespace luxrig
