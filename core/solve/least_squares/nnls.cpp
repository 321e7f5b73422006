#include "core/solve/least_squares/nnls.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.h"
#include "core/solve/least_squares/nnls_search.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLargestGramEntry = ColumnsView::kLargestEntry;
/// An answer worse than this is solved again with orthogonal factors.
constexpr double kGoodEnough = 1e-12;

std::string entry_complaint(const VectorXd& values, const char* name, double most, bool signs) {
  for (Index i = 0; i < values.size(); ++i)
    if (!(std::abs(values[i]) <= most) || (!signs && values[i] < 0))
      return fmt::format("{} {} is {}", name, i, values[i]);
  return {};
}

}  // namespace

std::string NnlsProblem::complaint() const {
  if (goal.size() != columns.rows()) return fmt::format("{} goals for {} rows", goal.size(), columns.rows());
  if (row_weight.size() != 0 && row_weight.size() != goal.size())
    return fmt::format("{} weights for {} rows", row_weight.size(), goal.size());
  if (upper.size() != 0 && upper.size() != columns.columns())
    return fmt::format("{} upper bounds for {} columns", upper.size(), columns.columns());
  if (auto text = columns.complaint(); !text.empty()) return text;
  if (auto text = entry_complaint(goal, "goal", kLargestGramEntry, true); !text.empty()) return text;
  if (auto text = entry_complaint(row_weight, "weight", 1e70, false); !text.empty()) return text;
  return entry_complaint(upper, "upper bound", std::numeric_limits<double>::infinity(), false);
}

void KktResiduals::add(double z, double upper, double g) {
  if (!(upper > 0)) return;
  primal = std::max({primal, -z, z - upper});
  if (z <= 0)
    gradient = std::max(gradient, g);
  else if (z >= upper)
    gradient = std::max(gradient, -g);
  else
    stationarity = std::max(stationarity, std::abs(g));
  // The multiplier of a bound times the distance from it.
  const double room = g < 0 ? z : upper - z;
  if (std::isfinite(room)) complementarity = std::max(complementarity, std::abs(g * room));
}

double KktResiduals::worst() const { return std::max({stationarity, gradient, primal, complementarity}); }

struct NnlsSolver::State {
  State(const NnlsProblem& problem, const NnlsOptions& how)
      : scaled(problem), options(how), search(scaled, make_gram_columns(scaled)) {}

  ScaledColumns scaled;
  NnlsOptions options;
  NnlsSearch search;
};

NnlsSolver::NnlsSolver(std::unique_ptr<State> state) : state_(std::move(state)) {}
NnlsSolver::NnlsSolver(NnlsSolver&&) noexcept = default;
NnlsSolver& NnlsSolver::operator=(NnlsSolver&&) noexcept = default;
NnlsSolver::~NnlsSolver() = default;

Result<NnlsSolver> NnlsSolver::make(const NnlsProblem& problem, const NnlsOptions& options) {
  if (std::string text = problem.complaint(); !text.empty()) {
    Fault fault;
    fault.cause = Cause::invalid;
    fault.detail = std::move(text);
    return tl::unexpected(fault);
  }
  return NnlsSolver(std::make_unique<State>(problem, options));
}

void NnlsSolver::set_goal(const VectorXd& goal) {
  LUXRIG_CHECK(goal.size() == state_->scaled.rows(), "{} goals for {} rows", goal.size(), state_->scaled.rows());
  LUXRIG_CHECK(entry_complaint(goal, "goal", kLargestGramEntry, true).empty(), "a goal is not finite");
  const VectorXd x = state_->search.x();
  state_->scaled.set_goal(goal);
  state_->search.goal_changed(x);
}

void NnlsSolver::allow(Index column, bool allowed) {
  LUXRIG_CHECK(column >= 0 && column < state_->scaled.columns(), "column {} of {}", column, state_->scaled.columns());
  state_->search.allow(column, allowed);
}

void NnlsSolver::start_from(const VectorXd& x) {
  LUXRIG_CHECK(x.size() == state_->scaled.columns(), "{} levels for {} columns", x.size(), state_->scaled.columns());
  state_->search.start_from(x);
}

NnlsSolution NnlsSolver::solve() {
  NnlsSearch& search = state_->search;
  search.run(state_->options);
  NnlsSolution solution = search.solution();
  if (search.stopped() || (solution.converged && solution.kkt.worst() <= kGoodEnough)) return solution;
  NnlsSearch again(state_->scaled, make_orthogonal_columns(state_->scaled));
  again.allow_as(search);
  again.run({1, state_->options.stop});
  NnlsSolution other = again.solution();
  other.orthogonal = true;
  other.iterations += solution.iterations;
  const bool better = other.converged && (!solution.converged || other.kkt.worst() < solution.kkt.worst());
  return better ? other : solution;
}

Result<NnlsSolution> solve_nnls(const NnlsProblem& problem, const NnlsOptions& options) {
  auto solver = NnlsSolver::make(problem, options);
  if (!solver) return tl::unexpected(solver.error());
  return solver->solve();
}

namespace {

constexpr int kNoExponent = std::numeric_limits<int>::min();

int exponent_of(const Eigen::Ref<const VectorXd>& v) {
  const double largest = v.size() == 0 ? 0 : v.cwiseAbs().maxCoeff();
  return largest == 0 ? kNoExponent : std::ilogb(largest);
}

}  // namespace

NnlsResult solve_nnls(const MatrixXd& A, const VectorXd& b) {
  LUXRIG_CHECK(A.rows() == b.size(), "{} rows, {} right-hand sides", A.rows(), b.size());
  LUXRIG_CHECK(A.allFinite() && b.allFinite(), "entries must be finite");
  // Scales columns and b to about 1 by powers of two, which is exact.
  const int of_b = exponent_of(b);
  VectorXd goal = b;
  if (of_b != kNoExponent)
    for (double& value : goal) value = std::ldexp(value, -of_b);
  MatrixXd scaled = A;
  std::vector<int> exponent;
  for (Index j = 0; j < A.cols(); ++j) {
    exponent.push_back(exponent_of(A.col(j)));
    // x of such a column would be beyond the range of double.
    if (of_b != kNoExponent && exponent.back() != kNoExponent && exponent.back() < of_b - 900) scaled.col(j).setZero();
    if (exponent.back() != kNoExponent)
      for (double& value : scaled.col(j)) value = std::ldexp(value, -exponent.back());
  }
  NnlsProblem problem;
  problem.columns = ColumnsView(scaled);
  problem.goal = goal;
  const auto solution = solve_nnls(problem);
  LUXRIG_CHECK(solution.has_value(), "{}", solution.has_value() ? "" : solution.error().detail);
  NnlsResult result;
  result.x = solution->x;
  for (Index j = 0; j < A.cols(); ++j)
    if (result.x[j] != 0) result.x[j] = std::ldexp(result.x[j], of_b - exponent[static_cast<std::size_t>(j)]);
  result.residual_norm = of_b == kNoExponent ? 0 : std::ldexp(solution->residual_norm, of_b);
  result.kkt_residual = solution->kkt.worst();
  result.iterations = solution->iterations;
  result.converged = solution->converged;
  return result;
}

}  // namespace luxrig
