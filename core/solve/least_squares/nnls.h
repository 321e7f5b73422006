#pragma once
/// Least squares with non-negative or bounded unknowns:
///
///   min ‖W (A x − b)‖₂²   subject to   0 ≤ x ≤ upper
///
/// A may be rank-deficient or badly scaled, and have zero, equal, nearly collinear or no columns. The solver never
/// cycles and never returns a NaN.
///
/// Sources:
///   active sets and their termination: Lawson & Hanson (1974), algorithm NNLS; with bounds, Stark & Parker (1995);
///   products of columns instead of orthogonal factors: Bro & de Jong (1997);
///   many columns entering and leaving at a time, with a step along the projected Newton direction: Bertsekas (1982)
///   and Kim, Sra & Dhillon (2010);
///   accuracy by corrected semi-normal equations: Björck (1987).

#include <Eigen/Core>
#include <memory>
#include <stop_token>
#include <vector>

#include "core/result.h"
#include "core/solve/least_squares/columns_view.h"

namespace luxrig {

struct NnlsProblem {
  ColumnsView columns;         ///< A
  Eigen::VectorXd goal;        ///< b, one per row of A
  Eigen::VectorXd row_weight;  ///< diagonal of W, ≥ 0; empty = 1
  Eigen::VectorXd upper;       ///< ≥ 0, may be +inf; empty = none

  /// Empty, or the error: sizes, entries not finite or beyond 1e±140 (zero is allowed). Reads the matrix once.
  [[nodiscard]] std::string complaint() const;
};

/// Distance from the optimum in the scaled problem, in which every column W a_j and the goal W b have norm 1. 1e-15 is
/// rounding.
struct KktResiduals {
  double stationarity = 0;     ///< largest |gradient| of columns between their bounds
  double gradient = 0;         ///< largest gradient that pulls a column away from its bound into the interior
  double primal = 0;           ///< largest violation of a bound or a limit
  double complementarity = 0;  ///< largest multiplier times the room at its bound or limit

  [[nodiscard]] double worst() const;
  /// Includes one column. gradient: rate at which half the squared error falls with z, 0 ≤ z ≤ upper.
  void add(double z, double upper, double gradient);
};

struct NnlsSolution {
  Eigen::VectorXd x;         ///< within its bounds exactly
  Eigen::VectorXd residual;  ///< b − A x
  double residual_norm = 0;  ///< ‖W (A x − b)‖₂; the objective is its square
  KktResiduals kkt;
  int iterations = 0;       ///< rounds in which columns entered
  bool converged = false;   ///< false = stopped
  bool orthogonal = false;  ///< products of columns lost too many digits, so orthogonal factors were used
};

struct NnlsOptions {
  /// Most columns to enter at a time; 0 = as many as pay off, 1 = as Lawson & Hanson.
  int max_entering = 0;
  std::stop_token stop;
};

/// Solves a problem, then changed versions of it from the last solution: it keeps the set of columns in use and its
/// factor.
class NnlsSolver {
 public:
  /// The problem's matrix must outlive the solver. Cause::invalid with the problem's complaint.
  [[nodiscard]] static Result<NnlsSolver> make(const NnlsProblem& problem, const NnlsOptions& options = {});
  NnlsSolver(NnlsSolver&&) noexcept;
  NnlsSolver& operator=(NnlsSolver&&) noexcept;
  ~NnlsSolver();

  /// Asserted: one per row, finite, below 1e140.
  void set_goal(const Eigen::VectorXd& goal);
  /// Whether the column may be used (initially all may). x = 0 for a column that may not.
  void allow(Eigen::Index column, bool allowed);
  /// Starts the next solve from the columns with positive x here. They need not be near the answer.
  void start_from(const Eigen::VectorXd& x);

  [[nodiscard]] NnlsSolution solve();

 private:
  struct State;
  explicit NnlsSolver(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Solves one problem. Cause::invalid with the problem's complaint.
[[nodiscard]] Result<NnlsSolution> solve_nnls(const NnlsProblem& problem, const NnlsOptions& options = {});

/// The same for a dense matrix in any units that doubles can hold; asserted finite and of matching sizes.
struct NnlsResult {
  Eigen::VectorXd x;
  double residual_norm = 0;  ///< ‖A x − b‖₂
  double kkt_residual = 0;   ///< KktResiduals::worst()
  int iterations = 0;
  bool converged = false;
};
[[nodiscard]] NnlsResult solve_nnls(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

}  // namespace luxrig
