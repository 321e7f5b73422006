#include "core/solve/least_squares/nnls_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
/// A gradient below this is rounding: columns and goal have norm 1.
constexpr double kSearchTolerance = 1e-13;

/// Hash of a set of columns, to recognise sets already visited (Zobrist).
std::uint64_t key_of(Index column) {
  std::uint64_t z = (static_cast<std::uint64_t>(column) + 1) * 0x9e3779b97f4a7c15ULL;  // splitmix64
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

std::size_t at(Index j) { return static_cast<std::size_t>(j); }

}  // namespace

NnlsSearch::NnlsSearch(const ScaledColumns& problem, std::unique_ptr<PassiveColumns> passive)
    : p_(problem), passive_(std::move(passive)), z_(VectorXd::Zero(problem.columns())) {
  place_.assign(at(p_.columns()), VariableState::lower);
  allowed_.assign(at(p_.columns()), 1);
  refused_.assign(at(p_.columns()), 0);
  residual_ = p_.goal();
}

void NnlsSearch::allow(Index column, bool allowed) {
  allowed_[at(column)] = allowed ? 1 : 0;
  if (allowed || place_[at(column)] == VariableState::lower) return;
  if (place_[at(column)] == VariableState::passive) {
    const auto& order = passive_->order();
    const Index where[1] = {std::find(order.begin(), order.end(), column) - order.begin()};
    passive_->remove(where);
    key_ ^= key_of(column);
  }
  std::erase(at_upper_, column);
  place_[at(column)] = VariableState::lower;
  z_[column] = 0;
}

void NnlsSearch::allow_as(const NnlsSearch& other) { allowed_ = other.allowed_; }

void NnlsSearch::start_from(const VectorXd& x) {
  std::vector<Index> positive, places;
  for (Index k = 0; k < passive_->size(); ++k) places.push_back(k);
  passive_->remove(places);
  place_.assign(place_.size(), VariableState::lower);
  at_upper_.clear();
  key_ = 0;
  z_.setZero();
  for (Index j = 0; j < z_.size(); ++j)
    if (x[j] > 0 && std::isfinite(x[j]) && allowed_[at(j)] && p_.upper(j) > 0) positive.push_back(j);
  // In parts: all products at once could exceed memory.
  constexpr std::size_t kPart = 256;
  for (std::size_t first = 0; first < positive.size() && passive_->size() < p_.rows(); first += kPart) {
    const std::size_t count = std::min(kPart, positive.size() - first);
    const std::vector<char> taken = passive_->append({positive.data() + first, count});
    for (std::size_t k = 0; k < count; ++k) {
      const Index j = positive[first + k];
      if (!taken[k]) continue;
      place_[at(j)] = VariableState::passive;
      key_ ^= key_of(j);
      z_[j] = std::min(p_.z_of(j, x[j]), p_.upper(j));
    }
  }
}

VectorXd NnlsSearch::x() const {
  VectorXd x(z_.size());
  for (Index j = 0; j < x.size(); ++j) x[j] = p_.x_of(j, z_[j]);
  return x;
}

void NnlsSearch::goal_changed(const VectorXd& x) {
  for (Index j = 0; j < x.size(); ++j)
    z_[j] = place_[at(j)] == VariableState::upper ? p_.upper(j) : std::min(p_.z_of(j, x[j]), p_.upper(j));
}

std::vector<Index> NnlsSearch::support() const {
  std::vector<Index> columns = passive_->order();
  columns.insert(columns.end(), at_upper_.begin(), at_upper_.end());
  return columns;
}

void NnlsSearch::renew_residual() { residual_ = p_.residual(z_, support()); }

