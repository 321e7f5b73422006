#pragma once
/// Limits of a lighting brief as linear limits: lux at a point, ratios of illuminance, power.

#include <string>
#include <vector>

#include "core/solve/least_squares/limited_nnls.h"

namespace luxrig {

/// E = T x + fixed. Points are rows of T. Each call adds rows; the new ones are between number() before and after.
class LuxLimits {
 public:
  using Index = Eigen::Index;

  /// T must outlive it. fixed_lx: light from elsewhere; empty = 0.
  explicit LuxLimits(const ColumnsView& lux_per_level, const Eigen::VectorXd& fixed_lx = {});

  void at_most(Index point, double lux);
  void at_least(Index point, double lux);
  /// E at one point is at most `ratio` times E at the other.
  void contrast_at_most(Index bright, Index dark, double ratio);
  /// Uniformity: the least E of the points is at least this share (0…1) of their mean, or of their maximum.
  void min_to_mean(const std::vector<Index>& points, double share);
  void min_to_max(const std::vector<Index>& points, double share);
  /// Σ watts_j x_j ≤ watts.
  void power_at_most(const Eigen::VectorXd& watts_per_level, double watts);

  [[nodiscard]] Index number() const { return static_cast<Index>(rows_.size()); }
  /// Text for conflicts: "at least 300 lx at point 7".
  [[nodiscard]] const std::string& text(Index row) const { return rows_[static_cast<std::size_t>(row)].text; }
  [[nodiscard]] LinearLimits limits() const;

 private:
  struct OfPoint {
    Index point;
    double times;
  };
  struct Row {
    std::vector<OfPoint> points;
    Index power = -1;      ///< index in power_
    Index auxiliary = -1;  ///< its factor is auxiliary_times
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
