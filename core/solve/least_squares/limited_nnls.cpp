#include "core/solve/least_squares/limited_nnls.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/check.h"
#include "core/solve/least_squares/scaled_columns.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kNoBound = std::numeric_limits<double>::infinity();
/// Violations and changes of multipliers below this (rows and goal have norm 1) are rounding.
constexpr double kTolerance = 1e-14;
constexpr int kMaxRounds = 200;
/// Weight of limits against the goal. A heavy weight finds the multipliers in few rounds but costs the goal digits, so
/// the last rounds use a light one.
constexpr double kFirstWeight = 100, kLightWeight = 1;

/// Sparse columns built one after the other.
struct BuiltColumns {
  std::vector<std::uint64_t> begin = {0};
  std::vector<std::uint32_t> row;
  std::vector<double> value;

  void put(Index at, double what) {
    if (what == 0) return;
    row.push_back(static_cast<std::uint32_t>(at));
    value.push_back(what);
  }
  void end_column() { begin.push_back(row.size()); }
  [[nodiscard]] ColumnsView view(Index rows) const { return {rows, begin, row, std::span<const double>(value)}; }
};

/// The limits in z: rows scaled to about 1, without limits of 0 (upper_within) and infinite ones.
struct ScaledLimits {
  Eigen::SparseMatrix<double> rows;  ///< kept limits × columns
  VectorXd most;
  std::vector<Index> which;    ///< of the given limits
  std::vector<double> factor;  ///< by which each row was multiplied
  std::vector<double> z_per_x, upper;
  double scale = 1;  ///< x = scale z / z_per_x
};

