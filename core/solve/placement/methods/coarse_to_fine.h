#pragma once
/// Lin et al. 2013, up to the cut (thesis §4.4.3): which few of the candidates to begin from, coarse to fine, and how
/// to join them.
///
/// A light in the middle of every cell of a coarse grid, with the best levels; those that do less than 5 % of what the
/// strongest does are removed; the cells of the others are split in eight, and so on down to the candidates' spacing.
/// Then two lights at a time are joined: those which one of the two can stand for with the least difference to the
/// goal. The thesis, which the method is known from, says neither the first grid (here about eight cells along the
/// longest side) nor what 5 % is a share of, nor what stands for two lights.

#include "core/solve/placement/methods/light_tree.h"

namespace luxrig {

/// As light_tree_cuts().
[[nodiscard]] std::vector<TreeCut> coarse_to_fine_cuts(const std::shared_ptr<const CandidateLights>& candidates,
                                                       const std::stop_token& stop);

}  // namespace luxrig
