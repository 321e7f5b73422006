#include "core/solve/limited_least_squares.h"

#include <algorithm>
#include <cmath>

#include "core/solve/free_step.h"
#include "core/solve/limited_start.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Multipliers nearer to zero than this (‖f‖ and the columns are about 1) are rounding.
constexpr double kMultiplierTolerance = 1e-14;
/// Unknowns from which on a start beside the optimum pays (`luxrig bench nnls --only levels`).
constexpr Index kMany = 100;
/// Beside a start that many constraints leave undecided, multipliers above the tie's own size are rounding, too: KKT
/// stays good to it.
constexpr double kTieTolerance = 1e-11;
constexpr int kMostOfTie = 60, kMostIdle = 200;
/// Rounds in which a start's constraints change together before they change one at a time.
constexpr int kMostTogether = 12;

class ActiveSet {
 public:
  ActiveSet(const LimitedLeastSquares& problem, FreeStep& free_step) : p_(problem), free_step_(free_step) {
    at_.z = VectorXd::Zero(p_.E.cols());
    at_.state.assign(static_cast<std::size_t>(p_.E.cols()), BoundState::lower);
    refused_bound_.assign(static_cast<std::size_t>(p_.E.cols()), false);
    refused_row_.assign(static_cast<std::size_t>(p_.G.rows()), false);
    follows_.assign(static_cast<std::size_t>(p_.G.rows()), 0);
  }

  void start_from(LimitedStart start) {
    at_.z = std::move(start.z);
    at_.state = std::move(start.state);
    at_.working_rows = std::move(start.rows);
    at_.iterations = start.iterations;
    stationary_ = false;
    started_ = true;
    settle();
    steps_of_start_ = at_.iterations;
  }

  LimitedLeastSquaresResult solve(const std::stop_token& stop) {
    const auto size = static_cast<int>(std::min<Index>(p_.E.cols() + p_.G.rows(), 1'000'000));
    const int most = 200 + 50 * size;
    int without_progress = 0;
    for (; at_.iterations < most; ++at_.iterations) {
      if (stop.stop_requested()) {
        at_.stopped = true;
        return at_;
      }
      if (started_ && at_.iterations > steps_of_start_ + kMostOfTie) tolerance_ = kTieTolerance;
      if (started_ && without_progress > kMostIdle) break;
      // Bland's rule (least index) once the vertex looks degenerate: it cannot cycle.
      const bool least_index = without_progress > 2 * size;
      if (stationary_ && !release(least_index)) {
        at_.converged = !started_ || p_.G.rows() == 0 || (p_.G * at_.z - p_.slack).maxCoeff() < 1e-12;
        return at_;
      }
      const double moved = step(least_index);
      if (std::isnan(moved)) break;
      if (moved > 1e-15) {
        without_progress = 0;
        released_ = Released{};
        std::fill(refused_bound_.begin(), refused_bound_.end(), false);
        std::fill(refused_row_.begin(), refused_row_.end(), false);
        std::fill(follows_.begin(), follows_.end(), 0);
      } else {
        ++without_progress;
      }
    }
    at_.multiplier = VectorXd::Zero(static_cast<Index>(at_.working_rows.size()));  // none that prove anything
    return at_;
  }

 private:
  struct Released {
    Index bound = -1, row = -1;
  };

  /// Beside the optimum constraints may change all at once (M. Hintermüller, K. Ito, K. Kunisch, 2002), as long as
  /// ever fewer want to; if that does not end, all stays as it was.
  void settle() {
    const LimitedLeastSquaresResult start = at_;
    std::size_t fewest = at_.state.size() + static_cast<std::size_t>(p_.G.rows()) + 1;
    for (int round = 0; round < kMostTogether; ++round, ++at_.iterations) {
      const VectorXd p = free_step_.direction(at_, free_variables(at_.state));
      if (!p.allFinite()) break;
      at_.z += p;
      const std::size_t changed = change_together();
      if (changed == 0) return;
      if (changed >= fewest) break;
      fewest = changed;
    }
    at_ = start;
  }

