#include "tools/bench/loop/lamp_groups.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include "core/check.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kOfRounding = 1 + 1e-9;
/// Passes over all lamps of all steps; an exchange must lower the error by this share.
constexpr int kExchangePasses = 4;
constexpr double kLowers = 1e-3;

/// What is known after some steps, as sums that single steps are put into and taken out of.
class Information {
 public:
  explicit Information(const LampDesignProblem& problem)
      : problem_(&problem), weight_(problem.goals.transpose() * problem.goals) {
    sum_ = problem.log_sd.array().square().inverse().matrix().asDiagonal();
  }

  void put(const std::vector<std::size_t>& lit, double sign = 1) {
    for (Index m = 0; m < problem_->lux.rows(); ++m) {
      VectorXd row = VectorXd::Zero(problem_->lux.cols());
      for (const std::size_t lamp : lit) row[static_cast<Index>(lamp)] = problem_->lux(m, static_cast<Index>(lamp));
      const double reading = row.sum();
      const double variance = problem_->noise_share * problem_->noise_share * reading * reading +
                              problem_->noise_lx * problem_->noise_lx +
                              problem_->rest_share * problem_->rest_share * row.squaredNorm();
      sum_.noalias() += sign / variance * row * row.transpose();
    }
  }
  /// Trace of what matters at the goals.
  [[nodiscard]] double error() const {
    const Eigen::LLT<MatrixXd> solver(sum_);
    return solver.info() == Eigen::Success ? solver.solve(weight_).trace() : std::numeric_limits<double>::infinity();
  }

 private:
  const LampDesignProblem* problem_;
  MatrixXd weight_, sum_;
};

bool within_limits(const LampDesignProblem& problem, const std::vector<std::size_t>& lit) {
  for (Index p = 0; p < problem.of_limit.rows(); ++p) {
    double sum = 0;
    for (const std::size_t lamp : lit) sum += problem.of_limit(p, static_cast<Index>(lamp));
    if (sum > kOfRounding) return false;
  }
  return true;
}

LampDesign repeated(const LampDesign& round, std::size_t steps) {
  LampDesign design;
  for (std::size_t k = 0; k < steps && !round.empty(); ++k) design.push_back(round[k % round.size()]);
  return design;
}

/// Light of each lamp at its own meter that others may share.
bool goes_with(const LampDesignProblem& problem, std::vector<std::size_t> lit, std::size_t lamp, double shared) {
  lit.push_back(lamp);
  if (!within_limits(problem, lit)) return false;
  for (const std::size_t each : lit) {
    const auto j = static_cast<Index>(each);
    Index own = 0;
    const double light = problem.lux.col(j).maxCoeff(&own);
    double others = 0;
    for (const std::size_t other : lit)
      if (other != each) others += problem.lux(own, static_cast<Index>(other));
    if (others > shared * light) return false;
  }
  return true;
}

/// Lights or puts out single lamps in single steps while that lowers the error.
void exchange(const LampDesignProblem& problem, LampDesign& design) {
  Information known(problem);
  for (const auto& lit : design) known.put(lit);
  double error = known.error();
  bool better = true;
  for (int pass = 0; pass < kExchangePasses && better; ++pass) {
    better = false;
    for (auto& lit : design)
      for (std::size_t lamp = 0; lamp < static_cast<std::size_t>(problem.lux.cols()); ++lamp) {
        std::vector<std::size_t> other = lit;
        const auto at = std::find(other.begin(), other.end(), lamp);
        if (at != other.end())
          other.erase(at);
        else
          other.push_back(lamp);
        if (!within_limits(problem, other)) continue;
        Information tried = known;
        tried.put(lit, -1);
        tried.put(other);
        const double then = tried.error();
        if (!(then < error * (1 - kLowers))) continue;
        known = tried;
        lit = std::move(other);
        error = then;
        better = true;
      }
  }
}

}  // namespace

double error_after(const LampDesignProblem& problem, const LampDesign& design) {
  LUXRIG_CHECK(problem.log_sd.size() == problem.lux.cols() && problem.goals.cols() == problem.lux.cols() &&
                   (problem.of_limit.size() == 0 || problem.of_limit.cols() == problem.lux.cols()),
               "a problem of {}, {} and {} lamps", problem.lux.cols(), problem.log_sd.size(), problem.goals.cols());
  Information known(problem);
  for (const auto& lit : design) {
    if (!within_limits(problem, lit)) return std::numeric_limits<double>::infinity();
    known.put(lit);
  }
  return known.error();
}

LampDesign one_at_a_time(std::size_t lamps, std::size_t steps) {
  LampDesign round;
  for (std::size_t lamp = 0; lamp < lamps; ++lamp) round.push_back({lamp});
  return repeated(round, steps);
}

LampDesign hadamard_steps(std::size_t lamps, std::size_t steps) {
  const std::size_t order = std::bit_ceil(lamps + 1);
  LampDesign round;
  for (std::size_t row = 1; row < order; ++row) {
    std::vector<std::size_t> lit;
    for (std::size_t lamp = 0; lamp < lamps; ++lamp)
      if (std::popcount(row & (lamp + 1)) % 2 != 0) lit.push_back(lamp);
    round.push_back(std::move(lit));
  }
  return repeated(round, steps);
}

LampDesign packed_by_meters(const LampDesignProblem& problem, std::size_t steps, double shared) {
  LampDesign round;
  for (std::size_t lamp = 0; lamp < static_cast<std::size_t>(problem.lux.cols()); ++lamp) {
    const auto fits = std::find_if(round.begin(), round.end(),
                                   [&](const auto& lit) { return goes_with(problem, lit, lamp, shared); });
    if (fits != round.end())
      fits->push_back(lamp);
    else
      round.push_back({lamp});
  }
  return repeated(round, steps);
}

LampDesign best_design(const LampDesignProblem& problem, std::size_t steps) {
  const auto lamps = static_cast<std::size_t>(problem.lux.cols());
  LampDesign best = one_at_a_time(lamps, steps);
  double least = error_after(problem, best);
  for (LampDesign& design : std::vector<LampDesign>{hadamard_steps(lamps, steps), packed_by_meters(problem, steps),
                                                    packed_by_meters(problem, steps, 1)}) {
    const double error = error_after(problem, design);
    if (!(error < least)) continue;
    least = error;
    best = std::move(design);
  }
  if (least < std::numeric_limits<double>::infinity()) exchange(problem, best);
  return best;
}

}  // namespace luxrig
