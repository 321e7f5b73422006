#include "sim/devices/axis_mechanics.h"

#include <algorithm>
#include <cmath>

namespace luxrig::sim {

void AxisMechanics::step(double dt_s, double torque_deg_s2, bool stuck) {
  if (stuck) {
    speed_deg_s_ = 0;
    return;
  }
  const double torque = std::clamp(torque_deg_s2, -truth_.max_torque_deg_s2, truth_.max_torque_deg_s2);
  double speed = speed_deg_s_ + torque * dt_s;
  // Friction takes at most all of the speed: it never reverses a motor.
  const double friction = (truth_.dry_friction_deg_s2 + truth_.viscous_friction_per_s * std::abs(speed)) * dt_s;
  speed = std::copysign(std::max(std::abs(speed) - friction, 0.0), speed);
  speed_deg_s_ = speed;
  motor_deg_ += speed * dt_s;
  if (motor_deg_ < truth_.stop_min_deg || motor_deg_ > truth_.stop_max_deg) {
    motor_deg_ = std::clamp(motor_deg_, truth_.stop_min_deg, truth_.stop_max_deg);
    speed_deg_s_ = 0;
  }
  joint_deg_ = std::clamp(joint_deg_, motor_deg_ - truth_.backlash_deg / 2, motor_deg_ + truth_.backlash_deg / 2);
}

long AxisMechanics::index_turn() const {
  return std::lround(std::floor((motor_deg_ - truth_.index_deg) / truth_.index_every_deg));
}

}  // namespace luxrig::sim
