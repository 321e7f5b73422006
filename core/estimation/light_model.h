#pragma once
/// The light that fixtures give at points and luxmeters, as used by the controller and the estimator.

#include <Eigen/Core>

namespace luxrig {

/// T at the rig's aims, and the light of no fixture (daylight).
struct LightModel {
  Eigen::MatrixXd point_lux_per_level;   ///< points × fixtures
  Eigen::MatrixXd meter_lux_per_level;   ///< luxmeters × fixtures
  Eigen::MatrixXd point_standard_error;  ///< of each entry, same shape; empty = exact
  Eigen::MatrixXd meter_standard_error;
  Eigen::VectorXd point_fixed_lx, meter_fixed_lx;              ///< daylight; empty = none
  Eigen::VectorXd point_fixed_error_lx, meter_fixed_error_lx;  ///< standard error of that; empty = exact
  /// Per fixture, after a calibration: standard deviations of its output over the model's, and of its light at a place
  /// beside that, as shares. NaN or empty = as wide as the rig file allows.
  Eigen::VectorXd gain_sd, local_sd;
  /// Points × fixtures, after a calibration: standard error of each entry beside those; empty = none.
  Eigen::MatrixXd point_known_error;
  /// Points × fixtures: the most that a head can give, wherever it is aimed (core/tasks/any_aim.h); 0 for lamps that do
  /// not turn. Empty = not known, so that no head may be turned by hand where points have limits.
  Eigen::MatrixXd any_aim_lux_per_level;
};

}  // namespace luxrig
