#pragma once
/// What a lighting brief forbids, as linear limits: lux at a point, ratios of illuminance, power.

#include <string>
#include <vector>

#include "core/solve/least_squares/limited_nnls.h"

namespace luxrig {

/// E = T x + fixed. Points are rows of T. Each call adds rows; number() of them before and after says which.
class LuxLimits {
 public:
  using Index = Eigen::Index;

  /// T must outlive it. fixed_lx: light that is there anyway; empty = 0.
  explicit LuxLimits(const ColumnsView& lux_per_level, const Eigen::VectorXd& fixed_lx = {});

  void at_most(Index point, double lux);
  void at_least(Index point, double lux);
  /// E at one point at most so many times that at another.
  void contrast_at_most(Index bright, Index dark, double ratio);
  /// Uniformity: the least E of the points at least this share (0…1) of their mean, or of their largest.
  void min_to_mean(const std::vector<Index>& points, double share);
  void min_to_max(const std::vector<Index>& points, double share);
  /// Σ watts_j x_j at most so much.
  void power_at_most(const Eigen::VectorXd& watts_per_level, double watts);

  [[nodiscard]] Index number() const { return static_cast<Index>(rows_.size()); }
  /// "at least 300 lx at point 7": for conflicts.
  [[nodiscard]] const std::string& text(Index row) const { return rows_[static_cast<std::size_t>(row)].text; }
  [[nodiscard]] LinearLimits limits() const;

 private:
  struct OfPoint {
    Index point;
    double times;
  };
  struct Row {
    std::vector<OfPoint> points;
    Index power = -1;      ///< in power_
    Index auxiliary = -1;  ///< with this factor
    double auxiliary_times = 0;
    double most = 0;
    std::string text;
  };
  void uniformity(const std::vector<Index>& points, double share, bool mean);

  ColumnsView columns_;
  Eigen::VectorXd fixed_lx_;
  std::vector<Row> rows_;
  std::vector<Eigen::VectorXd> power_;
  Index auxiliaries_ = 0;
};

}  // namespace luxrig