  /// Sets z to the bounds that it is beyond, and lets go what pulls the other way. Returns how many.
  std::size_t change_together() {
    const VectorXd gradient = free_step_.gradient(at_.z), over = p_.G * at_.z - p_.slack;
    const VectorXd multiplier = free_step_.multipliers(at_, gradient);
    VectorXd total = gradient;
    std::vector<Index> rows;
    std::size_t changed = 0;
    std::vector<char> working(static_cast<std::size_t>(p_.G.rows()), 0);
    for (std::size_t k = 0; k < at_.working_rows.size(); ++k) {
      const Index i = at_.working_rows[k];
      working[static_cast<std::size_t>(i)] = 1;
      total += multiplier[static_cast<Index>(k)] * p_.G.row(i).transpose();
      if (multiplier[static_cast<Index>(k)] >= -kMultiplierTolerance) rows.push_back(i);
    }
    changed += at_.working_rows.size() - rows.size();
    for (Index i = 0; i < over.size(); ++i) {
      if (working[static_cast<std::size_t>(i)] || !(over[i] > 1e-13)) continue;
      rows.push_back(i);
      ++changed;
    }
    at_.working_rows = std::move(rows);
    for (Index j = 0; j < at_.z.size(); ++j) {
      BoundState& state = at_.state[static_cast<std::size_t>(j)];
      const double upper = p_.upper[j];
      if (!(upper > 0)) continue;
      const BoundState before = state;
      if (state == BoundState::free && at_.z[j] < 0)
        state = BoundState::lower;
      else if (state == BoundState::free && at_.z[j] > upper)
        state = BoundState::upper;
      else if ((state == BoundState::lower && total[j] < -kMultiplierTolerance) ||
               (state == BoundState::upper && total[j] > kMultiplierTolerance))
        state = BoundState::free;
      at_.z[j] = state == BoundState::lower ? 0 : state == BoundState::upper ? upper : at_.z[j];
      changed += state != before ? 1 : 0;
    }
    return changed;
  }

