#pragma once
/// Simulated annealing over which candidates hold the lights (thesis §5.4.3, §5.5.4).
///
/// A light drawn at random is taken out, and one of the `nearest` candidates to what is then left over, drawn, put in
/// its place; levels are the best ones throughout. What is worse is taken with probability exp(−Δ/T), and the mutation
/// after that puts the light at any candidate. The thesis states neither temperature nor schedule: here T falls
/// geometrically from `hottest` to `coldest`, as shares of the best error so far.

#include "core/solve/placement/methods/chosen_candidates.h"

namespace luxrig {

struct AnnealOptions {
  int iterations = 1000;
  std::size_t nearest = 12;  ///< 0: any candidate, always
  double hottest = 0.1, coldest = 1e-3;
  double wanted_error = 1e-4;  ///< at which it ends
  std::stop_token stop;
  std::function<void(const ChosenCandidates&)> better;  ///< called with each that is better than all before
};

/// Never worse than the start. At least one light, unless no candidate is lit.
[[nodiscard]] ChosenCandidates anneal(ChosenCandidates start, const AnnealOptions& options, std::mt19937_64& random);

}  // namespace luxrig
