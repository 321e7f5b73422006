#pragma once
/// The columns in use (the passive set, in the words of NNLS) with a factor of theirs, by which the unconstrained
/// problem over them is solved. Two ways, one interface. Internal to the NNLS family.

#include <memory>
#include <span>
#include <vector>

#include "core/solve/least_squares/scaled_columns.h"

namespace luxrig {

/// A column nearer than this to the span of the others cannot lower the error by more than rounding: it never enters,
/// so that the factor's condition stays bounded.
inline constexpr double kNearestToSpan = 1e-13;

class PassiveColumns {
 public:
  using Index = Eigen::Index;

  virtual ~PassiveColumns() = default;
  [[nodiscard]] const std::vector<Index>& order() const { return order_; }
  [[nodiscard]] Index size() const { return static_cast<Index>(order_.size()); }

  /// Takes up columns, in their order, and says which: not those in the span of the others. Of several at a time those
  /// near the span may be refused as well; ask for them again one at a time.
  virtual std::vector<char> append(std::span<const Index> columns) = 0;
  /// By place in order(), rising.
  virtual void remove(std::span<const Index> places) = 0;
  struct Step {
    Eigen::VectorXd d;  ///< argmin ‖W (A_P d − residual)‖, in order()
    double gain = 0;    ///< by how much the squared error falls
  };
  [[nodiscard]] virtual Step step(const Eigen::VectorXd& residual) const = 0;

 protected:
  void forget(std::span<const Index> places) {
    for (std::size_t k = places.size(); k-- > 0;) order_.erase(order_.begin() + places[k]);
  }
  std::vector<Index> order_;
};

/// Products of columns and their Cholesky factor: p²/2 numbers for p columns, rows do not count.
[[nodiscard]] std::unique_ptr<PassiveColumns> make_gram_columns(const ScaledColumns& problem);

/// Orthogonal basis of the columns and R: rows × p numbers, and twice the digits.
[[nodiscard]] std::unique_ptr<PassiveColumns> make_orthogonal_columns(const ScaledColumns& problem);

}  // namespace luxrig
