#pragma once
/// The light tree of GP16 (thesis §5.5.2–5.5.3): decides which lights to join when there are too many.
///
/// Non-negative least squares over all candidates gives the leaves. The two lights with the nearest normalised columns
/// are removed, the levels of the others optimised, and the candidate (of all) most similar to the residual put in
/// their place. This repeats until one light is left; every state on the way is a cut.

#include "core/solve/placement/methods/chosen_candidates.h"

namespace luxrig {

struct TreeCut {
  std::vector<std::size_t> candidates;
  double error = 1;  ///< with the best levels
};

/// Fewest lights first, one cut per number. Leaves that contribute less than a thousandth of the goal are left out.
/// When stopped, the cuts built so far; empty when no candidate helps.
[[nodiscard]] std::vector<TreeCut> light_tree_cuts(const std::shared_ptr<const CandidateLights>& candidates,
                                                   const std::stop_token& stop);

}  // namespace luxrig
