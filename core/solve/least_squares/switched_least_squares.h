#pragma once
/// min ‖E z − f‖₂ subject to 0 ≤ z ≤ upper and G z ≤ slack, where some unknowns are 0 or `upper` and nothing between:
/// lamps on relays. Branch and bound: each node is the same problem with some of them set and the others free to dim,
/// whose minimum bounds all that lies below it (A. Land, A. Doig, 1960).

#include <vector>

#include "core/solve/least_squares/limited_least_squares.h"

namespace luxrig {

struct SwitchedSettings {
  std::vector<bool> on;     ///< per unknown; false for those that are not switched
  bool proven = false;      ///< no other setting is better; false: the search ended at most_nodes
  bool stopped = false;     ///< on request: `on` is the best so far
  int nodes = 0;            ///< problems solved
  Eigen::VectorXd relaxed;  ///< z, could all of them dim
};

/// switched: those unknowns, each with a finite upper. All off is within the limits, so there is always an answer.
[[nodiscard]] SwitchedSettings solve_switched_least_squares(const LimitedLeastSquares& problem,
                                                            const std::vector<Eigen::Index>& switched,
                                                            const std::stop_token& stop, int most_nodes = 5'000);

/// What is left of the problem when these are on and no longer unknown (their upper is 0). slack may be < 0: then they
/// alone are above a limit.
[[nodiscard]] LimitedLeastSquares with_set(const LimitedLeastSquares& problem,
                                           const std::vector<Eigen::Index>& switched, const std::vector<bool>& on);

}  // namespace luxrig
