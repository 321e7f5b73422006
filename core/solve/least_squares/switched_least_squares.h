#pragma once
/// min ‖E z − f‖₂ subject to 0 ≤ z ≤ upper and G z ≤ slack, where some unknowns are either 0 or `upper`: lamps on
/// relays. Branch and bound: each node is the same problem with some of them set and the others free to dim. Its
/// minimum bounds all nodes below it (A. Land, A. Doig, 1960).

#include <vector>

#include "core/solve/least_squares/limited_least_squares.h"

namespace luxrig {

struct SwitchedSettings {
  std::vector<bool> on;     ///< per unknown; false for unknowns that are not switched
  bool proven = false;      ///< no other setting is better; false = the search ended at max_nodes
  bool stopped = false;     ///< on request; `on` is the best so far
  int nodes = 0;            ///< problems solved
  Eigen::VectorXd relaxed;  ///< z, if all of them could dim
};

/// switched: indices of the switched unknowns, each with a finite upper. All off keeps the limits, so there is always
/// an answer.
[[nodiscard]] SwitchedSettings solve_switched_least_squares(const LimitedLeastSquares& problem,
                                                            const std::vector<Eigen::Index>& switched,
                                                            const std::stop_token& stop, int max_nodes = 5'000);

/// The problem that remains when these are on and no longer unknown (their upper is 0). slack < 0 means that they alone
/// exceed a limit.
[[nodiscard]] LimitedLeastSquares with_set(const LimitedLeastSquares& problem,
                                           const std::vector<Eigen::Index>& switched, const std::vector<bool>& on);

}  // namespace luxrig
