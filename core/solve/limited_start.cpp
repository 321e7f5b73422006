#include "core/solve/limited_start.h"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMostSteps = 60;
constexpr double kGap = 1e-17;       ///< products of constraints and multipliers: columns and goals are about 1
constexpr double kNoUpper = 1e6;     ///< a bound further than this (a level alone gives about 1) does not bind
constexpr double kLeastRoom = 1e-9;  ///< of a row in the guess: an inside there must be

/// Room and multiplier of constraints, each > 0.
struct Barrier {
  VectorXd room, multiplier;
  VectorXd room_step, multiplier_step;

  explicit Barrier(Index count) {
    for (VectorXd* v : {&room, &multiplier}) v->setOnes(count);
    for (VectorXd* v : {&room_step, &multiplier_step}) v->setZero(count);
  }
  [[nodiscard]] double gap() const { return room.dot(multiplier); }
  [[nodiscard]] double gap_after(double room_share, double multiplier_share) const {
    return (room + room_share * room_step).dot(multiplier + multiplier_share * multiplier_step);
  }
  static double most(const VectorXd& v, const VectorXd& step) {
    double share = 1;
    for (Index i = 0; i < v.size(); ++i)
      if (step[i] < 0) share = std::min(share, -v[i] / step[i]);
    return share;
  }
  /// multiplier_step from room_step: multiplier · room_step + room · multiplier_step = aim − room · multiplier −
  /// second.
  void solve_multiplier(double aim, const VectorXd& second) {
    multiplier_step = ((aim - second.array()) / room.array() - multiplier.array() -
                       multiplier.array() / room.array() * room_step.array())
                          .matrix();
  }
  [[nodiscard]] VectorXd pull(double aim, const VectorXd& second) const {
    return ((aim - second.array()) / room.array()).matrix();
  }
};

/// gram + diagonal + limitsᵀ weight limits, factored: sparse where lights reach few points each, as spots do.
class Curvature {
 public:
  Curvature(const MatrixXd& gram, const MatrixXd& limits) : gram_(gram), limits_(limits) {
    const auto filled = [](const MatrixXd& m) { return static_cast<double>((m.array() != 0).count()); };
    const double size = static_cast<double>(gram.size());
    sparse_ = filled(gram) < 0.1 * size && filled(limits) < 0.05 * static_cast<double>(limits.size() + 1);
    if (!sparse_) return;
    sparse_gram_ = gram.sparseView();
    sparse_limits_ = limits.sparseView();
  }

  bool factor(const VectorXd& diagonal, const VectorXd& weight) {
    if (sparse_) {
      SparseMatrix matrix = sparse_gram_;
      if (weight.size() > 0) matrix += SparseMatrix(sparse_limits_.transpose() * weight.asDiagonal() * sparse_limits_);
      for (Index j = 0; j < diagonal.size(); ++j) matrix.coeffRef(j, j) += diagonal[j];
      of_sparse_.compute(matrix);
      return of_sparse_.info() == Eigen::Success;
    }
    MatrixXd matrix = gram_;
    matrix.diagonal() += diagonal;
    if (weight.size() > 0) {
      const MatrixXd weighted = weight.cwiseSqrt().asDiagonal() * limits_;
      matrix.selfadjointView<Eigen::Lower>().rankUpdate(weighted.transpose());
    }
    of_dense_.compute(matrix);
    return of_dense_.info() == Eigen::Success;
  }

  [[nodiscard]] VectorXd solve(const VectorXd& right) const {
    if (sparse_) return of_sparse_.solve(right);
    return of_dense_.solve(right);
  }

 private:
  using SparseMatrix = Eigen::SparseMatrix<double>;
  const MatrixXd& gram_;
  const MatrixXd& limits_;
  bool sparse_ = false;
  SparseMatrix sparse_gram_, sparse_limits_;
  Eigen::SimplicialLLT<SparseMatrix> of_sparse_;
  Eigen::LLT<MatrixXd> of_dense_;
};

/// The unknowns that can be anything but 0, and the rows that are about them.
class Inside {
 public:
  Inside(const LimitedLeastSquares& problem, const ColumnProducts& products) : p_(problem) {
    std::vector<char> dark(at(p_.upper.size()), 0);
    for (Index i = 0; i < p_.G.rows(); ++i) {
      if (p_.slack[i] > kLeastRoom || p_.G.row(i).minCoeff() < 0) continue;
      for (Index j = 0; j < p_.G.cols(); ++j)
        if (p_.G(i, j) > 0) dark[at(j)] = 1;
    }
    for (Index j = 0; j < p_.upper.size(); ++j)
      if (p_.upper[j] > 0 && !dark[at(j)]) used_.push_back(j);
    for (Index i = 0; i < p_.G.rows(); ++i)
      if (used_.empty() || p_.G.row(i)(used_).cwiseAbs().maxCoeff() > 0) rows_.push_back(i);
    for (std::size_t k = 0; k < used_.size(); ++k)
      if (p_.upper[used_[k]] < kNoUpper) bounded_.push_back(static_cast<Index>(k));
    gram_ = products.columns(used_, used_);
    product_ = products.goal(used_);
    limits_ = p_.G(rows_, used_);
    slack_ = p_.slack(rows_).cwiseMax(kLeastRoom);
    upper_ = p_.upper(used_);
  }

