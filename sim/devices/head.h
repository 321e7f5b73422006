#pragma once
/// The joints of a pan-tilt head: each turns at its own constant speed to its target, within its range.
/// Acceleration is not modelled: a head that ramps arrives later by about (speed / acceleration).

#include "core/rig/equipment.h"

namespace luxrig::sim {

class Head {
 public:
  /// `fixture` must move (speeds > 0). It starts at pan = tilt = 0, or as near as its range allows, its zoom at the
  /// narrow end, like heads at power-on. A fixture that does not move stays at its joints for ever.
  /// pan_scale      true pan over the motor's; negative: it turns the other way
  /// backlash_rad   play of pan and tilt: the head follows its motors within half of it
  explicit Head(const Fixture& fixture, double pan_scale = 1, double backlash_rad = 0);

  /// Clamped to the range, as by end stops; NaN is ignored.
  void set_target(const Joints& joints);
  /// From now on separate axes turn pan and tilt: they are there after the next step. The zoom is unaffected.
  void carry_to(const Joints& joints);
  void step(double dt_s);

  [[nodiscard]] const Joints& joints() const { return lamp_; }  ///< where it truly looks
  [[nodiscard]] bool moving() const { return !(joints_ == target_); }

 private:
  void drag();

  bool moves_;
  bool carried_ = false;
  JointRange range_;
  double pan_speed_rad_s_, tilt_speed_rad_s_, zoom_speed_rad_s_;
  double pan_scale_, half_play_rad_;
  Joints joints_, target_;  ///< of the motors
  Joints lamp_;             ///< behind them
};

}  // namespace luxrig::sim
