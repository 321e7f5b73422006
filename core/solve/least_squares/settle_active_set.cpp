#include <Eigen/Cholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "core/solve/least_squares/limited_methods.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMaxSettlingRounds = 30, kRefinements = 3;
/// Multipliers and rooms nearer to 0 than this are rounding.
constexpr double kRoundingOfSigns = 1e-14, kRoundingOfRows = 1e-13;
/// A row depends on earlier rows if its squared remainder after them is below this share of its square.
constexpr double kFollows = 1e-12;

/// EᵀE. Spots reach few points each; a row of one entry, as in the tie term, only adds to the diagonal.
MatrixXd products_of_columns(const MatrixXd& E) {
  const double filled = static_cast<double>((E.array() != 0).count());
  if (filled < 0.1 * static_cast<double>(E.size())) {
    const Eigen::SparseMatrix<double> sparse = E.sparseView();
    return MatrixXd(Eigen::SparseMatrix<double>(sparse.transpose() * sparse));
  }
  MatrixXd gram = MatrixXd::Zero(E.cols(), E.cols());
  std::vector<Index> full;
  for (Index i = 0; i < E.rows(); ++i) {
    if ((E.row(i).array() != 0).count() > 1)
      full.push_back(i);
    else
      gram.diagonal() += E.row(i).cwiseAbs2().transpose();
  }
  gram.selfadjointView<Eigen::Lower>().rankUpdate(MatrixXd(E(full, Eigen::all)).transpose());
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  return gram;
}

class Settling {
 public:
  Settling(const LimitedLeastSquares& problem, LimitedLeastSquaresResult& at)
      : p_(problem), at_(at), gram_(products_of_columns(problem.E)) {}

  bool run(const std::stop_token& stop) {
    std::size_t fewest = at_.state.size() + static_cast<std::size_t>(p_.G.rows()) + 1;
    int idle = 0;
    for (int round = 0; round < kMaxSettlingRounds && idle < 6 && !stop.stop_requested(); ++round) {
      ++at_.iterations;
      if (!solve()) return false;
      const std::size_t changed = change();
      if (changed == 0) {
        at_.converged = kkt_violation(p_, at_, multiplier_) <= kVerified;
        return at_.converged;
      }
      idle = changed < fewest ? 0 : idle + 1;
      fewest = std::min(fewest, changed);
    }
    return false;
  }

 private:
  /// Solves for z and multipliers: free unknowns are optimal with the working rows kept, the rest is at its bounds.
  bool solve() {
    for (std::size_t j = 0; j < at_.state.size(); ++j) {
      const auto k = static_cast<Index>(j);
      if (at_.state[j] != BoundState::free) at_.z[k] = at_.state[j] == BoundState::lower ? 0 : p_.upper[k];
    }
    const std::vector<Index> free = free_variables(at_.state);
    multiplier_.setZero(static_cast<Index>(at_.working_rows.size()));
    if (free.empty()) return at_.working_rows.empty();
    const Eigen::LLT<MatrixXd> factor(gram_(free, free));
    if (factor.info() != Eigen::Success) return false;
    const MatrixXd rows = p_.G(at_.working_rows, free).transpose();
    const MatrixXd seen = rows.cols() > 0 ? MatrixXd(factor.matrixL().solve(rows)) : rows;  // Eigen reads empty ones
    const MatrixXd products = seen.transpose() * seen;
    const Eigen::LLT<MatrixXd> of_rows(products);
    if (rows.cols() > 0) {
      if (of_rows.info() != Eigen::Success) return false;
      const VectorXd pivot = of_rows.matrixLLT().diagonal();
      if ((pivot.cwiseAbs2().array() < kFollows * products.diagonal().array()).any()) return false;
    }
    for (int round = 0; round < kRefinements; ++round) {
      pull_ = p_.E.transpose() * (p_.f - p_.E * at_.z);
      for (std::size_t k = 0; k < at_.working_rows.size(); ++k)
        pull_ -= multiplier_[static_cast<Index>(k)] * p_.G.row(at_.working_rows[k]).transpose();
      VectorXd step = factor.matrixL().solve(VectorXd(pull_(free)));
      if (rows.cols() > 0) {
        const VectorXd room = (p_.slack - p_.G * at_.z)(at_.working_rows);
        const VectorXd more = of_rows.solve(seen.transpose() * step - room);
        step -= seen * more;
        multiplier_ += more;
      }
      factor.matrixU().solveInPlace(step);
      at_.z(free) += step;
    }
    return at_.z.allFinite() && multiplier_.allFinite();
  }

  /// Fixes unknowns beyond their bounds, adds violated rows and releases constraints with a wrong sign. Returns the
  /// number of changes.
  std::size_t change() {
    pull_ = p_.E.transpose() * (p_.f - p_.E * at_.z);
    std::vector<char> working(static_cast<std::size_t>(p_.G.rows()), 0);
    std::vector<Index> rows;
    for (std::size_t k = 0; k < at_.working_rows.size(); ++k) {
      const Index i = at_.working_rows[k];
      working[static_cast<std::size_t>(i)] = 1;
      pull_ -= multiplier_[static_cast<Index>(k)] * p_.G.row(i).transpose();
      if (multiplier_[static_cast<Index>(k)] >= -kRoundingOfSigns) rows.push_back(i);
    }
    std::size_t changed = at_.working_rows.size() - rows.size();
    const VectorXd over = p_.G * at_.z - p_.slack;
    for (Index i = 0; i < over.size(); ++i) {
      if (working[static_cast<std::size_t>(i)] || over[i] <= kRoundingOfRows) continue;
      rows.push_back(i);
      ++changed;
    }
    at_.working_rows = std::move(rows);
    for (Index j = 0; j < at_.z.size(); ++j) {
      BoundState& state = at_.state[static_cast<std::size_t>(j)];
      const BoundState before = state;
      if (state == BoundState::free)
        state = at_.z[j] < 0 ? BoundState::lower : at_.z[j] > p_.upper[j] ? BoundState::upper : BoundState::free;
      else if (p_.upper[j] > 0 && (state == BoundState::lower ? pull_[j] : -pull_[j]) > kRoundingOfSigns)
        state = BoundState::free;
      changed += state != before ? 1 : 0;
    }
    return changed;
  }

  const LimitedLeastSquares& p_;
  LimitedLeastSquaresResult& at_;
  MatrixXd gram_;
  VectorXd multiplier_, pull_;
};

}  // namespace

bool settle_active_set(const LimitedLeastSquares& problem, LimitedLeastSquaresResult& at, const std::stop_token& stop) {
  return Settling(problem, at).run(stop);
}

}  // namespace luxrig
