#include "core/calibration/next_measurement.h"

#include <Eigen/Cholesky>
#include <limits>

#include "core/check.h"

namespace luxrig {

using Eigen::Index;
using Eigen::LDLT;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

LDLT<MatrixXd> innovation_of(const MatrixXd& covariance, const MeasurementGroup& group) {
  LUXRIG_CHECK(static_cast<Index>(group.rows.size()) == group.noise_lx.size(), "{} measurements, {} noises",
               group.rows.size(), group.noise_lx.size());
  MatrixXd innovation = covariance(group.rows, group.rows);
  innovation.diagonal() += group.noise_lx.cwiseAbs2();
  return innovation.ldlt();
}

}  // namespace

double error_after(const MatrixXd& covariance, std::span<const Index> targets, const VectorXd& weight,
                   const MeasurementGroup& group) {
  const std::vector<Index> of(targets.begin(), targets.end());
  const MatrixXd shared = covariance(group.rows, of);
  const MatrixXd solved = innovation_of(covariance, group).solve(shared);
  double error = 0;
  for (Index t = 0; t < weight.size(); ++t) {
    const Index row = of[static_cast<std::size_t>(t)];
    error += weight[t] * (covariance(row, row) - shared.col(t).dot(solved.col(t)));
  }
  return error;
}

void take(const MeasurementGroup& group, MatrixXd& covariance) {
  const MatrixXd shared = covariance(group.rows, Eigen::indexing::all);
  covariance -= shared.transpose() * innovation_of(covariance, group).solve(shared);
}

std::vector<std::size_t> best_groups(MatrixXd covariance, std::span<const Index> targets, const VectorXd& weight,
                                     std::span<const MeasurementGroup> groups, std::size_t count) {
  std::vector<std::size_t> chosen;
  std::vector<bool> taken(groups.size(), false);
  while (chosen.size() < std::min(count, groups.size())) {
    double least = std::numeric_limits<double>::infinity();
    std::size_t best = groups.size();
    for (std::size_t g = 0; g < groups.size(); ++g) {
      if (taken[g]) continue;
      const double error = error_after(covariance, targets, weight, groups[g]);
      if (error < least) {
        least = error;
        best = g;
      }
    }
    if (best == groups.size()) break;
    taken[best] = true;
    chosen.push_back(best);
    take(groups[best], covariance);
  }
  return chosen;
}

}  // namespace luxrig
