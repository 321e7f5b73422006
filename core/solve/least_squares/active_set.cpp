#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "core/solve/least_squares/limited_methods.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Multipliers nearer to zero than this (‖f‖ and the columns are about 1) are rounding.
constexpr double kMultiplierTolerance = 1e-14;
/// A constraint whose rate along a unit step is below this does not block it.
constexpr double kRateTolerance = 1e-14;

class ActiveSet {
 public:
  ActiveSet(const LimitedLeastSquares& problem, LimitedLeastSquaresResult start) : p_(problem), at_(std::move(start)) {
    if (at_.z.size() == 0) {
      // Many steps follow, so E = Q R once; afterwards only R and Qᵀ f are needed.
      const Eigen::HouseholderQR<MatrixXd> qr(p_.E);
      const Index n = p_.E.cols();
      const VectorXd turned = qr.householderQ().adjoint() * p_.f;
      r_ = qr.matrixQR().topRows(n).triangularView<Eigen::Upper>();
      q_ = turned.head(n);
      at_.z = VectorXd::Zero(n);
      at_.state.assign(static_cast<std::size_t>(n), BoundState::lower);
      stationary_ = true;  // nothing is free
    } else {
      r_ = p_.E;
      q_ = p_.f;
    }
    refused_bound_.assign(at_.state.size(), false);
    refused_row_.assign(static_cast<std::size_t>(p_.G.rows()), false);
  }

  LimitedLeastSquaresResult solve(const std::stop_token& stop) {
    const auto size = static_cast<int>(std::min<Index>(p_.E.cols() + p_.G.rows(), 1'000'000));
    const int most = at_.iterations + 200 + 50 * size;
    int without_progress = 0;
    for (; at_.iterations < most; ++at_.iterations) {
      if (stop.stop_requested()) {
        at_.stopped = true;
        return at_;
      }
      // Bland's rule (least index) once the vertex looks degenerate; it cannot cycle.
      const bool min_index = without_progress > 2 * size;
      if (stationary_ && !release(min_index)) {
        at_.converged = true;
        return at_;
      }
      const double moved = step(min_index);
      if (moved > 1e-15) {
        without_progress = 0;
        released_ = Released{};
        std::fill(refused_bound_.begin(), refused_bound_.end(), false);
        std::fill(refused_row_.begin(), refused_row_.end(), false);
      } else {
        ++without_progress;
      }
    }
    return at_;
  }

 private:
  struct Released {
    Index bound = -1, row = -1;
  };

  /// Releases the constraint with the worst multiplier; false when all have the right sign: z is then the optimum.
  bool release(bool min_index) {
    const VectorXd gradient = r_.transpose() * (r_ * at_.z - q_);
    const VectorXd multiplier = row_multipliers(p_.G, at_, gradient);
    VectorXd total = gradient;
    for (std::size_t k = 0; k < at_.working_rows.size(); ++k)
      total += multiplier[static_cast<Index>(k)] * p_.G.row(at_.working_rows[k]).transpose();
    double worst = kMultiplierTolerance;
    released_ = Released{};
    std::size_t place = 0;
    for (std::size_t j = 0; j < at_.state.size(); ++j) {
      if (at_.state[j] == BoundState::free || refused_bound_[j] || !(p_.upper[static_cast<Index>(j)] > 0)) continue;
      const double wrong =
          at_.state[j] == BoundState::lower ? -total[static_cast<Index>(j)] : total[static_cast<Index>(j)];
      if (wrong <= worst) continue;
      released_ = Released{static_cast<Index>(j), -1};
      if (min_index) break;
      worst = wrong;
    }
    if (!(min_index && released_.bound >= 0)) {
      Index least = p_.G.rows();
      for (std::size_t k = 0; k < at_.working_rows.size(); ++k) {
        const Index row = at_.working_rows[k];
        const double wrong = -multiplier[static_cast<Index>(k)];
        if (refused_row_[static_cast<std::size_t>(row)] || wrong <= worst || (min_index && row > least)) continue;
        released_ = Released{-1, row};
        place = k;
        least = row;
        if (!min_index) worst = wrong;
      }
    }
    if (released_.bound >= 0) {
      at_.state[static_cast<std::size_t>(released_.bound)] = BoundState::free;
      return true;
    }
    if (released_.row >= 0) {
      at_.working_rows.erase(at_.working_rows.begin() + static_cast<std::ptrdiff_t>(place));
      return true;
    }
    return false;
  }

