#pragma once
/// Goal and limits for lights to be placed.

#include <Eigen/Core>
#include <limits>

#include "core/photometry/light_colour.h"

namespace luxrig {

/// min ‖W (A(poses) x + f − b)‖₂ with 0 ≤ x ≤ max_level, under limits of lux and power.
///
/// One channel: lux at every point, and one level per light. Three (red, green and blue, linear Rec. 709, with E in
/// each for white of E lux): channel after channel, each with all points; a light has one level per emitter, each of a
/// fixed colour. Everything between light and point is grey: all channels share one column.
struct LightingGoal {
  Eigen::VectorXd lux;           ///< b, points × channels
  Eigen::VectorXd row_weight{};  ///< diagonal of W, ≥ 0; empty = 1
  /// channels × emitters, ≥ 0: output of an emitter in each channel, per lux of the light's column.
  Eigen::MatrixXd emitters = Eigen::MatrixXd::Ones(1, 1);
  Eigen::VectorXd fixed_lux{};  ///< f: light from elsewhere (daylight, lights that stay); empty = none
  double max_level = std::numeric_limits<double>::infinity();  ///< of every emitter of a light
  Eigen::VectorXd max_lux{};  ///< hard limit at every point for all light together; +inf or empty = none
  Eigen::VectorXd watts{};    ///< of each emitter at level 1; empty = 0
  double max_watts = std::numeric_limits<double>::infinity();  ///< hard limit for all lights together

  [[nodiscard]] Eigen::Index channels() const { return emitters.rows(); }
  [[nodiscard]] Eigen::Index points() const { return lux.size() / channels(); }

  [[nodiscard]] bool limited() const {
    return max_watts < std::numeric_limits<double>::infinity() ||
           (max_lux.size() > 0 && max_lux.minCoeff() < std::numeric_limits<double>::infinity());
  }
  /// Lux at every point from values by channel.
  [[nodiscard]] Eigen::VectorXd luminous(const Eigen::VectorXd& by_channel) const {
    const Eigen::MatrixXd channel = by_channel.reshaped(points(), channels());
    if (channels() != 3) return channel.rowwise().sum();
    Eigen::VectorXd lux_of_points(points());
    for (Eigen::Index p = 0; p < points(); ++p) lux_of_points[p] = luminance_of_rgb(channel.row(p).transpose());
    return lux_of_points;
  }
  /// The same for an emitter, per lux of its light's column.
  [[nodiscard]] double luminous_emitter(Eigen::Index emitter) const {
    return channels() == 3 ? luminance_of_rgb(emitters.col(emitter)) : emitters.col(emitter).sum();
  }

  /// W v
  [[nodiscard]] Eigen::VectorXd weighted(const Eigen::VectorXd& v) const {
    return row_weight.size() == 0 ? v : Eigen::VectorXd(row_weight.cwiseProduct(v));
  }
  /// W (b − f): the part left for the lights
  [[nodiscard]] Eigen::VectorXd weighted() const {
    return weighted(fixed_lux.size() == 0 ? lux : Eigen::VectorXd(lux - fixed_lux));
  }
  /// The columns of a light's emitters, from its lux at every point: W (emitters ⊗ lux).
  [[nodiscard]] Eigen::MatrixXd weighted_columns(const Eigen::VectorXd& lux_of_light) const {
    const Eigen::Index count = lux_of_light.size();
    Eigen::MatrixXd columns(count * channels(), emitters.cols());
    for (Eigen::Index e = 0; e < emitters.cols(); ++e)
      for (Eigen::Index c = 0; c < channels(); ++c)
        columns.col(e).segment(c * count, count) = emitters(c, e) * lux_of_light;
    if (row_weight.size() > 0) columns = row_weight.asDiagonal() * columns;
    return columns;
  }
};

}  // namespace luxrig
