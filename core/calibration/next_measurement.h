#pragma once
/// Which measurement helps most: the one after which the light at the goals is known best (A-optimal).

#include <Eigen/Core>
#include <span>
#include <vector>

namespace luxrig {

/// Measurements that are taken together, such as every lamp alone at one place.
struct MeasurementGroup {
  std::vector<Eigen::Index> rows;  ///< of the covariance
  Eigen::VectorXd noise_lx;        ///< standard error of each
};

/// Σ_t weight_t · variance of target t after this group, from a covariance of targets and measurements
/// (LightUnknowns::covariance). targets: rows of it.
[[nodiscard]] double error_after(const Eigen::MatrixXd& covariance, std::span<const Eigen::Index> targets,
                                 const Eigen::VectorXd& weight, const MeasurementGroup& group);

/// The covariance once the group is measured.
void take(const MeasurementGroup& group, Eigen::MatrixXd& covariance);

/// Up to `count` groups, each the best after those before it; fewer if there are no more.
[[nodiscard]] std::vector<std::size_t> best_groups(Eigen::MatrixXd covariance, std::span<const Eigen::Index> targets,
                                                   const Eigen::VectorXd& weight,
                                                   std::span<const MeasurementGroup> groups, std::size_t count);

}  // namespace luxrig