  /// Step to the minimum over the free variables, with the working rows kept.
  [[nodiscard]] VectorXd direction(const std::vector<Index>& free) {
    VectorXd whole = VectorXd::Zero(at_.z.size());
    if (free.empty()) return whole;
    std::vector<Index> touched;
    for (Index i = 0; i < r_.rows(); ++i)
      if ((r_.row(i)(free).array() != 0).any()) touched.push_back(i);
    const MatrixXd objective = r_(touched, free);
    const VectorXd rest = (q_ - r_ * at_.z)(touched);
    VectorXd part;
    if (at_.working_rows.empty()) {
      part = objective.householderQr().solve(rest);
    } else {
      const MatrixXd rows = p_.G(at_.working_rows, free).transpose();
      Eigen::ColPivHouseholderQR<MatrixXd> qr;
      qr.setThreshold(1e-12);
      qr.compute(rows);
      const Index rank = qr.rank();
      if (rank < rows.cols()) {  // rounding made rows dependent: the remaining ones follow from the others
        std::vector<Index> kept;
        for (Index k = 0; k < rank; ++k)
          kept.push_back(at_.working_rows[static_cast<std::size_t>(qr.colsPermutation().indices()[k])]);
        at_.working_rows = std::move(kept);
      }
      const Index left = rows.rows() - rank;
      if (left == 0) return whole;
      const MatrixXd q = qr.householderQ();
      const MatrixXd null_space = q.rightCols(left);
      part = null_space * (objective * null_space).householderQr().solve(rest);
    }
    if (part.allFinite()) whole(free) = part;
    return whole;
  }

  /// Goes as far as the constraints allow and adds the blocking one. Returns the length of the step.
  double step(bool min_index) {
    const std::vector<Index> free = free_variables(at_.state);
    const VectorXd p = direction(free);
    const double length = p.cwiseAbs().size() == 0 ? 0 : p.cwiseAbs().maxCoeff();
    double share = 1, rate_best = 0;
    Index bound = -1, row = -1;
    const auto better = [&](double here, double rate) {
      if (here >= 1) return false;
      if (bound < 0 && row < 0) return true;
      if (min_index) return here < share;
      return here < share || (here == share && rate > rate_best);
    };
    for (const Index j : free) {
      const double rate = std::abs(p[j]);
      if (rate <= kRateTolerance * length || (p[j] > 0 && std::isinf(p_.upper[j]))) continue;
      const double room = p[j] < 0 ? at_.z[j] : p_.upper[j] - at_.z[j];
      const double here = std::max(0.0, room) / rate;
      if (!better(here, rate)) continue;
      share = here;
      rate_best = rate;
      bound = j;
    }
    if (length > 0 && p_.G.rows() > 0) {
      const VectorXd rates = p_.G * p;
      const VectorXd used = p_.G * at_.z;
      for (Index i = 0; i < p_.G.rows(); ++i) {
        if (rates[i] <= kRateTolerance * length) continue;
        if (std::find(at_.working_rows.begin(), at_.working_rows.end(), i) != at_.working_rows.end()) continue;
        const double here = std::max(0.0, p_.slack[i] - used[i]) / rates[i];
        if (!better(here, rates[i])) continue;
        share = here;
        rate_best = rates[i];
        row = i;
        bound = -1;
      }
    }
    at_.z = (at_.z + share * p).cwiseMax(0.0).cwiseMin(p_.upper);
    stationary_ = bound < 0 && row < 0;
    if (bound >= 0) {
      const bool low = p[bound] < 0;
      at_.z[bound] = low ? 0 : p_.upper[bound];
      at_.state[static_cast<std::size_t>(bound)] = low ? BoundState::lower : BoundState::upper;
    }
    if (row >= 0) at_.working_rows.push_back(row);
    // A constraint that was released and came back at once had a rounding-sized multiplier: it stays until something
    // moves.
    if (share * length <= 1e-15) {
      if (released_.bound >= 0 && (bound == released_.bound || stationary_))
        refused_bound_[static_cast<std::size_t>(released_.bound)] = true;
      if (released_.row >= 0 && (row == released_.row || stationary_))
        refused_row_[static_cast<std::size_t>(released_.row)] = true;
    }
    return share * length;
  }

  const LimitedLeastSquares& p_;
  MatrixXd r_;
  VectorXd q_;
  LimitedLeastSquaresResult at_;
  bool stationary_ = false;
  Released released_;
  std::vector<bool> refused_bound_, refused_row_;
};

}  // namespace

LimitedLeastSquaresResult solve_by_active_set(const LimitedLeastSquares& problem, const std::stop_token& stop,
                                              LimitedLeastSquaresResult start) {
  return ActiveSet(problem, std::move(start)).solve(stop);
}

}  // namespace luxrig
