#include "core/solve/lux_limits.h"

#include <fmt/format.h>

#include "core/check.h"

namespace luxrig {

using Eigen::Index;
using Eigen::VectorXd;

LuxLimits::LuxLimits(const ColumnsView& lux_per_level, const VectorXd& fixed_lx)
    : columns_(lux_per_level), fixed_lx_(fixed_lx.size() > 0 ? fixed_lx : VectorXd::Zero(lux_per_level.rows())) {
  LUXRIG_CHECK(fixed_lx_.size() == columns_.rows(), "{} fixed, {} points", fixed_lx_.size(), columns_.rows());
}

void LuxLimits::at_most(Index point, double lux) {
  rows_.push_back({{{point, 1}}, -1, -1, 0, lux, fmt::format("at most {:g} lx at point {}", lux, point)});
}

void LuxLimits::at_least(Index point, double lux) {
  rows_.push_back({{{point, -1}}, -1, -1, 0, -lux, fmt::format("at least {:g} lx at point {}", lux, point)});
}

void LuxLimits::contrast_at_most(Index bright, Index dark, double ratio) {
  rows_.push_back({{{bright, 1}, {dark, -ratio}},
                   -1,
                   -1,
                   0,
                   0,
                   fmt::format("at most {:g} times as bright at point {} as at point {}", ratio, bright, dark)});
}

/// An auxiliary t ≥ the mean (or each E), and each E ≥ share · t. t can equal that mean or maximum, so this is
/// equivalent, and the rows stay short.
void LuxLimits::uniformity(const std::vector<Index>& points, double share, bool mean) {
  if (points.empty()) return;
  const Index t = auxiliaries_++;
  const std::string what = fmt::format("least to {} at least {:g}", mean ? "mean" : "largest", share);
  if (mean) {
    Row row{{}, -1, t, -1, 0, what};
    for (const Index point : points) row.points.push_back({point, 1 / static_cast<double>(points.size())});
    rows_.push_back(std::move(row));
  }
  for (const Index point : points) {
    const std::string text = fmt::format("{}, at point {}", what, point);
    if (!mean) rows_.push_back({{{point, 1}}, -1, t, -1, 0, text});
    rows_.push_back({{{point, -1}}, -1, t, share, 0, text});
  }
}

void LuxLimits::min_to_mean(const std::vector<Index>& points, double share) { uniformity(points, share, true); }
void LuxLimits::min_to_max(const std::vector<Index>& points, double share) { uniformity(points, share, false); }

void LuxLimits::power_at_most(const VectorXd& watts_per_level, double watts) {
  LUXRIG_CHECK(watts_per_level.size() == columns_.columns(), "{} powers, {} columns", watts_per_level.size(),
               columns_.columns());
  rows_.push_back({{}, static_cast<Index>(power_.size()), -1, 0, watts, fmt::format("at most {:g} W", watts)});
  power_.push_back(watts_per_level);
}

LinearLimits LuxLimits::limits() const {
  LinearLimits limits;
  limits.most.resize(number());
  for (Index i = 0; i < number(); ++i) {
    const Row& row = rows_[static_cast<std::size_t>(i)];
    limits.most[i] = row.most;
    for (const OfPoint& of : row.points) {
      LUXRIG_CHECK(of.point >= 0 && of.point < columns_.rows(), "point {} of {}", of.point, columns_.rows());
      limits.most[i] -= of.times * fixed_lx_[of.point];
    }
  }
  std::vector<Eigen::Triplet<double>> entries;
  VectorXd lux(columns_.rows());
  for (Index j = 0; j < columns_.columns(); ++j) {
    lux.setZero();
    columns_.add(j, 1.0, lux.data());
    for (Index i = 0; i < number(); ++i) {
      const Row& row = rows_[static_cast<std::size_t>(i)];
      double sum = row.power >= 0 ? power_[static_cast<std::size_t>(row.power)][j] : 0;
      for (const OfPoint& of : row.points) sum += of.times * lux[of.point];
      if (sum != 0) entries.emplace_back(i, j, sum);
    }
  }
  for (Index i = 0; i < number(); ++i)
    if (const Row& row = rows_[static_cast<std::size_t>(i)]; row.auxiliary >= 0 && row.auxiliary_times != 0)
      entries.emplace_back(i, columns_.columns() + row.auxiliary, row.auxiliary_times);
  limits.rows.resize(number(), columns_.columns() + auxiliaries_);
  limits.rows.setFromTriplets(entries.begin(), entries.end());
  return limits;
}

}  // namespace luxrig
