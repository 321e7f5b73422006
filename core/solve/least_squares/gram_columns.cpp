#include <algorithm>
#include <cmath>

#include "core/solve/least_squares/gram_cholesky.h"
#include "core/solve/least_squares/passive_columns.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Squared distance from the span below which products of columns are too coarse to measure it.
constexpr double kMinGramPivot = 1e-5;

/// Products of columns with eight others at a time, which are interleaved in rows of eight.
class Products {
 public:
  explicit Products(const ScaledColumns& problem) : p_(problem) {}

  /// result = A_withᵀ W² A_of, columns of norm 1; `lower`: only the lower triangle.
  void of(std::span<const Index> with, std::span<const Index> columns, bool lower, MatrixXd& result) {
    constexpr Index kTile = ColumnsView::kTile;
    result.resize(static_cast<Index>(with.size()), static_cast<Index>(columns.size()));
    spread_.resize(p_.rows());
    tile_.setZero(kTile, p_.rows());
    products_.resize(kTile, static_cast<Index>(with.size()));
    for (Index first = 0; first < result.cols(); first += kTile) {
      const Index count = std::min(kTile, result.cols() - first);
      if (first > 0) tile_.setZero();
      for (Index c = 0; c < count; ++c) {
        const Index column = columns[static_cast<std::size_t>(first + c)];
        spread_.setZero();
        p_.view().add(column, p_.inverse_norm(column), spread_.data());
        tile_.row(c) = spread_.cwiseProduct(p_.squared_weight()).transpose();
      }
      const Index from = lower ? first : 0;
      p_.view().dot_tile(with.subspan(static_cast<std::size_t>(from)), tile_.data(), products_.data());
      for (Index c = 0; c < count; ++c)
        for (Index a = from; a < result.rows(); ++a)
          result(a, first + c) = products_(c, a - from) * p_.inverse_norm(with[static_cast<std::size_t>(a)]);
    }
  }

 private:
  const ScaledColumns& p_;
  VectorXd spread_;
  MatrixXd tile_, products_;
};

class GramColumns final : public PassiveColumns {
 public:
  explicit GramColumns(const ScaledColumns& problem) : p_(problem), products_(problem) {}

  std::vector<char> append(std::span<const Index> columns) override {
    products_.of(order_, columns, false, cross_);
    if (columns.size() == 1) {
      const bool taken = append_one(columns.front());
      return std::vector<char>(1, taken ? 1 : 0);
    }
    MatrixXd own;
    products_.of(columns, columns, true, own);
    std::vector<char> taken = factor_.append(cross_, own, kMinGramPivot);
    for (std::size_t k = 0; k < columns.size(); ++k)
      if (taken[k]) order_.push_back(columns[k]);
    return taken;
  }

  void remove(std::span<const Index> places) override {
    factor_.remove(places);
    forget(places);
    if (order_.empty()) corrected_ = false;
  }

  [[nodiscard]] Step step(const VectorXd& residual) const override {
    Step step;
    step.d = products_with(residual);
    factor_.forward(step.d);
    step.gain = step.d.squaredNorm();
    factor_.backward(step.d);
    if (!corrected_) return step;
    VectorXd more = products_with(left_of(residual, step.d));
    factor_.forward(more);
    factor_.backward(more);
    step.d += more;
    return step;
  }

 private:
  /// New row of L from the products. If the column is near the others' span the products cancel, and the residual of
  /// the column itself corrects the row.
  bool append_one(Index column) {
    if (size() >= p_.rows()) return false;
    VectorXd row = cross_.col(0);
    factor_.forward(row);
    double pivot_squared = 1 - row.squaredNorm();
    if (pivot_squared < kMinGramPivot) {
      VectorXd own = VectorXd::Zero(p_.rows());
      p_.view().add(column, p_.inverse_norm(column), own.data());
      VectorXd combination = row;
      factor_.backward(combination);
      VectorXd left = left_of(own, combination);
      for (int round = 0; round < 2; ++round) {
        VectorXd more = products_with(left);
        factor_.forward(more);
        row += more;
        factor_.backward(more);
        combination += more;
        left = left_of(own, combination);
      }
      const double distance = p_.norm(left);
      if (!(distance > kNearestToSpan)) return false;
      pivot_squared = distance * distance;
      corrected_ = true;
    }
    factor_.append_row(row, std::sqrt(pivot_squared));
    order_.push_back(column);
    return true;
  }

  [[nodiscard]] VectorXd products_with(const VectorXd& vector) const {
    const VectorXd weighted = p_.weighted(vector);
    VectorXd result(size());
    for (Index k = 0; k < size(); ++k) result[k] = p_.gradient_of(order_[static_cast<std::size_t>(k)], weighted);
    return result;
  }
  [[nodiscard]] VectorXd left_of(const VectorXd& vector, const VectorXd& combination) const {
    VectorXd left = vector;
    for (Index k = 0; k < size(); ++k) {
      const Index j = order_[static_cast<std::size_t>(k)];
      p_.view().add(j, -combination[k] * p_.inverse_norm(j), left.data());
    }
    return left;
  }

  const ScaledColumns& p_;
  Products products_;
  GramCholesky factor_;
  MatrixXd cross_;
  bool corrected_ = false;
};

}  // namespace

std::unique_ptr<PassiveColumns> make_gram_columns(const ScaledColumns& problem) {
  return std::make_unique<GramColumns>(problem);
}

}  // namespace luxrig
