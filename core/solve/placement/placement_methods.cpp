#include "core/solve/placement/placement_methods.h"

#include <algorithm>

#include "core/parallel.h"
#include "core/solve/placement/methods/anneal_candidates.h"
#include "core/solve/placement/methods/baselines.h"
#include "core/solve/placement/place_lights.h"
#include "core/solve/placement/search/choose_lights.h"

namespace luxrig {
namespace {

std::function<void(const PlacedLights&, std::size_t)> passed_on(const PlacementOptions& options) {
  if (!options.better) return {};
  return [&options](const PlacedLights& best, std::size_t columns) {
    options.better({best.error(), best.poses(), best.levels(), columns});
  };
}

/// Mutations of one initial annealing, and the number of annealings, of which the best counts: two, as that many cores
/// are common.
constexpr int kStartIterations = 200'000;
constexpr std::size_t kStartAnnealings = 2;

/// Candidates added one by one, then annealed by random mutations. The problem and options must outlive it.
OtherStart annealed_candidates(const PlacementProblem& problem, const PlacementOptions& options) {
  return [&problem, &options, candidates = std::shared_ptr<const CandidateLights>()](std::size_t lights,
                                                                                     std::uint64_t seed) mutable {
    if (!candidates) {
      const auto made = CandidateLights::make(problem);
      if (!made) return std::vector<LightPose>();
      candidates = *made;
    }
    ChosenCandidates first(candidates);
    pursue(first, lights, options.number.wanted_error, options.watch.stop);
    AnnealOptions annealing;
    annealing.nearest = 0;
    annealing.iterations = kStartIterations;
    annealing.wanted_error = options.number.wanted_error;
    annealing.stop = options.watch.stop;
    std::vector<ChosenCandidates> annealed(kStartAnnealings, first);
    parallel_for(annealed.size(), options.threads, [&](std::size_t i) {
      std::mt19937_64 random(seed * kStartAnnealings + i);
      annealed[i] = anneal(std::move(annealed[i]), annealing, random);
    });
    return std::min_element(annealed.begin(), annealed.end(),
                            [](const auto& a, const auto& b) { return a.error() < b.error(); })
        ->poses();
  };
}

Result<FoundLights> place_by_luxrig(const PlacementProblem& problem, const PlacementOptions& options) {
  if (const std::string text = problem.complaint(); !text.empty()) return refusal(text);
  const ComplementSearch candidates(problem.columns, problem.poses, *problem.goal);
  ExchangeOptions exchange =
      problem.spacing_m > 0 ? ExchangeOptions::for_spacing(problem.spacing_m) : ExchangeOptions{};
  exchange.run() = options.of_part();
  if (options.lights > 0) {
    PlaceOptions place;
    place.lights = options.lights;
    place.wanted_error = options.number.wanted_error;
    place.max_columns = options.max_columns;
    place.seed = options.seed;
    place.start = options.start;
    place.other = annealed_candidates(problem, options);
    place.exchange = exchange;
    place.better = passed_on(options);
    Placement got = place_lights(*problem.light, *problem.goal, candidates, place);
    return FoundLights{std::move(got.lights), got.columns};
  }
  ChooseOptions choose;
  choose.max_lights = options.max_lights;
  choose.number = options.number;
  choose.max_columns = options.max_columns;
  choose.seed = options.seed;
  choose.start = options.start;
  choose.other = annealed_candidates(problem, options);
  choose.whole_curve = options.whole_curve;
  choose.exchange = exchange;
  choose.better = passed_on(options);
  LightCurve got = choose_lights(*problem.light, *problem.goal, candidates, choose);
  FoundLights found{got.cuts[got.chosen], got.columns};
  found.cuts = std::move(got.cuts);
  return found;
}

constexpr PlacementMethod kMethods[] = {
    {"luxrig", "one by one, all refined by least squares, exchanged", true, true, place_by_luxrig},
    {"gpk15", "Gkaravelis, Papaioannou & Kalampokis 2015: annealing by complements", true, false, place_by_gpk15},
    {"gp16", "Gkaravelis & Papaioannou 2016: light tree, annealed cuts", true, true, place_by_gp16},
};

}  // namespace

std::span<const PlacementMethod> placement_methods() { return kMethods; }

const PlacementMethod* find_placement_method(std::string_view name) {
  for (const PlacementMethod& method : kMethods)
    if (name == method.name) return &method;
  return nullptr;
}

}  // namespace luxrig
