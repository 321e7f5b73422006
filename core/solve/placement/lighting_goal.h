#pragma once
/// What lights that are to be placed should do.

#include <Eigen/Core>
#include <limits>

namespace luxrig {

/// min ‖W (A(poses) x + f − b)‖₂ with 0 ≤ x ≤ max_level.
///
/// One channel: lux at every point, and a level for each light. More (red, green and blue, linear Rec. 709, with E in
/// each for white of E lux): the channels of all points one behind the other, and a light has a level per emitter, each
/// of a fixed colour. What is between the light and a point is grey: all channels share one column.
struct LightingGoal {
  Eigen::VectorXd lux;           ///< b, points × channels
  Eigen::VectorXd row_weight{};  ///< diagonal of W, ≥ 0; empty = 1
  /// channels × emitters, ≥ 0: what an emitter gives in each channel, per lux of the light's column.
  Eigen::MatrixXd emitters = Eigen::MatrixXd::Ones(1, 1);
  Eigen::VectorXd fixed_lux{};  ///< f: light that is there anyway (daylight, lights that stay); empty = none
  double max_level = std::numeric_limits<double>::infinity();  ///< of every emitter of a light

  [[nodiscard]] Eigen::Index channels() const { return emitters.rows(); }
  [[nodiscard]] Eigen::Index points() const { return lux.size() / channels(); }

  /// W v
  [[nodiscard]] Eigen::VectorXd weighted(const Eigen::VectorXd& v) const {
    return row_weight.size() == 0 ? v : Eigen::VectorXd(row_weight.cwiseProduct(v));
  }
  /// W (b − f): what is left for the lights to do
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
