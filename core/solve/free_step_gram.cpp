#include <Eigen/Cholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "core/solve/free_step.h"
#include "core/solve/gram_cholesky.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A row held whose square, less what the rows before it say, is below this share of it follows from them.
constexpr double kDependent = 1e-13;
constexpr int kRefinements = 2;

class GramStep final : public FreeStep {
 public:
  GramStep(const LimitedLeastSquares& problem, const ColumnProducts& products) : p_(problem), products_(products) {}

  [[nodiscard]] double rate_tolerance() const override { return 1e-12; }

  [[nodiscard]] VectorXd gradient(const VectorXd& z) const override {
    return p_.E.transpose() * (p_.E * z - p_.f) + p_.tie * p_.tie * (z - p_.near);
  }

  [[nodiscard]] VectorXd multipliers(const LimitedLeastSquaresResult& at, const VectorXd&) const override {
    if (multiplier_.size() != static_cast<Index>(at.working_rows.size()))
      return VectorXd::Zero(static_cast<Index>(at.working_rows.size()));
    return multiplier_;
  }

  VectorXd direction(LimitedLeastSquaresResult& at, const std::vector<Index>& free) override {
    VectorXd whole = VectorXd::Zero(at.z.size());
    multiplier_.setZero(static_cast<Index>(at.working_rows.size()));
    if (free.empty()) return whole;
    if (!follow(free)) return VectorXd::Constant(at.z.size(), std::nan(""));
    hold(at.working_rows);
    multiplier_.setZero(static_cast<Index>(at.working_rows.size()));
    const VectorXd pull = -gradient(at.z);
    VectorXd left = pull(order_), room = (p_.slack - p_.G * at.z)(at.working_rows);
    const VectorXd wanted = room;
    for (int round = 0;; ++round) {
      factor_.forward(left);
      if (!at.working_rows.empty()) {
        const VectorXd more = held_factor_.solve(held_.transpose() * left - room);
        left -= held_ * more;
        multiplier_ += more;
      }
      factor_.backward(left);
      for (std::size_t k = 0; k < order_.size(); ++k) whole[order_[k]] += left[static_cast<Index>(k)];
      if (round == kRefinements) break;
      VectorXd rest = pull - p_.E.transpose() * (p_.E * whole) - p_.tie * p_.tie * whole;
      for (std::size_t k = 0; k < at.working_rows.size(); ++k)
        rest -= multiplier_[static_cast<Index>(k)] * p_.G.row(at.working_rows[k]).transpose();
      left = rest(order_);
      room = wanted - (p_.G * whole)(at.working_rows);
    }
    return whole;
  }

 private:
  /// The factor, of these columns. False when they are dependent in spite of the tie.
  bool follow(const std::vector<Index>& free) {
    std::vector<char> wanted(static_cast<std::size_t>(p_.E.cols()), 0);
    for (const Index j : free) wanted[static_cast<std::size_t>(j)] = 1;
    std::vector<Index> gone, kept, come;
    for (std::size_t k = 0; k < order_.size(); ++k) {
      if (wanted[static_cast<std::size_t>(order_[k])]) {
        kept.push_back(order_[k]);
        wanted[static_cast<std::size_t>(order_[k])] = 0;
      } else {
        gone.push_back(static_cast<Index>(k));
      }
    }
    for (const Index j : free)
      if (wanted[static_cast<std::size_t>(j)]) come.push_back(j);
    factor_.remove(gone);
    order_ = std::move(kept);
    if (come.empty()) return true;
    MatrixXd cross = products_.columns(order_, come), own = products_.columns(come, come);
    const std::vector<char> taken = factor_.append(cross, own, 1e-3 * p_.tie * p_.tie);
    if (std::find(taken.begin(), taken.end(), 0) != taken.end()) return false;
    order_.insert(order_.end(), come.begin(), come.end());
    return true;
  }

  /// What the rows leave of one another, seen through the factor; rows that follow from others are let go.
  void hold(std::vector<Index>& rows) {
    if (rows.empty()) return;
    held_.resize(static_cast<Index>(order_.size()), static_cast<Index>(rows.size()));
    for (std::size_t k = 0; k < rows.size(); ++k) {
      VectorXd row = p_.G.row(rows[k])(order_).transpose();
      held_.col(static_cast<Index>(k)) = row;
    }
    factor_.forward(held_);
    std::vector<Index> stay, places;
    MatrixXd products = held_.transpose() * held_;
    // Cholesky, row by row, of those that are independent.
    GramCholesky independent;
    for (Index k = 0; k < products.cols(); ++k) {
      MatrixXd cross = products(places, std::vector<Index>{k}), own = products.block(k, k, 1, 1);
      const double least = kDependent * own(0, 0);
      if (!(own(0, 0) > 0) || !independent.append(cross, own, least).front()) continue;
      places.push_back(k);
      stay.push_back(rows[static_cast<std::size_t>(k)]);
    }
    if (places.size() < rows.size()) {
      rows = std::move(stay);
      held_ = held_(Eigen::all, places).eval();
      products = products(places, places).eval();
    }
    held_factor_.compute(products);
  }

  const LimitedLeastSquares& p_;
  const ColumnProducts& products_;
  std::vector<Index> order_;
  GramCholesky factor_;
  MatrixXd held_;
  Eigen::LLT<MatrixXd> held_factor_;
  VectorXd multiplier_;
};

}  // namespace

ColumnProducts column_products(const LimitedLeastSquares& problem) {
  ColumnProducts products;
  const Index n = problem.E.cols();
  const double filled = static_cast<double>((problem.E.array() != 0).count());
  if (filled < 0.2 * static_cast<double>(problem.E.size())) {
    const Eigen::SparseMatrix<double> sparse = problem.E.sparseView();
    products.columns = MatrixXd(Eigen::SparseMatrix<double>(sparse.transpose() * sparse));
  } else {
    products.columns = MatrixXd::Zero(n, n);
    products.columns.selfadjointView<Eigen::Lower>().rankUpdate(problem.E.transpose());
    products.columns.triangularView<Eigen::StrictlyUpper>() = products.columns.transpose();
  }
  products.columns.diagonal().array() += problem.tie * problem.tie;
  products.goal = problem.E.transpose() * problem.f + problem.tie * problem.tie * problem.near;
  return products;
}

std::unique_ptr<FreeStep> make_gram_step(const LimitedLeastSquares& problem, const ColumnProducts& products) {
  return std::make_unique<GramStep>(problem, products);
}

}  // namespace luxrig