void NnlsSearch::run(const NnlsOptions& options) {
  iterations_ = 0;
  converged_ = p_.nothing_wanted();
  stopped_ = false;
  if (converged_) z_.setZero();
  careful_ = options.max_entering == 1;
  // Measured on random and on nearly equal columns: more at a time wastes products.
  max_ = options.max_entering > 0 ? at(options.max_entering) : at(std::max<Index>(1, p_.rows() / 8));
  block_ = std::min(max_, std::max<std::size_t>(1, at(p_.rows()) / 16));
  refused_.assign(refused_.size(), 0);
  visited_.clear();
  renew_residual();
  if (converged_) return;
  if (!descend()) return;
  min_ = p_.norm(residual_);
  const Index max_rounds = 100 + 10 * std::min<Index>(p_.columns(), 100'000'000);
  while (iterations_ < max_rounds) {
    if (options.stop.stop_requested()) {
      stopped_ = true;
      break;
    }
    const std::vector<Index> columns = entering(block_);
    if (columns.empty()) {
      converged_ = true;
      break;
    }
    ++iterations_;
    if (!enter(columns)) continue;
    if (!descend()) return;
    after_round(columns);
  }
  polish();
}

/// The columns by which the error falls fastest.
std::vector<Index> NnlsSearch::entering(std::size_t most) {
  p_.gradient(residual_, gradient_);
  std::vector<Index> columns;
  const auto pull = [&](Index j) { return place_[at(j)] == VariableState::upper ? -gradient_[j] : gradient_[j]; };
  for (Index j = 0; j < gradient_.size(); ++j) {
    if (place_[at(j)] == VariableState::passive || refused_[at(j)] || !allowed_[at(j)] || !(p_.upper(j) > 0)) continue;
    if (!(pull(j) > kSearchTolerance)) continue;
    columns.push_back(j);
  }
  const auto steeper = [&](Index a, Index b) { return pull(a) != pull(b) ? pull(a) > pull(b) : a < b; };
  const auto room = static_cast<std::size_t>(std::max<Index>(1, p_.rows() - passive_->size()));
  const std::size_t count = std::min({most, columns.size(), room});
  if (count < columns.size())
    std::nth_element(columns.begin(), columns.begin() + static_cast<std::ptrdiff_t>(count), columns.end(), steeper);
  columns.resize(count);
  std::sort(columns.begin(), columns.end(), steeper);
  return columns;
}

/// False when none could enter: the first is then refused.
bool NnlsSearch::enter(const std::vector<Index>& columns) {
  std::vector<char> taken = passive_->append(columns);
  bool any = std::find(taken.begin(), taken.end(), 1) != taken.end();
  if (!any && columns.size() > 1) {
    taken.assign(taken.size(), 0);
    taken[0] = any = passive_->append({columns.data(), 1}).front() != 0;
  }
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (!taken[k]) continue;
    if (place_[at(columns[k])] == VariableState::upper) std::erase(at_upper_, columns[k]);
    place_[at(columns[k])] = VariableState::passive;
    key_ ^= key_of(columns[k]);
  }
  if (!any) refused_[at(columns.front())] = 1;
  return any;
}

/// Removes passive columns that stand at a bound and whose step leads out of it. True if there were any.
bool NnlsSearch::leave_at_bounds(const VectorXd& d) {
  std::vector<Index> places;
  for (Index k = 0; k < passive_->size(); ++k) {
    const Index j = passive_->order()[at(k)];
    const bool low = z_[j] <= 0 && d[k] < 0, high = z_[j] >= p_.upper(j) && d[k] > 0;
    if (!low && !high) continue;
    places.push_back(k);
    place_[at(j)] = low ? VariableState::lower : VariableState::upper;
    if (high) at_upper_.push_back(j);
    key_ ^= key_of(j);
  }
  passive_->remove(places);
  return !places.empty();
}

