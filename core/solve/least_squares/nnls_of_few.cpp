#include "core/solve/least_squares/nnls_of_few.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kGradientTolerance = 1e-13;
/// Squared distance from the span below which products cannot tell a column from rounding.
constexpr double kMinPivot = 1e-11;
/// If a refused column pulls more than this, the matrix itself is solved.
constexpr double kWorthwhilePull = 1e-11;
/// Below this the squared error is summed from the residuals: the difference of products has lost its digits.
constexpr double kSmallSquaredError = 1e-5;

}  // namespace

SharedProblem::SharedProblem(const NnlsProblem& problem) : scaled_(problem) { scaled_.gradient(scaled_.goal(), pull_); }

Result<std::shared_ptr<const SharedProblem>> share_problem(const NnlsProblem& problem) {
  if (std::string text = problem.complaint(); !text.empty()) {
    Fault fault;
    fault.cause = Cause::invalid;
    fault.detail = std::move(text);
    return tl::unexpected(fault);
  }
  return std::make_shared<const SharedProblem>(problem);
}

NnlsOfFew::NnlsOfFew(std::shared_ptr<const SharedProblem> problem) : problem_(std::move(problem)) {
  spread_.assign(static_cast<std::size_t>(problem_->scaled().rows()), 0.0);
}

void NnlsOfFew::reserve(std::size_t count) {
  if (count <= capacity_) return;
  const std::size_t wanted = std::max<std::size_t>(16, count + count / 2);
  const auto larger = [&](std::vector<double>& square) {
    std::vector<double> next(wanted * wanted, 0.0);
    for (std::size_t a = 0; a < capacity_; ++a)
      std::copy_n(square.begin() + static_cast<std::ptrdiff_t>(a * capacity_), capacity_,
                  next.begin() + static_cast<std::ptrdiff_t>(a * wanted));
    square.swap(next);
  };
  larger(gram_);
  larger(factor_);
  capacity_ = wanted;
}

/// Products of the column at a place with all chosen columns.
void NnlsOfFew::fill(std::size_t place) {
  const ScaledColumns& p = problem_->scaled();
  const Index column = column_[place];
  LUXRIG_CHECK(column >= 0 && column < p.columns(), "column {} of {}", column, p.columns());
  const double inverse = p.inverse_norm(column);
  p.view().add(column, inverse, spread_.data());
  const VectorXd weighted =
      p.unweighted() ? VectorXd() : p.weighted(Eigen::Map<const VectorXd>(spread_.data(), p.rows()));
  const double* vector = p.unweighted() ? spread_.data() : weighted.data();
  for (std::size_t other = 0; other < column_.size(); ++other) {
    const Index j = column_[other];
    const double value = other == place ? (inverse > 0 ? 1.0 : 0.0) : p.inverse_norm(j) * p.view().dot(j, vector);
    product(place, other) = product(other, place) = value;
  }
  p.view().clear(column, spread_.data());
}

void NnlsOfFew::choose(std::span<const Index> columns) {
  column_.clear();
  passive_.clear();
  z_.clear();
  is_passive_.clear();
  for (const Index column : columns) append(column);
  optimise();
}

void NnlsOfFew::add(Index column) {
  append(column);
  optimise();
}

void NnlsOfFew::append(Index column) {
  column_.push_back(column);
  z_.push_back(0);
  is_passive_.push_back(0);
  reserve(column_.size());
  fill(column_.size() - 1);
}

void NnlsOfFew::exchange(std::size_t place, Index column) {
  LUXRIG_CHECK(place < column_.size(), "place {} of {}", place, column_.size());
  if (is_passive_[place])
    let_go(static_cast<std::size_t>(std::find(passive_.begin(), passive_.end(), place) - passive_.begin()));
  z_[place] = 0;
  column_[place] = column;
  fill(place);
  optimise();
}

void NnlsOfFew::drop(std::size_t place) {
  LUXRIG_CHECK(place < column_.size(), "place {} of {}", place, column_.size());
  if (is_passive_[place])
    let_go(static_cast<std::size_t>(std::find(passive_.begin(), passive_.end(), place) - passive_.begin()));
  const auto there = static_cast<std::ptrdiff_t>(place);
  column_.erase(column_.begin() + there);
  z_.erase(z_.begin() + there);
  is_passive_.erase(is_passive_.begin() + there);
  for (std::size_t& other : passive_) other -= other > place ? 1 : 0;
  for (std::size_t a = 0; a < column_.size(); ++a)
    for (std::size_t b = 0; b < column_.size(); ++b)
      product(a, b) = product(a + (a >= place ? 1 : 0), b + (b >= place ? 1 : 0));
  optimise();
}

