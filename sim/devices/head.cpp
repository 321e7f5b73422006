#include "sim/devices/head.h"

#include <algorithm>
#include <cmath>

namespace luxrig::sim {
namespace {

double turned_towards(double from_rad, double to_rad, double max_rad) {
  return from_rad + std::clamp(to_rad - from_rad, -max_rad, max_rad);
}

}  // namespace

Head::Head(const Fixture& fixture)
    : moves_(fixture.moves),
      range_(fixture.range),
      pan_speed_rad_s_(fixture.pan_speed_rad_s),
      tilt_speed_rad_s_(fixture.tilt_speed_rad_s),
      zoom_speed_rad_s_(fixture.zoom_speed_rad_s),
      joints_(fixture.joints),
      target_(fixture.joints) {
  if (!moves_) return;
  set_target(Joints{});
  joints_ = target_;
}

void Head::set_target(const Joints& joints) {
  if (!moves_ || std::isnan(joints.pan_rad) || std::isnan(joints.tilt_rad) || std::isnan(joints.beam_rad)) return;
  if (!carried_) {
    target_.pan_rad = std::clamp(joints.pan_rad, range_.pan_min_rad, range_.pan_max_rad);
    target_.tilt_rad = std::clamp(joints.tilt_rad, range_.tilt_min_rad, range_.tilt_max_rad);
  }
  if (range_.zooms()) target_.beam_rad = std::clamp(joints.beam_rad, range_.beam_min_rad, range_.beam_max_rad);
}

void Head::carry_to(const Joints& joints) {
  carried_ = moves_;
  if (!moves_) return;
  target_.pan_rad = joints.pan_rad;
  target_.tilt_rad = joints.tilt_rad;
}

void Head::step(double dt_s) {
  if (carried_) {
    joints_.pan_rad = target_.pan_rad;
    joints_.tilt_rad = target_.tilt_rad;
  } else {
    joints_.pan_rad = turned_towards(joints_.pan_rad, target_.pan_rad, pan_speed_rad_s_ * dt_s);
    joints_.tilt_rad = turned_towards(joints_.tilt_rad, target_.tilt_rad, tilt_speed_rad_s_ * dt_s);
  }
  joints_.beam_rad = turned_towards(joints_.beam_rad, target_.beam_rad, zoom_speed_rad_s_ * dt_s);
}

}  // namespace luxrig::sim
