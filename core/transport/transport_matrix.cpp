#include "core/check.h"
#include "core/transport/evaluator.h"
#include "core/transport/replicate_error.h"

namespace luxrig {

Eigen::VectorXd TransportMatrix::standard_error_lux(const Eigen::VectorXd& levels) const {
  LUXRIG_CHECK(levels.size() == emitters(), "{} levels for {} emitters", levels.size(), emitters());
  if (replicates.size() < 2) return Eigen::VectorXd::Zero(receivers());
  std::vector<Eigen::VectorXd> lux_of_replicate;
  lux_of_replicate.reserve(replicates.size());
  for (const Eigen::MatrixXd& replicate : replicates) lux_of_replicate.emplace_back(replicate * levels);
  Eigen::VectorXd error_lx(receivers());
  std::vector<double> values(replicates.size());
  for (Eigen::Index r = 0; r < receivers(); ++r) {
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = lux_of_replicate[k][r];
    error_lx[r] = standard_error_of_mean(values);
  }
  return error_lx;
}

}  // namespace luxrig
