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

namespace {

/// The k-th estimate; an exact matrix is all of its own.
const Eigen::MatrixXd& replicate_of(const TransportMatrix& matrix, std::size_t k, std::size_t replicates) {
  if (matrix.replicates.empty()) return matrix.lux_per_level;
  LUXRIG_CHECK(matrix.replicates.size() == replicates, "{} and {} replicates", matrix.replicates.size(), replicates);
  return matrix.replicates[k];
}

/// join   of two matrices of columns, one
template <class Join>
TransportMatrix joined(const TransportMatrix& a, const TransportMatrix& b, const Join& join) {
  TransportMatrix matrix;
  matrix.lux_per_level = join(a.lux_per_level, b.lux_per_level);
  matrix.direct_lux_per_level = join(a.direct_lux_per_level, b.direct_lux_per_level);
  const std::size_t replicates = std::max(a.replicates.size(), b.replicates.size());
  for (std::size_t k = 0; k < replicates; ++k)
    matrix.replicates.push_back(join(replicate_of(a, k, replicates), replicate_of(b, k, replicates)));
  LUXRIG_CHECK(a.rgb_per_level.size() == b.rgb_per_level.size(), "columns with colours and without");
  for (std::size_t c = 0; c < a.rgb_per_level.size(); ++c)
    matrix.rgb_per_level.push_back(join(a.rgb_per_level[c], b.rgb_per_level[c]));
  return matrix;
}

/// From its replicates, at the options' levels.
void find_errors(TransportMatrix& matrix, const EvaluateOptions& options) {
  if (matrix.replicates.empty()) return;
  Eigen::VectorXd levels = Eigen::VectorXd::Ones(matrix.emitters());
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
}

}  // namespace

TransportMatrix joined_columns(const TransportMatrix& before, const TransportMatrix& anew,
                               std::span<const std::optional<std::size_t>> kept, const EvaluateOptions& options) {
  TransportMatrix matrix = joined(before, anew, [&](const Eigen::MatrixXd& known, const Eigen::MatrixXd& found) {
    LUXRIG_CHECK(known.rows() == found.rows(), "columns of {} and of {} receivers", known.rows(), found.rows());
    Eigen::MatrixXd all(known.rows(), static_cast<Eigen::Index>(kept.size()));
    Eigen::Index next = 0;
    for (Eigen::Index c = 0; c < all.cols(); ++c) {
      const auto& old = kept[static_cast<std::size_t>(c)];
      all.col(c) = old ? known.col(static_cast<Eigen::Index>(*old)) : found.col(next++);
    }
    return all;
  });
  matrix.rays = anew.rays;
  find_errors(matrix, options);
  return matrix;
}

TransportMatrix mean_of(const TransportMatrix& a, double share, const TransportMatrix& b,
                        const EvaluateOptions& options) {
  TransportMatrix matrix = joined(a, b, [&](const Eigen::MatrixXd& one, const Eigen::MatrixXd& other) {
    LUXRIG_CHECK(one.rows() == other.rows() && one.cols() == other.cols(), "estimates of {} × {} and {} × {}",
                 one.rows(), one.cols(), other.rows(), other.cols());
    return Eigen::MatrixXd(share * one + (1 - share) * other);
  });
  matrix.rays = a.rays + b.rays;
  find_errors(matrix, options);
  return matrix;
}

}  // namespace luxrig
