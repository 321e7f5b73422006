#pragma once
/// Lin et al. 2013, up to the cut (thesis §4.4.3): finds a few candidates to start from, coarse to fine, and joins
/// them.
///
/// A light in the middle of every cell of a coarse grid, with optimal levels. Lights that contribute less than 5 % of
/// the strongest are removed; the cells of the others are split in eight, and so on down to the candidates' spacing.
/// Then lights are joined in pairs: the pair that one of the two can replace with the least change against the goal.
/// The method is known here from the thesis, which states neither the first grid (here about eight cells along the
/// longest side), nor the base of the 5 %, nor which light replaces two.

#include "core/solve/placement/methods/light_tree.h"

namespace luxrig {

/// As light_tree_cuts().
[[nodiscard]] std::vector<TreeCut> coarse_to_fine_cuts(const std::shared_ptr<const CandidateLights>& candidates,
                                                       const std::stop_token& stop);

}  // namespace luxrig