/// Moves to the least error over the passive columns, or below it by dropping those that meet their bounds. False when
/// the factor has broken down.
bool NnlsSearch::descend() {
  while (passive_->size() > 0) {
    const PassiveColumns::Step step = passive_->step(residual_);
    if (!step.d.allFinite()) return false;
    if (leave_at_bounds(step.d)) continue;
    const std::vector<Index>& order = passive_->order();
    double first = 1;  // share of the step at which the first column meets a bound
    Index blocking = -1;
    for (Index k = 0; k < step.d.size(); ++k) {
      const Index j = order[at(k)];
      const double room = step.d[k] < 0 ? z_[j] : p_.upper(j) - z_[j];
      if (!(std::abs(step.d[k]) > room)) continue;
      const double share = room / std::abs(step.d[k]);
      if (blocking >= 0 && share >= first) continue;
      first = share;
      blocking = k;
    }
    const auto move = [&](double share) {
      VectorXd z = z_;
      for (Index k = 0; k < step.d.size(); ++k) {
        const Index j = order[at(k)];
        z[j] = std::clamp(z_[j] + share * step.d[k], 0.0, p_.upper(j));
      }
      return z;
    };
    if (blocking < 0) {
      z_ = move(1);
      renew_residual();
      return true;
    }
    // Takes the whole step, clipped at the bounds, if that lowers the error at least half as much as stopping at the
    // first bound: many columns can then leave at once.
    const double error = residual_.cwiseAbs2().dot(p_.squared_weight());
    const double sure = (2 - first) * first * step.gain;
    VectorXd z;
    bool accepted = false;
    for (double share = 1; !careful_ && !accepted && share > 2 * first && share > 0.05; share /= 2) {
      z = move(share);
      VectorXd residual = p_.residual(z, support());
      const double now = residual.cwiseAbs2().dot(p_.squared_weight());
      accepted = now < error - std::max(0.5 * sure, 1e-4 * step.gain);
      if (accepted) residual_ = std::move(residual);
    }
    if (!accepted) {
      z = move(first);
      const Index j = order[at(blocking)];
      z[j] = step.d[blocking] < 0 ? 0 : p_.upper(j);
    }
    z_ = z;
    leave_at_bounds(step.d);
    if (!accepted) renew_residual();
  }
  renew_residual();
  return true;
}

void NnlsSearch::after_round(const std::vector<Index>& columns) {
  const double now = p_.norm(residual_);
  if (now < min_ * (1 - 16 * kEpsilon)) {  // real progress: refused columns may be tried again
    min_ = now;
    refused_.assign(refused_.size(), 0);
    visited_.clear();
    std::size_t stayed = 0;
    for (const Index j : columns) stayed += place_[at(j)] == VariableState::passive ? 1 : 0;
    if (columns.size() == block_ && 4 * stayed >= 3 * columns.size())
      block_ = std::min(max_, 2 * block_);
    else if (2 * stayed < columns.size())
      block_ = std::max<std::size_t>(1, block_ / 2);
    return;
  }
  // On a plateau of rounding: one column at a time, as Lawson & Hanson. If a set repeats, the last column that entered
  // stays out.
  block_ = 1;
  if (!visited_.insert(key_).second) refused_[at(columns.front())] = 1;
}

/// Iterative refinement.
void NnlsSearch::polish() {
  if (passive_->size() == 0) return;
  residual_ = p_.exact_residual(z_, support());
  double worst = p_.kkt(z_, residual_, allowed_).worst();
  for (int round = 0; round < 5 && worst > 2 * kEpsilon; ++round) {
    const VectorXd d = passive_->step(residual_).d;
    if (!d.allFinite()) return;
    VectorXd z = z_;
    for (Index k = 0; k < d.size(); ++k) {
      const Index j = passive_->order()[at(k)];
      z[j] = std::clamp(z_[j] + d[k], 0.0, p_.upper(j));
    }
    VectorXd residual = p_.exact_residual(z, support());
    const double now = p_.kkt(z, residual, allowed_).worst();
    if (!(now < worst)) return;
    z_ = std::move(z);
    residual_ = std::move(residual);
    worst = now;
  }
}

NnlsSolution NnlsSearch::solution() const {
  NnlsSolution solution;
  solution.x = x();
  solution.residual = residual_ * p_.in_units(1);
  solution.residual_norm = p_.in_units(p_.norm(residual_));
  solution.kkt = p_.kkt(z_, residual_, allowed_);
  solution.iterations = iterations_;
  solution.converged = converged_;
  return solution;
}

}  // namespace luxrig
