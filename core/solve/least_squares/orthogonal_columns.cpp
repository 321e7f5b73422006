#include <cmath>

#include "core/solve/least_squares/passive_columns.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Thin Q by Gram-Schmidt with reorthogonalisation (Daniel, Gragg, Kaufman & Stewart 1976), which also gives a column's
/// distance from the span. Columns leave by Givens rotations.
class OrthogonalColumns final : public PassiveColumns {
 public:
  explicit OrthogonalColumns(const ScaledColumns& problem)
      : p_(problem), weight_(problem.squared_weight().cwiseSqrt()) {}

  std::vector<char> append(std::span<const Index> columns) override {
    std::vector<char> taken;
    for (const Index column : columns) taken.push_back(append_one(column) ? 1 : 0);
    return taken;
  }

  void remove(std::span<const Index> places) override {
    for (std::size_t k = places.size(); k-- > 0;) remove_one(places[k]);
    forget(places);
  }

  [[nodiscard]] Step step(const VectorXd& residual) const override {
    Step step;
    step.d = q_.leftCols(held_).transpose() * weight_.cwiseProduct(residual);
    step.gain = step.d.squaredNorm();
    r_.topLeftCorner(held_, held_).triangularView<Eigen::Upper>().solveInPlace(step.d);
    return step;
  }

 private:
  bool append_one(Index column) {
    const Index p = held_;
    if (p >= p_.rows()) return false;
    if (p == q_.cols()) {
      const Index wanted = std::min(p_.rows(), 2 * p + 8);
      q_.conservativeResize(p_.rows(), wanted);
      r_.conservativeResize(wanted, wanted);
    }
    const auto q = q_.leftCols(p);
    VectorXd rest = VectorXd::Zero(p_.rows());
    p_.view().add(column, p_.inverse_norm(column), rest.data());
    rest.array() *= weight_.array();
    // A third pass if most of the column has cancelled: otherwise the rest may not be orthogonal to working accuracy.
    VectorXd along = VectorXd::Zero(p);
    double distance = 1;
    for (int pass = 0; pass < 3; ++pass) {
      const VectorXd more = q.transpose() * rest;
      rest.noalias() -= q * more;
      along += more;
      distance = rest.norm();
      if (!(distance > kNearestToSpan)) return false;
    }
    r_.col(p).head(p) = along;
    r_(p, p) = distance;
    q_.col(p) = rest / distance;
    order_.push_back(column);
    ++held_;
    return true;
  }

  void remove_one(Index place) {
    for (Index k = place; k + 1 < held_; ++k) r_.col(k).head(k + 2) = r_.col(k + 1).head(k + 2);
    --held_;
    for (Index k = place; k < held_; ++k) {
      const double a = r_(k, k), b = r_(k + 1, k);
      const double length = std::sqrt(a * a + b * b);
      if (length == 0) continue;
      const double c = a / length, s = b / length;
      for (Index j = k; j < held_; ++j) {
        const double high = r_(k, j), low = r_(k + 1, j);
        r_(k, j) = c * high + s * low;
        r_(k + 1, j) = c * low - s * high;
      }
      for (Index i = 0; i < q_.rows(); ++i) {
        const double left = q_(i, k), right = q_(i, k + 1);
        q_(i, k) = c * left + s * right;
        q_(i, k + 1) = c * right - s * left;
      }
    }
  }

  const ScaledColumns& p_;
  VectorXd weight_;
  MatrixXd q_, r_;
  Index held_ = 0;  ///< columns in the factor
};

}  // namespace

std::unique_ptr<PassiveColumns> make_orthogonal_columns(const ScaledColumns& problem) {
  return std::make_unique<OrthogonalColumns>(problem);
}

}  // namespace luxrig
