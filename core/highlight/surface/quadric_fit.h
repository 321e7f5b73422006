#pragma once
/// Internal to curvature: a quadric over a tangent plane, by weighted least squares.

#include <optional>

#include "core/geometry.h"

namespace luxrig {

/// z = (1, x, y, x²/2, xy, y²/2) · coefficients, everything in units of the neighbourhood's radius.
struct QuadricFit {
  Eigen::Matrix<double, 6, 1> coefficients;
  double mean_bend_error;  ///< standard error of (second derivative by x + by y) / 2
};

class QuadricSums {
 public:
  void add(double weight, double x, double y, double z) {
    const double b[5] = {x, y, x * x / 2, x * y, y * y / 2};
    double* moment = moments_;
    for (int i = 0; i < 5; ++i) {
      const double wb = weight * b[i];
      first_[i] += wb;
      right_[i] += wb * z;
      for (int j = i; j < 5; ++j) *moment++ += wb * b[j];
    }
    sum_ += weight;
    sum_of_squares_ += weight * weight;
    z_ += weight * z;
    zz_ += weight * z * z;
    ++count_;
  }
  [[nodiscard]] int count() const { return count_; }

  /// Empty when the samples do not determine it: too few, or on a line or another curve of second order.
  [[nodiscard]] std::optional<QuadricFit> fit() const;

 private:
  double moments_[15] = {}, first_[5] = {}, right_[5] = {};
  double sum_ = 0, sum_of_squares_ = 0, z_ = 0, zz_ = 0;
  int count_ = 0;
};

/// Principal curvatures of the graph z = quadric at the origin, z outwards, positive where it bulges outwards, and
/// their directions as tangent vectors (x, y, z), unit. Unit: 1 / that of the quadric's length.
struct PrincipalCurvatures {
  double larger, smaller;
  Vec3 larger_direction, smaller_direction;
};
[[nodiscard]] PrincipalCurvatures principal_curvatures(const Eigen::Matrix<double, 6, 1>& quadric);

}  // namespace luxrig