  /// Lets go the constraint with the worst multiplier; false when all have the right sign: then z is the optimum.
  bool release(bool least_index) {
    const VectorXd gradient = free_step_.gradient(at_.z);
    at_.multiplier = free_step_.multipliers(at_, gradient);
    const VectorXd& multiplier = at_.multiplier;
    VectorXd total = gradient;
    for (std::size_t k = 0; k < at_.working_rows.size(); ++k)
      total += multiplier[static_cast<Index>(k)] * p_.G.row(at_.working_rows[k]).transpose();
    double worst = tolerance_;
    released_ = Released{};
    std::size_t place = 0;
    for (std::size_t j = 0; j < at_.state.size(); ++j) {
      if (at_.state[j] == BoundState::free || refused_bound_[j] || !(p_.upper[static_cast<Index>(j)] > 0)) continue;
      const double wrong =
          at_.state[j] == BoundState::lower ? -total[static_cast<Index>(j)] : total[static_cast<Index>(j)];
      if (wrong <= worst) continue;
      released_ = Released{static_cast<Index>(j), -1};
      if (least_index) break;
      worst = wrong;
    }
    if (!(least_index && released_.bound >= 0)) {
      Index least = p_.G.rows();
      for (std::size_t k = 0; k < at_.working_rows.size(); ++k) {
        const Index row = at_.working_rows[k];
        const double wrong = -multiplier[static_cast<Index>(k)];
        if (refused_row_[static_cast<std::size_t>(row)] || wrong <= worst || (least_index && row > least)) continue;
        released_ = Released{-1, row};
        place = k;
        least = row;
        if (!least_index) worst = wrong;
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

  /// Goes as far as the constraints allow and takes up the one that blocks. Returns the length gone.
  double step(bool least_index) {
    const std::vector<Index> free = free_variables(at_.state);
    const std::vector<Index> rows_before = at_.working_rows;
    const VectorXd p = free_step_.direction(at_, free);
    if (!p.allFinite()) return std::nan("");  // the factor has broken down
    // A row that follows from those held would block at once, and be let go again, for ever.
    if (started_ && at_.working_rows.size() < rows_before.size()) {
      for (const Index i : rows_before) follows_[static_cast<std::size_t>(i)] = 1;
      for (const Index i : at_.working_rows) follows_[static_cast<std::size_t>(i)] = 0;
    }
    const double rate_tolerance = free_step_.rate_tolerance();
    const double length = p.cwiseAbs().size() == 0 ? 0 : p.cwiseAbs().maxCoeff();
    double share = 1, rate_best = 0;
    Index bound = -1, row = -1;
    const auto better = [&](double here, double rate) {
      if (here >= 1) return false;
      if (bound < 0 && row < 0) return true;
      if (least_index) return here < share;
      return here < share || (here == share && rate > rate_best);
    };
    for (const Index j : free) {
      const double rate = std::abs(p[j]);
      if (rate <= rate_tolerance * length || (p[j] > 0 && std::isinf(p_.upper[j]))) continue;
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
      std::vector<char> working(static_cast<std::size_t>(p_.G.rows()), 0);
      for (const Index i : at_.working_rows) working[static_cast<std::size_t>(i)] = 1;
      for (Index i = 0; i < p_.G.rows(); ++i) {
        if (rates[i] <= rate_tolerance * length) continue;
        if (working[static_cast<std::size_t>(i)] || follows_[static_cast<std::size_t>(i)]) continue;
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
    // What was let go and at once came back had a multiplier of rounding: it stays until something moves.
    if (share * length <= 1e-15) {
      if (released_.bound >= 0 && (bound == released_.bound || stationary_))
        refused_bound_[static_cast<std::size_t>(released_.bound)] = true;
      if (released_.row >= 0 && (row == released_.row || stationary_))
        refused_row_[static_cast<std::size_t>(released_.row)] = true;
    }
    return share * length;
  }

  const LimitedLeastSquares& p_;
  FreeStep& free_step_;
  LimitedLeastSquaresResult at_;
  bool stationary_ = true;  ///< at z = 0 nothing is free
  bool started_ = false;
  int steps_of_start_ = 0;
  double tolerance_ = kMultiplierTolerance;
  Released released_;
  std::vector<bool> refused_bound_, refused_row_;
  std::vector<char> follows_;  ///< rows that those held imply, until something moves
};

/// From a start beside the optimum; without converged where products of columns are too coarse for it.
LimitedLeastSquaresResult solve_many(const LimitedLeastSquares& problem, const std::stop_token& stop) {
  const ColumnProducts products = column_products(problem);
  LimitedStart start = limited_start(problem, products, stop);
  const auto step = make_gram_step(problem, products);
  ActiveSet search(problem, *step);
  search.start_from(std::move(start));
  return search.solve(stop);
}

}  // namespace

std::vector<Index> free_variables(const std::vector<BoundState>& state) {
  std::vector<Index> free;
  for (std::size_t j = 0; j < state.size(); ++j)
    if (state[j] == BoundState::free) free.push_back(static_cast<Index>(j));
  return free;
}

LimitedLeastSquares tie_in_rows(LimitedLeastSquares problem) {
  if (problem.tie == 0) return problem;
  const Index rows = problem.E.rows(), n = problem.E.cols();
  problem.E.conservativeResize(rows + n, n);
  problem.E.bottomRows(n) = problem.tie * MatrixXd::Identity(n, n);
  problem.f.conservativeResize(rows + n);
  problem.f.tail(n) = problem.tie * problem.near;
  problem.tie = 0;
  return problem;
}

LimitedLeastSquaresResult solve_limited_least_squares(const LimitedLeastSquares& problem, const std::stop_token& stop) {
  if (problem.E.cols() == 0) {
    LimitedLeastSquaresResult none;
    none.z.resize(0);
    none.converged = true;
    return none;
  }
  if (problem.tie > 0 && problem.E.cols() >= kMany) {
    LimitedLeastSquaresResult result = solve_many(problem, stop);
    if (result.converged || result.stopped) return result;
  }
  const LimitedLeastSquares rows = tie_in_rows(problem);
  const auto step = make_orthogonal_step(rows);
  return ActiveSet(rows, *step).solve(stop);
}

}  // namespace luxrig
