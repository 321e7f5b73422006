#pragma once
/// The joints of a pan-tilt head: the motor of each turns at its own constant speed to its target, within its range. The
/// head follows by belts that give, as first-order lag: it is late on the way, and settles at the end.

#include "core/rig/equipment.h"

namespace luxrig::sim {

struct HeadTruth {
  double pan_scale = 1;     ///< true pan over the motor's; negative: it turns the other way
  double backlash_rad = 0;  ///< play of pan and tilt: the head follows within half of it
  double speed_share = 1;   ///< of the stated speeds of pan and tilt
  double lag_s = 0;         ///< time constant with which the head follows its motors
};

class Head {
 public:
  /// `fixture` must move (speeds > 0). It starts at pan = tilt = 0, or as near as its range allows, its zoom at the
  /// narrow end, like heads at power-on. A fixture that does not move stays at its joints for ever.
  explicit Head(const Fixture& fixture, const HeadTruth& truth = {});

  /// Clamped to the range, as by end stops; NaN is ignored.
  void set_target(const Joints& joints);
  /// From now on separate axes turn pan and tilt: they are there after the next step. The zoom is unaffected.
  void carry_to(const Joints& joints);
  void step(double dt_s);

  [[nodiscard]] const Joints& joints() const { return lamp_; }  ///< where it truly looks
  [[nodiscard]] bool moving() const { return !(joints_ == target_ && belted_ == joints_); }

 private:
  void drag();

  bool moves_;
  bool carried_ = false;
  JointRange range_;
  double pan_speed_rad_s_, tilt_speed_rad_s_, zoom_speed_rad_s_;
  HeadTruth truth_;
  Joints joints_, target_;  ///< of the motors
  Joints belted_;           ///< behind their belts
  Joints lamp_;             ///< and behind the play of the gears
};

}  // namespace luxrig::sim