/// Bounds of the columns: 0 where a limit of 0 allows no light. As a limit it would leave no interior.
VectorXd upper_within(const NnlsProblem& problem, const LinearLimits& limits) {
  VectorXd upper = problem.upper;
  if (upper.size() == 0) upper = VectorXd::Constant(problem.columns.columns(), kNoBound);
  for (Index j = 0; j < limits.rows.outerSize(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(limits.rows, j); it; ++it)
      if (limits.most[it.row()] == 0 && it.value() > 0) upper[j] = 0;
  return upper;
}

ScaledLimits scaled_limits(const ScaledColumns& p, const VectorXd& bound, const LinearLimits& limits) {
  ScaledLimits s;
  const Index n = p.columns();
  VectorXd squares = VectorXd::Zero(limits.rows.rows());
  for (Index j = 0; j < n; ++j) {
    double norm = 0;
    if (p.inverse_norm(j) > 0) norm = 1 / p.inverse_norm(j);
    if (norm == 0) {  // no light at any point with weight: its own entries in the limits set the unit
      double largest = 0;
      for (Eigen::SparseMatrix<double>::InnerIterator it(limits.rows, j); it; ++it)
        largest = std::max(largest, std::abs(it.value()));
      norm = largest > 0 ? largest : 1;
    }
    s.z_per_x.push_back(norm);
    // A column matters only up to its largest contribution: a bound may hold it far below the goal.
    const double most = p.nothing_wanted() ? 1 : std::min(1.0, bound[j] * (norm / p.in_units(1)));
    for (Eigen::SparseMatrix<double>::InnerIterator it(limits.rows, j); it; ++it)
      squares[it.row()] += std::pow(it.value() / norm * most, 2);
  }
  std::vector<Index> place(static_cast<std::size_t>(limits.rows.rows()), -1);
  for (Index i = 0; i < limits.rows.rows(); ++i) {
    if (limits.most[i] == kNoBound || limits.most[i] == 0) continue;
    place[static_cast<std::size_t>(i)] = static_cast<Index>(s.which.size());
    s.which.push_back(i);
    s.factor.push_back(squares[i] > 0 ? 1 / std::sqrt(squares[i]) : 1);
  }
  s.scale = p.nothing_wanted() ? 0 : p.in_units(1);
  if (s.scale == 0)
    for (std::size_t k = 0; k < s.which.size(); ++k)
      s.scale = std::max(s.scale, std::abs(limits.most[s.which[k]] * s.factor[k]));
  if (s.scale == 0) s.scale = 1;
  const auto kept = static_cast<Index>(s.which.size());
  s.most.resize(kept);
  for (Index k = 0; k < kept; ++k)
    s.most[k] = limits.most[s.which[static_cast<std::size_t>(k)]] * s.factor[static_cast<std::size_t>(k)] / s.scale;
  std::vector<Eigen::Triplet<double>> entries;
  for (Index j = 0; j < n; ++j) {
    const double norm = s.z_per_x[static_cast<std::size_t>(j)];
    s.upper.push_back(bound[j] * (norm / s.scale));
    for (Eigen::SparseMatrix<double>::InnerIterator it(limits.rows, j); it; ++it) {
      const Index k = place[static_cast<std::size_t>(it.row())];
      if (k >= 0) entries.emplace_back(k, j, it.value() / norm * s.factor[static_cast<std::size_t>(k)]);
    }
  }
  s.rows.resize(kept, n);
  s.rows.setFromTriplets(entries.begin(), entries.end());
  return s;
}

/// [A; √ρ C] with a column for each slack.
BuiltColumns stacked(const ScaledColumns& p, const ScaledLimits& s, double rho) {
  BuiltColumns built;
  const double root = std::sqrt(rho);
  VectorXd column = VectorXd::Zero(p.rows());
  for (Index j = 0; j < s.rows.cols(); ++j) {
    if (p.inverse_norm(j) > 0) {
      column.setZero();
      p.view().add(j, p.inverse_norm(j), column.data());
      for (Index i = 0; i < p.rows(); ++i)
        built.put(i, column[i] * (p.unweighted() ? 1 : std::sqrt(p.squared_weight()[i])));
    }
    for (Eigen::SparseMatrix<double>::InnerIterator it(s.rows, j); it; ++it)
      built.put(p.rows() + it.row(), root * it.value());
    built.end_column();
  }
  for (Index k = 0; k < s.rows.rows(); ++k) {
    built.put(p.rows() + k, root);
    built.end_column();
  }
  return built;
}

class Multipliers {
 public:
  Multipliers(const ScaledColumns& problem, const ScaledLimits& limits) : p_(problem), s_(limits) {
    lambda_ = VectorXd::Zero(s_.rows.rows());
    goal_ = VectorXd::Zero(p_.rows());
    if (!p_.nothing_wanted()) goal_ = p_.goal().cwiseProduct(p_.squared_weight().cwiseSqrt());
  }

  void run(const NnlsOptions& options) {
    options_.stop = options.stop;
    renew(kFirstWeight, VectorXd());
    double before = kNoBound;
    for (; rounds < kMaxRounds; ++rounds) {
      solver_->set_goal(stacked_goal());
      const NnlsSolution inner = solver_->solve();
      iterations += inner.iterations;
      orthogonal = orthogonal || inner.orthogonal;
      if (!inner.converged || options.stop.stop_requested()) return;
      z = inner.x.head(s_.rows.cols());
      const VectorXd over = s_.rows * z - s_.most;
      const VectorXd next = (lambda_ + rho_ * over).cwiseMax(0.0);
      const double change = (next - lambda_).size() == 0 ? 0 : (next - lambda_).cwiseAbs().maxCoeff() / rho_;
      lambda_ = next;
      const bool near_enough = change <= kTolerance * (1 + largest_most());
      if (converged) {  // with the light weight: as long as it pays off
        if (near_enough || change > 0.9 * before) return;
        before = change;
        continue;
      }
      if (near_enough || (change > 0.9 * before && change < 1e-12)) {  // as near as doubles get
        converged = true;
        if (rounds + 1 == kMaxRounds || s_.most.size() == 0) return;
        renew(kLightWeight, inner.x);
        before = kNoBound;
        continue;
      }
      // Far from linear convergence at a good rate: increase the weight of limits. Not near the end, where rounding
      // dominates.
      if (change > 0.25 * before && rho_ < 1e5 && change > 1e-12) {
        renew(rho_ * 10, inner.x);
        before = kNoBound;
      } else {
        before = change;
      }
    }
  }

  VectorXd z;
  int rounds = 0, iterations = 0;
  bool converged = false, orthogonal = false;
  [[nodiscard]] const VectorXd& lambda() const { return lambda_; }

 private:
  [[nodiscard]] double largest_most() const { return s_.most.size() == 0 ? 0 : s_.most.cwiseAbs().maxCoeff(); }

  [[nodiscard]] VectorXd stacked_goal() const {
    VectorXd goal(p_.rows() + s_.most.size());
    goal << goal_, std::sqrt(rho_) * (s_.most - lambda_ / rho_);
    return goal;
  }

  void renew(double rho, const VectorXd& start) {
    rho_ = rho;
    solver_.reset();
    columns_ = stacked(p_, s_, rho);
    NnlsProblem problem;
    problem.goal = stacked_goal();
    problem.columns = columns_.view(problem.goal.size());
    problem.upper = VectorXd::Constant(problem.columns.columns(), kNoBound);
    for (std::size_t j = 0; j < s_.upper.size(); ++j) problem.upper[static_cast<Index>(j)] = s_.upper[j];
    auto made = NnlsSolver::make(problem, options_);
    LUXRIG_CHECK(made.has_value(), "{}", made.has_value() ? "" : made.error().detail);
    solver_.emplace(std::move(*made));
    if (start.size() > 0) solver_->start_from(start);
  }

  const ScaledColumns& p_;
  const ScaledLimits& s_;
  NnlsOptions options_;
  double rho_ = 1;
  VectorXd lambda_, goal_;
  BuiltColumns columns_;
  std::optional<NnlsSolver> solver_;
};

KktResiduals kkt_of(const ScaledColumns& p, const ScaledLimits& s, const VectorXd& z, const VectorXd& lambda) {
  VectorXd residual = p.nothing_wanted() ? VectorXd::Zero(p.rows()) : p.goal();
  for (Index j = 0; j < p.columns(); ++j)
    if (z[j] != 0 && p.inverse_norm(j) > 0) p.view().add(j, -z[j] * p.inverse_norm(j), residual.data());
  VectorXd gradient;
  p.gradient(residual, gradient);
  const VectorXd pull = gradient - s.rows.transpose() * lambda;
  KktResiduals kkt;
  for (Index j = 0; j < z.size(); ++j) kkt.add(z[j], s.upper[static_cast<std::size_t>(j)], pull[j]);
  const VectorXd over = s.rows * z - s.most;
  for (Index k = 0; k < over.size(); ++k) {
    kkt.primal = std::max(kkt.primal, over[k]);
    kkt.complementarity = std::max(kkt.complementarity, std::abs(lambda[k] * over[k]));
  }
  return kkt;
}

std::string limits_complaint(const NnlsProblem& problem, const LinearLimits& limits) {
  if (limits.rows.cols() != problem.columns.columns())
    return fmt::format("limits on {} columns of {}", limits.rows.cols(), problem.columns.columns());
  if (limits.rows.rows() != limits.most.size())
    return fmt::format("{} limits, {} right-hand sides", limits.rows.rows(), limits.most.size());
  for (Index j = 0; j < limits.rows.outerSize(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(limits.rows, j); it; ++it)
      if (!(it.value() >= 0 && it.value() <= 1e140))
        return fmt::format("limit {} has an entry of {} for column {}", it.row(), it.value(), j);
  for (Index i = 0; i < limits.most.size(); ++i)
    if (!((limits.most[i] >= 0 && limits.most[i] <= 1e140) || limits.most[i] == kNoBound))
      return fmt::format("limit {} is {}", i, limits.most[i]);
  return {};
}

}  // namespace

Result<LimitedNnlsSolution> solve_limited_nnls(const NnlsProblem& problem, const LinearLimits& limits,
                                               const NnlsOptions& options) {
  std::string text = problem.complaint();
  if (text.empty()) text = limits_complaint(problem, limits);
  if (!text.empty()) {
    Fault fault;
    fault.cause = Cause::invalid;
    fault.detail = std::move(text);
    return tl::unexpected(fault);
  }
  const ScaledColumns p(problem);
  const VectorXd upper = upper_within(problem, limits);
  const ScaledLimits s = scaled_limits(p, upper, limits);
  const Index n = p.columns();
  Multipliers method(p, s);
  method.run(options);
  const VectorXd z = method.z.size() > 0 ? method.z : VectorXd::Zero(n);
  LimitedNnlsSolution solution;
  solution.rounds = method.rounds;
  solution.least_squares.iterations = method.iterations;
  solution.least_squares.converged = method.converged;
  solution.least_squares.orthogonal = method.orthogonal;
  VectorXd x(n);
  for (Index j = 0; j < n; ++j) {
    const auto at = static_cast<std::size_t>(j);
    x[j] = z[j] * (s.scale / s.z_per_x[at]);
    x[j] = z[j] >= s.upper[at] ? upper[j] : std::min(x[j], upper[j]);
  }
  NnlsSolution& out = solution.least_squares;
  out.x = x;
  out.residual = problem.goal;
  for (Index j = 0; j < n; ++j)
    if (x[j] != 0) problem.columns.add(j, -x[j], out.residual.data());
  out.residual_norm = p.norm(out.residual);
  const VectorXd& lambda = method.lambda();
  out.kkt = kkt_of(p, s, z, lambda);
  solution.multiplier = VectorXd::Zero(limits.most.size());
  for (std::size_t k = 0; k < s.which.size(); ++k)
    solution.multiplier[s.which[k]] = lambda[static_cast<Index>(k)] * s.scale * s.factor[k];
  return solution;
}

}  // namespace luxrig