void NnlsOfFew::renew_gradient() {
  const std::size_t k = column_.size();
  gradient_.resize(k);
  for (std::size_t a = 0; a < k; ++a) {
    double sum = problem_->pull(column_[a]);
    const double* row = &gram_[a * capacity_];
    for (std::size_t b = 0; b < k; ++b) sum -= row[b] * z_[b];
    gradient_[a] = sum;
  }
}

/// Appends to the factor. False when the products show the column to be in the span of the passive ones.
bool NnlsOfFew::take_up(std::size_t place) {
  const std::size_t p = passive_.size();
  double* row = &factor_[p * capacity_];
  double pivot = product(place, place);
  for (std::size_t a = 0; a < p; ++a) {
    const double* above = &factor_[a * capacity_];
    double sum = product(place, passive_[a]);
    for (std::size_t b = 0; b < a; ++b) sum -= above[b] * row[b];
    row[a] = sum / above[a];
    pivot -= row[a] * row[a];
  }
  if (!(pivot > kMinPivot)) return false;
  row[p] = std::sqrt(pivot);
  passive_.push_back(place);
  is_passive_[place] = 1;
  return true;
}

/// Removes from the factor: the rows below move up, and rotations make them triangular again.
void NnlsOfFew::let_go(std::size_t position) {
  is_passive_[passive_[position]] = 0;
  passive_.erase(passive_.begin() + static_cast<std::ptrdiff_t>(position));
  const std::size_t p = passive_.size();
  for (std::size_t a = position; a < p; ++a) std::copy_n(&factor_[(a + 1) * capacity_], a + 2, &factor_[a * capacity_]);
  for (std::size_t k = position; k < p; ++k) {
    const double x = factor_[k * capacity_ + k], y = factor_[k * capacity_ + k + 1];
    const double length = std::sqrt(x * x + y * y);
    const double c = x / length, s = y / length;
    for (std::size_t a = k; a < p; ++a) {
      double* at = &factor_[a * capacity_ + k];
      const double left = at[0], right = at[1];
      at[0] = c * left + s * right;
      at[1] = c * right - s * left;
    }
  }
}

/// step_ = G_P⁻¹ gradient_P
void NnlsOfFew::solve_factor() {
  const std::size_t p = passive_.size();
  step_.resize(p);
  for (std::size_t a = 0; a < p; ++a) {
    const double* row = &factor_[a * capacity_];
    double sum = gradient_[passive_[a]];
    for (std::size_t b = 0; b < a; ++b) sum -= row[b] * step_[b];
    step_[a] = sum / row[a];
  }
  for (std::size_t a = p; a-- > 0;) {
    const double* row = &factor_[a * capacity_];
    step_[a] /= row[a];
    for (std::size_t b = 0; b < a; ++b) step_[b] -= row[b] * step_[a];
  }
}

/// Lawson & Hanson's inner loop: moves to the least error over the passive columns, dropping those that meet their
/// bounds.
void NnlsOfFew::to_least_error() {
  while (!passive_.empty()) {
    solve_factor();
    double first = 1;
    std::size_t blocking = passive_.size();
    for (std::size_t a = 0; a < passive_.size(); ++a) {
      const double d = step_[a], z = z_[passive_[a]];
      const double room = d < 0 ? z : upper(passive_[a]) - z;
      if (!(std::abs(d) > room) || (blocking < passive_.size() && room >= first * std::abs(d))) continue;
      first = room / std::abs(d);
      blocking = a;
    }
    for (std::size_t a = 0; a < passive_.size(); ++a)
      z_[passive_[a]] = std::clamp(z_[passive_[a]] + first * step_[a], 0.0, upper(passive_[a]));
    if (blocking == passive_.size()) {
      renew_gradient();
      return;
    }
    z_[passive_[blocking]] = step_[blocking] < 0 ? 0 : upper(passive_[blocking]);
    let_go(blocking);
    renew_gradient();
  }
}

