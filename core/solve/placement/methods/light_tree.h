#pragma once
/// The light tree of GP16 (thesis §5.5.2–5.5.3): which lights to join when there are too many.
///
/// Non-negative least squares over all candidates gives the leaves. The two lights whose normalised columns are nearest
/// to each other are taken out, the levels of the others made the best, and the candidate most like what is then left
/// over put in their place: any of all candidates. And so on until one light is left; every state on the way is a cut.

#include "core/solve/placement/methods/chosen_candidates.h"

namespace luxrig {

struct TreeCut {
  std::vector<std::size_t> candidates;
  double error = 1;  ///< with the best levels
};

/// Fewest lights first, none twice of one number. Leaves that do less than a thousandth of the goal are left out. When
/// stopped, what was built so far; none when no candidate helps.
[[nodiscard]] std::vector<TreeCut> light_tree_cuts(const std::shared_ptr<const CandidateLights>& candidates,
                                                   const std::stop_token& stop);

}  // namespace luxrig
