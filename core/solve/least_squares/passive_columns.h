#pragma once
/// The columns in use (in NNLS terms, the passive set) with a factor that solves the unconstrained problem over them.
/// Two implementations of one interface. Internal to the NNLS family.

#include <memory>
#include <span>
#include <vector>

#include "core/solve/least_squares/scaled_columns.h"

namespace luxrig {

/// A column nearer than this to the span of the others can lower the error only by rounding. It never enters, which
/// bounds the factor's condition.
inline constexpr double kNearestToSpan = 1e-13;

class PassiveColumns {
 public:
  using Index = Eigen::Index;

  virtual ~PassiveColumns() = default;
  [[nodiscard]] const std::vector<Index>& order() const { return order_; }
  [[nodiscard]] Index size() const { return static_cast<Index>(order_.size()); }

  /// Appends columns in order and returns which: columns in the span of the others are refused. If several come at
  /// once, columns near the span may also be refused; try these again one at a time.
  virtual std::vector<char> append(std::span<const Index> columns) = 0;
  /// By place in order(), rising.
  virtual void remove(std::span<const Index> places) = 0;
  struct Step {
    Eigen::VectorXd d;  ///< argmin ‖W (A_P d − residual)‖, in order()
    double gain = 0;    ///< fall of the squared error
  };
  [[nodiscard]] virtual Step step(const Eigen::VectorXd& residual) const = 0;

 protected:
  void forget(std::span<const Index> places) {
    for (std::size_t k = places.size(); k-- > 0;) order_.erase(order_.begin() + places[k]);
  }
  std::vector<Index> order_;
};

/// Products of columns and their Cholesky factor: p²/2 numbers for p columns, whatever the number of rows.
[[nodiscard]] std::unique_ptr<PassiveColumns> make_gram_columns(const ScaledColumns& problem);

/// Orthogonal basis of the columns, and R: rows × p numbers, and twice as many accurate digits.
[[nodiscard]] std::unique_ptr<PassiveColumns> make_orthogonal_columns(const ScaledColumns& problem);

}  // namespace luxrig
