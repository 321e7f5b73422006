#include "sim/devices/head.h"

#include <algorithm>
#include <cmath>

namespace luxrig::sim {
namespace {

double turned_towards(double from_rad, double to_rad, double max_rad) {
  return from_rad + std::clamp(to_rad - from_rad, -max_rad, max_rad);
}

}  // namespace

Head::Head(const Fixture& fixture, double pan_scale, double backlash_rad)
    : moves_(fixture.moves),
      range_(fixture.range),
      pan_speed_rad_s_(fixture.pan_speed_rad_s),
      tilt_speed_rad_s_(fixture.tilt_speed_rad_s),
      zoom_speed_rad_s_(fixture.zoom_speed_rad_s),
      pan_scale_(pan_scale),
      half_play_rad_(0.5 * backlash_rad),
      joints_(fixture.joints),
      target_(fixture.joints),
      lamp_(fixture.joints) {
  if (!moves_) return;
  set_target(Joints{});
  joints_ = lamp_ = target_;
  drag();
}

/// The lamp follows its motors, within the play of the gears. Axes simulated elsewhere have play of their own.
void Head::drag() {
  const double play_rad = carried_ ? 0 : half_play_rad_;
  const double pan_rad = carried_ ? joints_.pan_rad : joints_.pan_rad * pan_scale_;
  lamp_.pan_rad = std::clamp(lamp_.pan_rad, pan_rad - play_rad, pan_rad + play_rad);
  lamp_.tilt_rad = std::clamp(lamp_.tilt_rad, joints_.tilt_rad - play_rad, joints_.tilt_rad + play_rad);
  lamp_.beam_rad = joints_.beam_rad;
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
  if (moves_) drag();
}

}  // namespace luxrig::sim
