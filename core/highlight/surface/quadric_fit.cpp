#include "core/highlight/surface/quadric_fit.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace luxrig {
namespace {

/// Fewer samples determine the six coefficients but not their error.
constexpr int kMinSamples = 9;
/// Least pivot of the normal equations, scaled to a diagonal of 1. Samples all around give 1e-2 and more, a half-disc
/// 1e-3, a curve of second order only rounding, 1e-15.
constexpr double kMinPivot = 1e-6;

}  // namespace

std::optional<QuadricFit> QuadricSums::fit() const {
  if (count_ < kMinSamples || !(sum_ > 0)) return std::nullopt;
  // Few samples with all of the weight count as few samples.
  const double effective = sum_ * sum_ / sum_of_squares_;
  if (!(effective > 6.5)) return std::nullopt;
  Eigen::Matrix<double, 6, 6> normal;
  Eigen::Matrix<double, 6, 1> right;
  normal(0, 0) = sum_;
  right(0) = z_;
  const double* moment = moments_;
  for (int i = 0; i < 5; ++i) {
    normal(0, i + 1) = normal(i + 1, 0) = first_[i];
    right(i + 1) = right_[i];
    for (int j = i; j < 5; ++j) normal(i + 1, j + 1) = normal(j + 1, i + 1) = *moment++;
  }
  const Eigen::Matrix<double, 6, 1> diagonal = normal.diagonal();
  if (!(diagonal.minCoeff() > 0)) return std::nullopt;
  const Eigen::Matrix<double, 6, 1> scale = diagonal.cwiseSqrt().cwiseInverse();
  const Eigen::Matrix<double, 6, 6> scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  const Eigen::LLT<Eigen::Matrix<double, 6, 6>> factor(scaled);
  if (factor.info() != Eigen::Success) return std::nullopt;
  const double pivot = factor.matrixLLT().diagonal().minCoeff();
  if (!(pivot * pivot > kMinPivot)) return std::nullopt;
  QuadricFit fit;
  fit.coefficients = scale.cwiseProduct(factor.solve(scale.cwiseProduct(right)));
  const double left = std::max(0.0, zz_ - fit.coefficients.dot(right)) / sum_;
  Eigen::Matrix<double, 6, 1> bend = Eigen::Matrix<double, 6, 1>::Zero();
  bend(3) = bend(5) = 0.5;
  const Eigen::Matrix<double, 6, 1> scaled_bend = scale.cwiseProduct(bend);
  // Weights vary: this many samples of equal weight would be as accurate.
  const double variance = left * effective / std::max(effective - 6, 0.5);
  fit.mean_bend_error = std::sqrt(variance * scaled_bend.dot(factor.solve(scaled_bend)) * sum_ / effective);
  if (!fit.coefficients.allFinite() || !std::isfinite(fit.mean_bend_error)) return std::nullopt;
  return fit;
}

PrincipalCurvatures principal_curvatures(const Eigen::Matrix<double, 6, 1>& quadric) {
  const double p = quadric(1), q = quadric(2);
  const double slope = std::hypot(p, q), w = std::sqrt(1 + slope * slope);
  // Tangents: up the slope, where lengths over the plane stretch by w, and across it.
  const Eigen::Vector2d up = slope > 1e-12 ? Eigen::Vector2d(p / slope, q / slope) : Eigen::Vector2d(1, 0);
  const Eigen::Vector2d across(-up.y(), up.x());
  Eigen::Matrix2d second;
  second << quadric(3), quadric(4), quadric(4), quadric(5);
  const double uu = up.dot(second * up) / (w * w * w), uv = up.dot(second * across) / (w * w),
               vv = across.dot(second * across) / w;
  // -(uu uv; uv vv): bulging outwards means bending down.
  const double middle = -(uu + vv) / 2, half = (vv - uu) / 2, spread = std::hypot(half, uv);
  const double turn = 0.5 * std::atan2(-uv, half);
  const double c = std::cos(turn), s = std::sin(turn);
  const Vec3 up3 = Vec3(up.x(), up.y(), slope) / w, across3(across.x(), across.y(), 0);
  return {middle + spread, middle - spread, c * up3 + s * across3, c * across3 - s * up3};
}

}  // namespace luxrig
