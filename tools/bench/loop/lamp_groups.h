#pragma once
/// Which lamps to light together, one step after the other, so that luxmeters tell each lamp's light best for the
/// goals.
///
/// With noise in proportion to the reading, a meter learns less of a lamp the more other light it sees: n lamps coded
/// together (Hadamard) are √n worse than one at a time on that meter, and better only where noise does not depend on
/// light. But lamps that different meters see can be lit together at no loss, which saves steps. So the steps are
/// chosen from what is expected: A-optimal for the error at the goals, by exchange of single lamps in single steps, from
/// the best of one lamp at a time, Hadamard's and a packing by meters. The choice is never worse than any of these.
///
///   reading_m = Σ_j lit_j · lux_mj · (1 + x_j) + noise      x_j: prior 0 ± log_sd_j
///
/// Source: V. V. Fedorov, Theory of Optimal Experiments (1972), ch. 3; M. Harwit, N. J. A. Sloane, Hadamard Transform
/// Optics (1979), ch. 3.

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace luxrig {

/// Per step, the lamps that are lit.
using LampDesign = std::vector<std::vector<std::size_t>>;

struct LampDesignProblem {
  Eigen::MatrixXd lux;       ///< luxmeters × lamps: expected light at the levels of the steps
  Eigen::VectorXd log_sd;    ///< per lamp: how well it is known before, > 0
  double noise_share = 0;    ///< of a reading: standard error as a share of it
  double noise_lx = 0;       ///< and beside that, > 0
  double rest_share = 0;     ///< of each lamp's light at a meter: what its x does not explain there
  Eigen::MatrixXd goals;     ///< goals × lamps: each lamp's share of the light there
  Eigen::MatrixXd of_limit;  ///< limited points × lamps: share of the limit; a step's sum stays within 1. May be empty
};

/// Σ over the goals of the variance of their light, as shares, after these steps. +inf if a step exceeds a limit.
[[nodiscard]] double error_after(const LampDesignProblem& problem, const LampDesign& design);

/// Step k lights lamp k, and from the first again.
[[nodiscard]] LampDesign one_at_a_time(std::size_t lamps, std::size_t steps);
/// Rows of the S-matrix of Sylvester's Hadamard matrix, from the first again: about half of the lamps in each.
[[nodiscard]] LampDesign hadamard_steps(std::size_t lamps, std::size_t steps);
/// Every lamp once, in as few steps as there are: lamps that go together are seen mostly by different meters, and no
/// more than `shared` of a lamp's light at its own meter is others'. From the first again up to `steps`; the last ones
/// are left out if there are more.
[[nodiscard]] LampDesign packed_by_meters(const LampDesignProblem& problem, std::size_t steps, double shared = 0.25);

/// The best design found with so many steps.
[[nodiscard]] LampDesign best_design(const LampDesignProblem& problem, std::size_t steps);

}  // namespace luxrig
