#pragma once
/// Non-negative least squares over a few columns chosen from very many, with one exchanged at a time. Annealing does
/// this thousands of times a second.
///
/// It keeps the products of the chosen columns, their Cholesky factor and the levels. An exchange computes the products
/// of one column with the others, updates the factor and continues from the present levels (Bro & de Jong 1997).

#include <memory>
#include <span>
#include <vector>

#include "core/solve/least_squares/nnls.h"
#include "core/solve/least_squares/scaled_columns.h"

namespace luxrig {

/// Data shared by all searches in one problem; made by one pass over the matrix. The matrix must outlive it.
class SharedProblem {
 public:
  explicit SharedProblem(const NnlsProblem& problem);
  [[nodiscard]] const ScaledColumns& scaled() const { return scaled_; }
  /// Product of column and goal, both of norm 1.
  [[nodiscard]] double pull(Eigen::Index column) const { return pull_[column]; }

 private:
  ScaledColumns scaled_;
  Eigen::VectorXd pull_;
};

/// Cause::invalid with the problem's complaint.
[[nodiscard]] Result<std::shared_ptr<const SharedProblem>> share_problem(const NnlsProblem& problem);

/// A copy is a state to return to; it costs one number per row and a few hundred more. Each thread needs its own.
class NnlsOfFew {
 public:
  using Index = Eigen::Index;

  explicit NnlsOfFew(std::shared_ptr<const SharedProblem> problem);

  /// The optimum over the chosen columns holds after each of these calls. A column may be chosen twice.
  void choose(std::span<const Index> columns);
  void exchange(std::size_t place, Index column);
  void add(Index column);
  void drop(std::size_t place);  ///< later places move up

  [[nodiscard]] std::span<const Index> columns() const { return column_; }
  [[nodiscard]] double level(std::size_t place) const;  ///< x
  [[nodiscard]] double residual_norm() const;           ///< ‖W (A x − b)‖₂
  [[nodiscard]] Eigen::VectorXd residual() const;       ///< b − A x
  /// Over the chosen columns, computed from the matrix.
  [[nodiscard]] KktResiduals kkt() const;

 private:
  [[nodiscard]] double& product(std::size_t a, std::size_t b) { return gram_[a * capacity_ + b]; }
  [[nodiscard]] double product(std::size_t a, std::size_t b) const { return gram_[a * capacity_ + b]; }
  [[nodiscard]] double upper(std::size_t place) const { return problem_->scaled().upper(column_[place]); }
  void reserve(std::size_t count);
  void append(Index column);
  void fill(std::size_t place);
  void optimise();
  bool search();
  bool take_up(std::size_t place);
  void let_go(std::size_t position);
  void to_least_error();
  void solve_factor();
  void renew_gradient();
  void solve_from_matrix();
  [[nodiscard]] Eigen::VectorXd scaled_residual() const;

  std::shared_ptr<const SharedProblem> problem_;
  std::vector<Index> column_;
  std::vector<double> z_, gradient_;
  std::vector<double> gram_, factor_;  ///< capacity² each; factor_ holds rows of L, in the order of passive_
  std::vector<std::size_t> passive_;   ///< places
  std::vector<char> is_passive_, refused_;
  std::vector<double> step_;
  std::vector<double> spread_;  ///< zeros, one per row
  std::size_t capacity_ = 0;
  double squared_error_ = 1;
  bool from_matrix_ = false;  ///< z_ was solved without the factor: the next search starts from scratch
};

}  // namespace luxrig