/// False when products do not suffice.
bool NnlsOfFew::search() {
  const std::size_t k = column_.size();
  refused_.assign(k, 0);
  renew_gradient();
  to_least_error();
  for (std::size_t round = 0; round < 20 + 6 * k; ++round) {
    std::size_t best = k;
    double most = kGradientTolerance;
    for (std::size_t a = 0; a < k; ++a) {
      if (is_passive_[a] || refused_[a]) continue;
      const double bound = upper(a);
      const double pull = z_[a] > 0 && z_[a] >= bound ? -gradient_[a] : gradient_[a];
      if (!(bound > 0) || !(pull > most)) continue;
      most = pull;
      best = a;
    }
    if (best == k) {
      for (std::size_t a = 0; a < k; ++a) {
        if (!std::isfinite(gradient_[a]) || !std::isfinite(z_[a])) return false;
        if (refused_[a] && !is_passive_[a] && std::abs(gradient_[a]) > kWorthwhilePull) return false;
        if (is_passive_[a] && std::abs(gradient_[a]) > kWorthwhilePull) return false;
      }
      return true;
    }
    if (!take_up(best)) {
      refused_[best] = 1;
      continue;
    }
    const double before = z_[best];
    to_least_error();
    if (z_[best] == before) refused_[best] = 1;  // its pull was only rounding
  }
  return false;
}

/// Solves the chosen columns as a small matrix with the most careful solver. The factor restarts.
void NnlsOfFew::solve_from_matrix() {
  const ScaledColumns& p = problem_->scaled();
  const auto k = static_cast<Index>(column_.size());
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(p.rows(), k);
  NnlsProblem few;
  few.upper.resize(k);
  for (Index a = 0; a < k; ++a) {
    const Index column = column_[static_cast<std::size_t>(a)];
    p.view().add(column, p.inverse_norm(column), &dense(0, a));
    few.upper[a] = p.upper(column);
  }
  few.columns = ColumnsView(dense);
  few.goal = p.goal();
  if (!p.unweighted()) few.row_weight = p.squared_weight().cwiseSqrt();
  const auto solution = solve_nnls(few);
  LUXRIG_CHECK(solution.has_value(), "{}", solution.has_value() ? "" : solution.error().detail);
  passive_.clear();
  std::fill(is_passive_.begin(), is_passive_.end(), char{0});
  for (Index a = 0; a < k; ++a) z_[static_cast<std::size_t>(a)] = solution->x[a];
  // Columns that the factor refuses keep their level, as if at a bound, until an exchange.
  from_matrix_ = true;
}

void NnlsOfFew::optimise() {
  if (from_matrix_) {
    from_matrix_ = false;
    std::fill(z_.begin(), z_.end(), 0.0);
  }
  squared_error_ = 0;
  if (problem_->scaled().nothing_wanted()) return;
  if (!search()) solve_from_matrix();
  squared_error_ = 1;
  for (std::size_t a = 0; a < column_.size(); ++a)
    squared_error_ -= z_[a] * (problem_->pull(column_[a]) + gradient_[a]);
  if (squared_error_ < kSmallSquaredError || from_matrix_) {
    const double norm = problem_->scaled().norm(scaled_residual());
    squared_error_ = norm * norm;
  }
}

VectorXd NnlsOfFew::scaled_residual() const {
  const ScaledColumns& p = problem_->scaled();
  VectorXd rest = p.goal();
  for (std::size_t a = 0; a < column_.size(); ++a)
    if (z_[a] != 0) p.view().add(column_[a], -z_[a] * p.inverse_norm(column_[a]), rest.data());
  return rest;
}

double NnlsOfFew::level(std::size_t place) const { return problem_->scaled().x_of(column_[place], z_[place]); }

double NnlsOfFew::residual_norm() const { return problem_->scaled().in_units(std::sqrt(squared_error_)); }

VectorXd NnlsOfFew::residual() const { return scaled_residual() * problem_->scaled().in_units(1); }

KktResiduals NnlsOfFew::kkt() const {
  const ScaledColumns& p = problem_->scaled();
  const VectorXd weighted = p.weighted(scaled_residual());
  KktResiduals kkt;
  for (std::size_t a = 0; a < column_.size(); ++a) kkt.add(z_[a], upper(a), p.gradient_of(column_[a], weighted));
  return kkt;
}

}  // namespace luxrig
