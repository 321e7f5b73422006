#pragma once
/// Simulated annealing over the choice of candidates (thesis §5.4.3, §5.5.4).
///
/// A random light is removed and replaced by a random one of the `nearest` candidates to the residual; levels are
/// always optimal. A worse state is accepted with probability exp(−Δ/T); the next mutation then puts the light at any
/// candidate. The thesis states neither temperature nor schedule: here T falls geometrically from `hottest` to
/// `coldest`, as shares of the best error so far.

#include "core/solve/placement/methods/chosen_candidates.h"

namespace luxrig {

struct AnnealOptions {
  int iterations = 1000;
  std::size_t nearest = 12;  ///< 0 = always any candidate
  double hottest = 0.1, coldest = 1e-3;
  double wanted_error = 1e-4;  ///< ends the search
  std::stop_token stop;
  std::function<void(const ChosenCandidates&)> better;  ///< called with each state better than all before
};

/// Never worse than the start. Needs at least one light, unless no candidate is lit.
[[nodiscard]] ChosenCandidates anneal(ChosenCandidates start, const AnnealOptions& options, std::mt19937_64& random);

}  // namespace luxrig
