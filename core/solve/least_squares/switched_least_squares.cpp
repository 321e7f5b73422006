#include "core/solve/least_squares/switched_least_squares.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A bound within this share of the best answer counts as no better: otherwise rounding would search all equal
/// settings.
constexpr double kAlike = 1e-9;
/// Distance from one of its two values that counts as rounding.
constexpr double kWhole = 1e-9;

enum class Setting : char { open, off, on };

/// Room of a row below which rounding decides.
double rounding_of(const LimitedLeastSquares& p, Index row) {
  return 64 * static_cast<double>(p.E.cols() + 1) * std::numeric_limits<double>::epsilon() * p.slack[row];
}

class SettingSearch {
 public:
  SettingSearch(const LimitedLeastSquares& problem, const std::vector<Index>& switched, const std::stop_token& stop,
                int max_nodes)
      : switched_(switched), stop_(stop), max_nodes_(max_nodes), reduced_(problem) {
    // ‖E z − f‖² = ‖R z − Qᵀf‖² + a constant: every node then has as many rows as unknowns.
    const Index n = problem.E.cols();
    const Eigen::HouseholderQR<MatrixXd> qr(problem.E);
    reduced_.E = qr.matrixQR().topRows(n).triangularView<Eigen::Upper>();
    reduced_.f = (qr.householderQ().adjoint() * problem.f).head(n);
    found_.on.assign(static_cast<std::size_t>(n), false);
    setting_.assign(switched.size(), Setting::open);
  }

  SwitchedSettings run() {
    found_.proven = true;
    visit();
    return std::move(found_);
  }

 private:
  /// The problem with the settings so far; false when these alone exceed a limit.
  bool build(LimitedLeastSquares& node) const {
    node = reduced_;
    bool any_on = false;
    for (std::size_t k = 0; k < switched_.size(); ++k) {
      if (setting_[k] == Setting::open) continue;
      const Index j = switched_[k];
      if (setting_[k] == Setting::on) {
        node.f -= node.E.col(j) * reduced_.upper[j];
        node.slack -= node.G.col(j) * reduced_.upper[j];
        any_on = true;
      }
      node.upper[j] = 0;
    }
    for (Index i = 0; i < node.slack.size(); ++i) {
      if (any_on && node.slack[i] < rounding_of(reduced_, i)) return false;
    }
    return true;
  }

  void visit() {
    if (found_.stopped || (found_.nodes >= max_nodes_ && best_ < HUGE_VAL)) {
      found_.proven = false;
      return;
    }
    LimitedLeastSquares node;
    if (!build(node)) return;
    const LimitedLeastSquaresResult at = solve_limited_least_squares(node, stop_);
    ++found_.nodes;
    if (at.stopped) {
      found_.stopped = true;
      found_.proven = false;
      return;
    }
    if (found_.relaxed.size() == 0) found_.relaxed = at.z;
    const double error = (node.E * at.z - node.f).norm();
    if (error >= best_ * (1 - kAlike)) return;
    // The unknown furthest from both of its values, weighted by its effect.
    std::size_t next = switched_.size();
    double most = 0;
    for (std::size_t k = 0; k < switched_.size(); ++k) {
      if (setting_[k] != Setting::open) continue;
      const Index j = switched_[k];
      const double upper = reduced_.upper[j];
      const double between = upper > 0 ? std::min(at.z[j], upper - at.z[j]) / upper : 0;
      const double weight = between * upper * reduced_.E.col(j).norm();
      if (between > kWhole && weight > most) {
        most = weight;
        next = k;
      }
    }
    if (next == switched_.size()) {
      settle(at.z, error);
      return;
    }
    branch(next, at.z[switched_[next]] > reduced_.upper[switched_[next]] / 2);
  }

  void branch(std::size_t next, bool on_first) {
    for (const bool on : {on_first, !on_first}) {
      setting_[next] = on ? Setting::on : Setting::off;
      visit();
    }
    setting_[next] = Setting::open;
  }

  /// All are at one of their values, to rounding. Setting them shows whether that keeps the limits.
  void settle(const VectorXd& z, double error) {
    const std::vector<Setting> before = setting_;
    std::size_t last_on = switched_.size();
    for (std::size_t k = 0; k < switched_.size(); ++k) {
      if (before[k] != Setting::open) continue;
      const Index j = switched_[k];
      const bool on = reduced_.upper[j] > 0 && z[j] > reduced_.upper[j] / 2;
      setting_[k] = on ? Setting::on : Setting::off;
      if (on) last_on = k;
    }
    LimitedLeastSquares node;
    const bool within = build(node);
    if (within && error < best_) {
      best_ = error;
      for (std::size_t k = 0; k < switched_.size(); ++k)
        found_.on[static_cast<std::size_t>(switched_[k])] = setting_[k] == Setting::on;
    }
    setting_ = before;
    if (!within && last_on < switched_.size()) branch(last_on, false);  // over a limit by rounding
  }

  const std::vector<Index>& switched_;
  const std::stop_token& stop_;
  int max_nodes_;
  LimitedLeastSquares reduced_;
  std::vector<Setting> setting_;  ///< of each of switched_
  double best_ = HUGE_VAL;
  SwitchedSettings found_;
};

}  // namespace

LimitedLeastSquares with_set(const LimitedLeastSquares& problem, const std::vector<Index>& switched,
                             const std::vector<bool>& on) {
  LimitedLeastSquares left = problem;
  for (const Index j : switched) {
    if (on[static_cast<std::size_t>(j)]) {
      left.f -= left.E.col(j) * left.upper[j];
      left.slack -= left.G.col(j) * left.upper[j];
    }
    left.upper[j] = 0;
  }
  return left;
}

SwitchedSettings solve_switched_least_squares(const LimitedLeastSquares& problem, const std::vector<Index>& switched,
                                              const std::stop_token& stop, int max_nodes) {
  return SettingSearch(problem, switched, stop, max_nodes).run();
}

}  // namespace luxrig
