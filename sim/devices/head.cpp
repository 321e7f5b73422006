#include "sim/devices/head.h"

#include <algorithm>
#include <cmath>

namespace luxrig::sim {
namespace {

/// So near, a head is there.
constexpr double kThere_rad = 1e-5;

double turned_towards(double from_rad, double to_rad, double max_rad) {
  return from_rad + std::clamp(to_rad - from_rad, -max_rad, max_rad);
}

double followed(double from_rad, double to_rad, double share) {
  const double next_rad = from_rad + share * (to_rad - from_rad);
  return std::abs(to_rad - next_rad) < kThere_rad ? to_rad : next_rad;
}

}  // namespace

Head::Head(const Fixture& fixture, const HeadTruth& truth)
    : moves_(fixture.moves),
      range_(fixture.range),
      pan_speed_rad_s_(fixture.pan_speed_rad_s * truth.speed_share),
      tilt_speed_rad_s_(fixture.tilt_speed_rad_s * truth.speed_share),
      zoom_speed_rad_s_(fixture.zoom_speed_rad_s),
      truth_(truth),
      joints_(fixture.joints),
      target_(fixture.joints),
      belted_(fixture.joints),
      lamp_(fixture.joints) {
  if (!moves_) return;
  set_target(Joints{});
  joints_ = belted_ = lamp_ = target_;
  drag();
}

/// The lamp follows its motors, within the play of the gears. Axes simulated elsewhere have play of their own.
void Head::drag() {
  const double play_rad = carried_ ? 0 : truth_.backlash_rad / 2;
  const double pan_rad = carried_ ? belted_.pan_rad : belted_.pan_rad * truth_.pan_scale;
  lamp_.pan_rad = std::clamp(lamp_.pan_rad, pan_rad - play_rad, pan_rad + play_rad);
  lamp_.tilt_rad = std::clamp(lamp_.tilt_rad, belted_.tilt_rad - play_rad, belted_.tilt_rad + play_rad);
  lamp_.beam_rad = belted_.beam_rad;
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
  const double share = carried_ || !(truth_.lag_s > 0) ? 1 : -std::expm1(-dt_s / truth_.lag_s);
  belted_ = {followed(belted_.pan_rad, joints_.pan_rad, share), followed(belted_.tilt_rad, joints_.tilt_rad, share),
             joints_.beam_rad};
  if (moves_) drag();
}

}  // namespace luxrig::sim