  LimitedStart run(const std::stop_token& stop) {
    const auto n = static_cast<Index>(used_.size()), m = static_cast<Index>(rows_.size());
    LimitedStart found;
    found.z = VectorXd::Zero(p_.upper.size());
    found.state.assign(at(p_.upper.size()), BoundState::lower);
    if (n == 0) return found;
    Barrier low(n), high(static_cast<Index>(bounded_.size())), row(m);
    VectorXd z(n);
    for (Index j = 0; j < n; ++j) z[j] = std::min(0.5 * upper_[j], 0.1);
    double share = 1;  // into the limits
    const VectorXd used = limits_ * z;
    for (Index i = 0; i < m; ++i)
      if (used[i] > 0.5 * slack_[i]) share = std::min(share, 0.5 * slack_[i] / used[i]);
    z *= share;
    const auto rooms = [&] {
      low.room = z;
      high.room = (upper_ - z)(bounded_);
      row.room = slack_ - limits_ * z;
    };
    rooms();
    // Each constraint pulls about alike in the beginning.
    const double start = 0.1 * std::max(1e-3, (gram_ * z - product_).cwiseAbs().maxCoeff());
    for (Barrier* b : {&low, &high, &row}) b->multiplier.setConstant(start);
    const auto count = static_cast<double>(2 * n + m);
    Curvature curvature(gram_, limits_);
    VectorXd z_before = z;
    Barrier low_before = low, high_before = high, row_before = row;
    for (; found.iterations < kMostSteps && !stop.stop_requested(); ++found.iterations) {
      const double gap = (low.gap() + high.gap() + row.gap()) / count;
      VectorXd gradient = gram_ * z - product_ - low.multiplier + limits_.transpose() * row.multiplier;
      gradient(bounded_) += high.multiplier;
      const double stationary = gradient.cwiseAbs().maxCoeff();
      if (!std::isfinite(gap) || (gap < kGap && stationary < 1e-13)) break;
      VectorXd diagonal = low.multiplier.cwiseQuotient(low.room);
      diagonal(bounded_) += high.multiplier.cwiseQuotient(high.room);
      if (!curvature.factor(diagonal, row.multiplier.cwiseQuotient(row.room))) break;
      const auto step = [&](double aim) {
        const VectorXd of_low = low.room_step.cwiseProduct(low.multiplier_step),
                       of_up = high.room_step.cwiseProduct(high.multiplier_step),
                       of_row = row.room_step.cwiseProduct(row.multiplier_step);
        VectorXd right = product_ - gram_ * z + low.pull(aim, of_low) - limits_.transpose() * row.pull(aim, of_row);
        right(bounded_) -= high.pull(aim, of_up);
        const VectorXd d = curvature.solve(right);
        low.room_step = d;
        high.room_step = -d(bounded_);
        row.room_step = -(limits_ * d);
        low.solve_multiplier(aim, of_low);
        high.solve_multiplier(aim, of_up);
        row.solve_multiplier(aim, of_row);
      };
      for (Barrier* b : {&low, &high, &row}) {
        b->room_step.setZero();
        b->multiplier_step.setZero();
      }
      step(0);
      double of_room = 1, of_multiplier = 1;
      const auto shares = [&] {
        of_room = of_multiplier = 1;
        for (const Barrier* b : {&low, &high, &row}) {
          of_room = std::min(of_room, Barrier::most(b->room, b->room_step));
          of_multiplier = std::min(of_multiplier, Barrier::most(b->multiplier, b->multiplier_step));
        }
        of_room = of_multiplier = std::min(of_room, of_multiplier);
      };
      shares();
      const double predicted = (low.gap_after(of_room, of_multiplier) + high.gap_after(of_room, of_multiplier) +
                                row.gap_after(of_room, of_multiplier)) /
                               count;
      step(gap * std::pow(predicted / gap, 3));
      shares();
      const double damped = std::max(0.99, 1 - gap);
      z_before = z;
      low_before = low;
      high_before = high;
      row_before = row;
      z += damped * of_room * low.room_step;
      for (Barrier* b : {&low, &high, &row}) {
        b->multiplier += damped * of_multiplier * b->multiplier_step;
        b->room += damped * of_room * b->room_step;
      }
      if (of_room < 1e-8) break;  // rounding is all there is left
      low.room = z;
    }
    // A constraint that binds loses its room from step to step and keeps its multiplier; one that does not, the other
    // way round.
    const auto binds = [](const Barrier& now, const Barrier& before, Index i) {
      return now.room[i] * before.multiplier[i] < now.multiplier[i] * before.room[i];
    };
    for (Index j = 0; j < n; ++j) {
      if (binds(low, low_before, j)) continue;
      found.z[used_[at(j)]] = z[j];
      found.state[at(used_[at(j)])] = BoundState::free;
    }
    for (std::size_t k = 0; k < bounded_.size(); ++k)
      if (binds(high, high_before, static_cast<Index>(k)) &&
          found.state[at(used_[at(bounded_[k])])] == BoundState::free) {
        found.state[at(used_[at(bounded_[k])])] = BoundState::upper;
        found.z[used_[at(bounded_[k])]] = p_.upper[used_[at(bounded_[k])]];
      }
    for (Index i = 0; i < m; ++i)
      if (binds(row, row_before, i)) found.rows.push_back(rows_[at(i)]);
    return found;
  }

 private:
  static std::size_t at(Index j) { return static_cast<std::size_t>(j); }

  const LimitedLeastSquares& p_;
  std::vector<Index> used_, rows_, bounded_;
  MatrixXd gram_, limits_;
  VectorXd product_, slack_, upper_;
};

}  // namespace

LimitedStart limited_start(const LimitedLeastSquares& problem, const ColumnProducts& products,
                           const std::stop_token& stop) {
  return Inside(problem, products).run(stop);
}

}  // namespace luxrig
