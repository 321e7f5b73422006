#pragma once
/// Motor, gear and load of one axis, in degrees of the joint. The motor's angle q obeys
///   q̈ = u − f·sign(q̇) − b·q̇
/// with u the motor's drive (torque over the inertia of motor and load), f dry and b viscous friction. The gear of the
/// load has play: the side in contact drags the load along. End stops are hard and take all speed.

namespace luxrig::sim {

struct AxisTruth {
  double dry_friction_deg_s2 = 60;
  double viscous_friction_per_s = 0.5;
  double max_torque_deg_s2 = 3000;   ///< of the motor
  double backlash_deg = 0.02;        ///< total play of the gear
  double stop_min_deg = -360, stop_max_deg = 360;
  double switch_min_deg = -350, switch_max_deg = 350;  ///< the limit switches close below and above
  double index_deg = 0, index_every_deg = 10;          ///< one pulse per turn of the motor
  double counts_per_degree = 100;                      ///< of its encoder; < 0 = counts the other way
};

class AxisMechanics {
 public:
  AxisMechanics(const AxisTruth& truth, double angle_deg)
      : truth_(truth), motor_deg_(angle_deg), joint_deg_(angle_deg) {}

  /// stuck: the axis is blocked.
  void step(double dt_s, double torque_deg_s2, bool stuck);

  [[nodiscard]] double motor_deg() const { return motor_deg_; }
  [[nodiscard]] double speed_deg_s() const { return speed_deg_s_; }
  [[nodiscard]] double joint_deg() const { return joint_deg_; }
  [[nodiscard]] bool at_min_switch() const { return motor_deg_ <= truth_.switch_min_deg; }
  [[nodiscard]] bool at_max_switch() const { return motor_deg_ >= truth_.switch_max_deg; }
  /// Number of index pulses below the motor's angle; it changes at a pulse.
  [[nodiscard]] long index_turn() const;
  [[nodiscard]] const AxisTruth& truth() const { return truth_; }

 private:
  AxisTruth truth_;
  double motor_deg_, joint_deg_;
  double speed_deg_s_ = 0;
};

}  // namespace luxrig::sim
