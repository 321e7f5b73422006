#pragma once
/// Non-negative least squares, and its bounded kin:
///
///   min ‖W (A x − b)‖₂²   subject to   0 ≤ x ≤ upper
///
/// A may be rank-deficient or badly scaled, have zero, equal or nearly collinear columns, or none: solving never cycles
/// and never returns a NaN.
///
/// Source: active sets and their termination, Lawson & Hanson (1974), algorithm NNLS, and Stark & Parker (1995) for
/// bounds; products of columns instead of orthogonal factors, Bro & de Jong (1997); many columns entering and leaving
/// at a time, with a step along the projected Newton direction, Bertsekas (1982) and Kim, Sra & Dhillon (2010);
/// accuracy by corrected semi-normal equations, Björck (1987).

#include <Eigen/Core>
#include <memory>
#include <stop_token>
#include <vector>

#include "core/result.h"
#include "core/solve/least_squares/columns_view.h"

namespace luxrig {

struct NnlsProblem {
  ColumnsView columns;         ///< A
  Eigen::VectorXd goal;        ///< b, as many as A has rows
  Eigen::VectorXd row_weight;  ///< diagonal of W, ≥ 0; empty = 1
  Eigen::VectorXd upper;       ///< ≥ 0, may be +inf; empty = none

  /// Empty, or what is wrong: sizes, entries not finite or beyond 1e±140 (zero is allowed). Reads the matrix once.
  [[nodiscard]] std::string complaint() const;
};

/// How far from the optimum, in the problem scaled so that every column W a_j and the goal W b have norm 1: 1e-15 is
/// rounding.
struct KktResiduals {
  double stationarity = 0;     ///< largest |gradient| of columns between their bounds
  double gradient = 0;         ///< largest gradient by which a column at a bound wants into the interior
  double primal = 0;           ///< largest violation of a bound, or of a limit
  double complementarity = 0;  ///< largest multiplier times the room its bound or limit leaves

  [[nodiscard]] double worst() const;
  /// Takes account of one column: gradient is how fast half the squared error falls with z, 0 ≤ z ≤ upper.
  void add(double z, double upper, double gradient);
};

struct NnlsSolution {
  Eigen::VectorXd x;         ///< within its bounds exactly
  Eigen::VectorXd residual;  ///< b − A x
  double residual_norm = 0;  ///< ‖W (A x − b)‖₂; the objective is its square
  KktResiduals kkt;
  int iterations = 0;       ///< rounds in which columns entered
  bool converged = false;   ///< false: stopped
  bool orthogonal = false;  ///< the products of columns had too few digits, and orthogonal factors were used instead
};

struct NnlsOptions {
  /// Most columns to enter at a time; 0: as many as pay, 1: as Lawson & Hanson do.
  int most_entering = 0;
  std::stop_token stop;
};

/// Solves a problem, and changed ones from where the last ended: the set of columns in use and its factor are kept.
class NnlsSolver {
 public:
  /// The problem's matrix must outlive the solver. Cause::invalid with the problem's complaint.
  [[nodiscard]] static Result<NnlsSolver> make(const NnlsProblem& problem, const NnlsOptions& options = {});
  NnlsSolver(NnlsSolver&&) noexcept;
  NnlsSolver& operator=(NnlsSolver&&) noexcept;
  ~NnlsSolver();

  /// Asserted: as many as there are rows, finite, below 1e140.
  void set_goal(const Eigen::VectorXd& goal);
  /// May the column be used (at first: all)? One that may not has x = 0.
  void allow(Eigen::Index column, bool allowed);
  /// Starts the next solve from the columns that are positive here. Need not be near the answer.
  void start_from(const Eigen::VectorXd& x);

  [[nodiscard]] NnlsSolution solve();

 private:
  struct State;
  explicit NnlsSolver(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Once. Cause::invalid with the problem's complaint.
[[nodiscard]] Result<NnlsSolution> solve_nnls(const NnlsProblem& problem, const NnlsOptions& options = {});

/// The same for a dense matrix in any units that doubles can hold; asserted finite and of agreeing sizes.
struct NnlsResult {
  Eigen::VectorXd x;
  double residual_norm = 0;  ///< ‖A x − b‖₂
  double kkt_residual = 0;   ///< KktResiduals::worst()
  int iterations = 0;
  bool converged = false;
};
[[nodiscard]] NnlsResult solve_nnls(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

}  // namespace luxrig
