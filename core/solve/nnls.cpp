#include "core/solve/nnls.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_set>
#include <vector>

#include "core/check.h"

namespace luxrig {
namespace {

using Index = Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
/// A gradient below this, relative to ‖a_j‖ ‖b‖, is rounding. Columns nearer than this to the span of the passive ones
/// cannot have a larger one, so they never enter, and R's condition stays bounded.
constexpr double kGradientTolerance = 1e-13;
/// Columns this much (in powers of two) shorter than b would need x beyond the range of double; taken as zero.
constexpr int kSmallestColumnExponent = -900;

/// Exponent e with 2^e near ‖v‖, without overflow; nothing usable (INT_MIN) for a zero vector.
int norm_exponent(const Eigen::Ref<const VectorXd>& v) {
  const double largest = v.size() == 0 ? 0 : v.cwiseAbs().maxCoeff();
  if (largest == 0) return std::numeric_limits<int>::min();
  const int e = std::ilogb(largest);
  double squares = 0;
  for (const double value : v) squares += std::ldexp(value, -e) * std::ldexp(value, -e);
  return e + std::ilogb(std::sqrt(squares));
}

/// QR of the passive columns in the order in which they entered: thin Q by Gram-Schmidt, done twice (Daniel, Gragg,
/// Kaufman & Stewart 1976), which also tells how far a column stands from the span; columns leave by Givens rotations.
/// Every step costs O(m p), so thousands of columns are affordable.
class PassiveQr {
 public:
  PassiveQr(Index rows, Index columns) : q_(rows, std::min(rows, columns)), r_(q_.cols(), q_.cols()) {}

  [[nodiscard]] Index size() const { return size_; }
  [[nodiscard]] bool full() const { return size_ == q_.cols(); }

  /// False, and nothing changed, when the column (of norm about 1) lies in the span.
  bool append(const Eigen::Ref<const VectorXd>& column) {
    if (full()) return false;
    const auto q = q_.leftCols(size_);
    VectorXd rest = column;
    VectorXd along = q.transpose() * rest;
    rest.noalias() -= q * along;
    const VectorXd again = q.transpose() * rest;
    rest.noalias() -= q * again;
    const double distance = rest.norm();
    if (distance <= kGradientTolerance * column.norm()) return false;
    // A third pass when most of the column has gone: otherwise rest need not be orthogonal to working accuracy.
    VectorXd third = q.transpose() * rest;
    rest.noalias() -= q * third;
    r_.col(size_).head(size_) = along + again + third;
    r_(size_, size_) = rest.norm();
    q_.col(size_) = rest / rest.norm();
    ++size_;
    return true;
  }

  void remove(Index place) {
    for (Index k = place; k + 1 < size_; ++k) r_.col(k).head(k + 2) = r_.col(k + 1).head(k + 2);
    --size_;
    for (Index k = place; k < size_; ++k) {
      const double a = r_(k, k), b = r_(k + 1, k);
      const double length = std::hypot(a, b);
      if (length == 0) continue;
      const double c = a / length, s = b / length;
      for (Index j = k; j < size_; ++j) {
        const double upper = r_(k, j), lower = r_(k + 1, j);
        r_(k, j) = c * upper + s * lower;
        r_(k + 1, j) = c * lower - s * upper;
      }
      const VectorXd left = q_.col(k);
      q_.col(k) = c * left + s * q_.col(k + 1);
      q_.col(k + 1) = c * q_.col(k + 1) - s * left;
    }
  }

  /// argmin ‖A_P d − residual‖
  [[nodiscard]] VectorXd solve(const VectorXd& residual) const {
    const VectorXd right = q_.leftCols(size_).transpose() * residual;
    return r_.topLeftCorner(size_, size_).triangularView<Eigen::Upper>().solve(right);
  }

