#pragma once
/// One step of the primal active-set method: to the minimum over the unknowns that are free, on the rows that are held.
/// Two ways, one interface. Internal to limited_least_squares.

#include <memory>

#include "core/solve/limited_least_squares.h"

namespace luxrig {

[[nodiscard]] std::vector<Eigen::Index> free_variables(const std::vector<BoundState>& state);

class FreeStep {
 public:
  virtual ~FreeStep() = default;
  /// Half the gradient of the objective.
  [[nodiscard]] virtual Eigen::VectorXd gradient(const Eigen::VectorXd& z) const = 0;
  /// Of the working rows, in their order, where the last direction has led.
  [[nodiscard]] virtual Eigen::VectorXd multipliers(const LimitedLeastSquaresResult& at,
                                                    const Eigen::VectorXd& gradient) const = 0;
  /// The step, 0 in what is not free. Takes rows that follow from the others out of at.working_rows.
  virtual Eigen::VectorXd direction(LimitedLeastSquaresResult& at, const std::vector<Eigen::Index>& free) = 0;
  /// A constraint whose rate along a step of length 1 is below this does not block it.
  [[nodiscard]] virtual double rate_tolerance() const = 0;
};

/// Null space by QR of the rows, least squares by QR of what is left: a cube of the free unknowns each step.
[[nodiscard]] std::unique_ptr<FreeStep> make_orthogonal_step(const LimitedLeastSquares& problem);

/// EᵀE + tie² I and Eᵀf + tie² near.
struct ColumnProducts {
  Eigen::MatrixXd columns;
  Eigen::VectorXd goal;
};
[[nodiscard]] ColumnProducts column_products(const LimitedLeastSquares& problem);

/// Products of the columns and their Cholesky factor, which follows the set of free unknowns; what products lose of the
/// digits, refinement with the columns themselves restores. problem.tie must be > 0.
[[nodiscard]] std::unique_ptr<FreeStep> make_gram_step(const LimitedLeastSquares& problem,
                                                       const ColumnProducts& products);

}  // namespace luxrig
