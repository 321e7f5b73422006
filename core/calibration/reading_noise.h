#pragma once
/// Covariance of what the unknowns do not explain of readings: the noise of each, and a rest that only readings at the
/// same place share. So it falls into blocks, one for each place.

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <functional>
#include <map>
#include <vector>

namespace luxrig {

class ReadingNoise {
 public:
  /// place: per reading. rest: covariance of two readings at the same place. variance: of each reading's noise, > 0.
  ReadingNoise(const std::vector<std::size_t>& place, const std::function<double(Eigen::Index, Eigen::Index)>& rest,
               Eigen::VectorXd variance);
  ReadingNoise() = default;

  /// Its inverse times these columns: readings × any.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& columns) const;
  /// Variance of this sum of readings that the noise makes, and that the rest makes.
  [[nodiscard]] double noise_variance(const Eigen::VectorXd& weight) const { return weight.cwiseAbs2().dot(variance_); }
  [[nodiscard]] double rest_variance(const Eigen::VectorXd& weight) const;
  /// Readings at a place.
  [[nodiscard]] const std::vector<Eigen::Index>& at(std::size_t place) const;

 private:
  struct Block {
    std::vector<Eigen::Index> readings;
    Eigen::MatrixXd rest;
    Eigen::LLT<Eigen::MatrixXd> whole;
  };
  std::map<std::size_t, Block> blocks_;  ///< by place
  Eigen::VectorXd variance_;
};

}  // namespace luxrig