 private:
  MatrixXd q_, r_;
  Index size_ = 0;
};

/// Number of a set of columns, by which a set already visited is known again (Zobrist).
std::uint64_t key_of(Index column) {
  std::uint64_t z = (static_cast<std::uint64_t>(column) + 1) * 0x9e3779b97f4a7c15ULL;  // splitmix64
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// The problem with every column and b brought to a norm in [1, 2) by powers of two, which is exact; KKT is judged
/// here.
class ScaledNnls {
 public:
  ScaledNnls(const MatrixXd& A, const VectorXd& b)
      : qr_(A.rows(), A.cols()), a_(A.rows(), A.cols()), exponent_(static_cast<std::size_t>(A.cols())) {
    b_exponent_ = norm_exponent(b);
    b_.resize(b.size());
    for (Index i = 0; i < b.size(); ++i) b_[i] = b_exponent_ == kNone ? 0 : std::ldexp(b[i], -b_exponent_);
    b_norm_ = b_.norm();
    norm_.resize(A.cols());
    for (Index j = 0; j < A.cols(); ++j) {
      int e = norm_exponent(A.col(j));
      if (e != kNone && b_exponent_ != kNone && e - b_exponent_ < kSmallestColumnExponent) e = kNone;
      exponent_[static_cast<std::size_t>(j)] = e;
      for (Index i = 0; i < A.rows(); ++i) a_(i, j) = e == kNone ? 0 : std::ldexp(A(i, j), -e);
      norm_[j] = a_.col(j).norm();
    }
    x_ = VectorXd::Zero(A.cols());
    residual_ = b_;
    passive_.assign(static_cast<std::size_t>(A.cols()), false);
  }

  NnlsResult solve() {
    NnlsResult result;
    const int most = 100 + 30 * static_cast<int>(std::min<Index>(a_.cols(), 10'000'000));
    std::vector<bool> refused(passive_.size(), false);
    std::unordered_set<std::uint64_t> visited{key_};
    double least = residual_.norm();
    result.converged = b_norm_ == 0;
    while (b_norm_ > 0 && result.iterations < most) {
      // Lawson & Hanson's steps 2 to 5: the column whose entry lowers the residual fastest.
      const VectorXd gradient = a_.transpose() * residual_;
      Index entering = -1;
      double best = kGradientTolerance;
      for (Index j = 0; j < a_.cols(); ++j) {
        const auto at = static_cast<std::size_t>(j);
        if (passive_[at] || refused[at] || norm_[j] == 0) continue;
        const double steepness = gradient[j] / (norm_[j] * b_norm_);
        if (steepness > best) {
          best = steepness;
          entering = j;
        }
      }
      if (entering < 0) {
        result.converged = true;
        break;
      }
      ++result.iterations;
      if (!enter(entering)) {
        refused[static_cast<std::size_t>(entering)] = true;
        continue;
      }
      const double now = residual_.norm();
      if (now < least * (1 - 16 * kEpsilon)) {  // real progress: what was refused may be tried again
        least = now;
        refused.assign(refused.size(), false);
        visited.clear();
      }
      // On a plateau of rounding the same set may come back: then what was entered last stays out.
      if (!visited.insert(key_).second) refused[static_cast<std::size_t>(entering)] = true;
    }
    polish();
    result.kkt_residual = violation(x_, residual_);
    result.x.resize(a_.cols());
    for (Index j = 0; j < a_.cols(); ++j) {
      const int e = exponent_[static_cast<std::size_t>(j)];
      result.x[j] = e == kNone || x_[j] == 0 ? 0 : std::ldexp(x_[j], b_exponent_ - e);
    }
    result.residual_norm = b_exponent_ == kNone ? 0 : std::ldexp(residual_.norm(), b_exponent_);
    return result;
  }

 private:
  static constexpr int kNone = std::numeric_limits<int>::min();

  /// Steps 6 to 11. False when the column lies in the span, or would at once be negative (its gradient was rounding).
  bool enter(Index entering) {
    if (!qr_.append(a_.col(entering))) return false;
    order_.push_back(entering);
    VectorXd step = qr_.solve(residual_);
    if (!step.allFinite() || step[qr_.size() - 1] <= 0) {
      qr_.remove(qr_.size() - 1);
      order_.pop_back();
      return false;
    }
    passive_[static_cast<std::size_t>(entering)] = true;
    key_ ^= key_of(entering);
    while (true) {
      double share = 1;
      Index leaving = -1;
      for (std::size_t k = 0; k < order_.size(); ++k) {
        const double x = x_[order_[k]], d = step[static_cast<Index>(k)];
        if (x + d > 0) continue;
        const double here = d < 0 ? x / -d : 0;
        if (leaving < 0 || here < share) {
          share = std::min(here, 1.0);
          leaving = order_[k];
        }
      }
      for (std::size_t k = 0; k < order_.size(); ++k)
        x_[order_[k]] = std::max(0.0, x_[order_[k]] + share * step[static_cast<Index>(k)]);
      if (leaving >= 0) x_[leaving] = 0;
      for (std::size_t k = order_.size(); k-- > 0;)
        if (x_[order_[k]] == 0) leave(k);
      residual_ = b_;
      for (const Index j : order_) residual_.noalias() -= x_[j] * a_.col(j);
      if (leaving < 0) return true;
      if (order_.empty()) return true;
      step = qr_.solve(residual_);
    }
  }

  void leave(std::size_t place) {
    passive_[static_cast<std::size_t>(order_[place])] = false;
    key_ ^= key_of(order_[place]);
    qr_.remove(static_cast<Index>(place));
    order_.erase(order_.begin() + static_cast<std::ptrdiff_t>(place));
  }

  [[nodiscard]] double violation(const VectorXd& x, const VectorXd& residual) const {
    if (b_norm_ == 0) return 0;
    const VectorXd gradient = a_.transpose() * residual;
    double worst = 0;
    for (Index j = 0; j < x.size(); ++j) {
      if (norm_[j] == 0) continue;
      const double w = gradient[j] / (norm_[j] * b_norm_);
      worst = std::max(worst, x[j] > 0 ? std::abs(w) : w);
    }
    return worst;
  }

  /// b − A x, summed in long double: what iterative refinement lives on.
  [[nodiscard]] VectorXd exact_residual(const VectorXd& x) const {
    Eigen::Matrix<long double, Eigen::Dynamic, 1> sum = b_.cast<long double>();
    for (const Index j : order_)
      for (Index i = 0; i < sum.size(); ++i)
        sum[i] -= static_cast<long double>(a_(i, j)) * static_cast<long double>(x[j]);
    return sum.cast<double>();
  }

  void polish() {
    if (order_.empty()) return;
    residual_ = exact_residual(x_);
    double worst = violation(x_, residual_);
    for (int round = 0; round < 5; ++round) {
      const VectorXd step = qr_.solve(residual_);
      if (!step.allFinite()) return;
      VectorXd x = x_;
      for (std::size_t k = 0; k < order_.size(); ++k)
        x[order_[k]] = std::max(0.0, x[order_[k]] + step[static_cast<Index>(k)]);
      const VectorXd residual = exact_residual(x);
      const double now = violation(x, residual);
      if (!(now < worst)) return;
      x_ = x;
      residual_ = residual;
      worst = now;
    }
  }

  PassiveQr qr_;
  MatrixXd a_;
  VectorXd b_, norm_, x_, residual_;
  std::vector<int> exponent_;
  int b_exponent_ = kNone;
  double b_norm_ = 0;
  std::vector<bool> passive_;
  std::vector<Index> order_;  ///< passive columns as they stand in the QR
  std::uint64_t key_ = 0;
};

}  // namespace

NnlsResult solve_nnls(const MatrixXd& A, const VectorXd& b) {
  LUXRIG_CHECK(A.rows() == b.size(), "{} rows, {} right-hand sides", A.rows(), b.size());
  LUXRIG_CHECK(A.allFinite() && b.allFinite(), "entries must be finite");
  return ScaledNnls(A, b).solve();
}

}  // namespace luxrig
