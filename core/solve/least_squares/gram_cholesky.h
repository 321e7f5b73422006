#pragma once
/// L Lᵀ = G, the Gram matrix of a changing set of columns of norm 1. Columns come singly or in blocks and leave from
/// any place; G is never formed again (Gill, Golub, Murray & Saunders 1974).

#include <Eigen/Core>
#include <span>
#include <vector>

namespace luxrig {

class GramCholesky {
 public:
  using Index = Eigen::Index;

  [[nodiscard]] Index size() const { return size_; }
  void clear() { size_ = 0; }

  /// Appends, in order, those of K columns whose squared distance from the span of all earlier ones is at least
  /// min_pivot. Returns which were appended.
  /// cross   size() × K: products of the present columns with the new ones; overwritten
  /// own     K × K: products of the new columns with one another; its lower half is overwritten
  std::vector<char> append(Eigen::MatrixXd& cross, Eigen::MatrixXd& own, double min_pivot);

  /// Appends one column whose row of L was computed more accurately than from products (passive_columns.h).
  void append_row(const Eigen::VectorXd& row, double pivot);

  /// Removes the columns at these places (rising).
  void remove(std::span<const Index> places);

  /// vector = L⁻¹ vector, and L⁻ᵀ vector: together G⁻¹ vector.
  void forward(Eigen::VectorXd& vector) const;
  void backward(Eigen::VectorXd& vector) const;

 private:
  void reserve(Index size);
  void remove_by_rotation(Index place);
  bool remove_by_factoring(std::span<const Index> places);

  Eigen::MatrixXd l_;  ///< lower, the top left size_ × size_
  Index size_ = 0;
};

}  // namespace luxrig
