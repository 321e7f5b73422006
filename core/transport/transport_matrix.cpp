#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/transport/error_floor.h"
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

TransportMatrix joined_columns(const TransportMatrix& before, const TransportMatrix& anew,
                               std::span<const std::optional<std::size_t>> kept, const EvaluateOptions& options) {
  const auto columns = static_cast<Eigen::Index>(kept.size());
  const auto joined = [&](const Eigen::MatrixXd& old_columns, const Eigen::MatrixXd& new_columns) {
    LUXRIG_CHECK(old_columns.rows() == new_columns.rows(), "columns of {} and of {} receivers", old_columns.rows(),
                 new_columns.rows());
    Eigen::MatrixXd all(old_columns.rows(), columns);
    Eigen::Index next = 0;
    for (Eigen::Index c = 0; c < columns; ++c) {
      const auto& old = kept[static_cast<std::size_t>(c)];
      all.col(c) = old ? old_columns.col(static_cast<Eigen::Index>(*old)) : new_columns.col(next++);
    }
    return all;
  };
  TransportMatrix matrix;
  matrix.lux_per_level = joined(before.lux_per_level, anew.lux_per_level);
  matrix.direct_lux_per_level = joined(before.direct_lux_per_level, anew.direct_lux_per_level);
  const std::size_t replicates = std::max(before.replicates.size(), anew.replicates.size());
  const auto replicate = [&](const TransportMatrix& of, std::size_t k) -> const Eigen::MatrixXd& {
    if (of.replicates.empty()) return of.lux_per_level;  // exact
    LUXRIG_CHECK(of.replicates.size() == replicates, "{} and {} replicates", of.replicates.size(), replicates);
    return of.replicates[k];
  };
  for (std::size_t k = 0; k < replicates; ++k)
    matrix.replicates.push_back(joined(replicate(before, k), replicate(anew, k)));
  LUXRIG_CHECK(before.rgb_per_level.size() == anew.rgb_per_level.size(), "columns with colours and without");
  for (std::size_t c = 0; c < before.rgb_per_level.size(); ++c)
    matrix.rgb_per_level.push_back(joined(before.rgb_per_level[c], anew.rgb_per_level[c]));
  matrix.rays = anew.rays;
  if (replicates == 0) return matrix;

  Eigen::VectorXd levels = Eigen::VectorXd::Ones(columns);
  if (!options.levels.empty())
    levels = Eigen::Map<const Eigen::VectorXd>(options.levels.data(), static_cast<Eigen::Index>(options.levels.size()));
  const Eigen::VectorXd lux = matrix.lux(levels), error_lux = matrix.standard_error_lux(levels);
  matrix.floor_lx = error_floor_lx(options, {lux.data(), static_cast<std::size_t>(lux.size())});
  double squares = 0;
  for (Eigen::Index r = 0; r < lux.size(); ++r) {
    const double scale_lx = std::max(lux[r], matrix.floor_lx), relative = scale_lx > 0 ? error_lux[r] / scale_lx : 0;
    matrix.relative_error = std::max(matrix.relative_error, relative);
    squares += relative * relative;
  }
  matrix.rms_error = std::sqrt(squares / static_cast<double>(std::max<Eigen::Index>(1, lux.size())));
  return matrix;
}

}  // namespace luxrig
