#include "core/rig/joint_map.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace luxrig {
namespace {

/// A command that changes by less has not turned back: rounding.
constexpr double kSameCommand_rad = 1e-7;
/// A head of which nobody knows from where it comes is first sent beside its aim, by so much and so many times its play.
constexpr double kBesidePlay = 1.5, kBeside_rad = 0.002;
/// Nearer to straight down, a beam that lies askew needs more pan than reach() leaves.
constexpr double kAskewToPan = 5;

/// Half of the play, to the side that the head comes from.
double lag_rad(double scale, double play_rad, int from) { return std::copysign(0.5, scale) * from * play_rad; }

/// The same angle with another value within its turn.
double replaced(double angle_rad, double within_turn_rad) {
  return within_turn_rad + (angle_rad - std::remainder(angle_rad, 2 * kPi));
}

/// How far the beam's plane is turned off the pan, at a tilt of the lamp that includes its zero.
double pan_of_askew(double askew_x, double length, double lamp_tilt_rad) {
  const double across = length * std::sin(lamp_tilt_rad);
  return std::copysign(1.0, across) * std::atan2(-askew_x, std::abs(across));
}

std::pair<double, double> ends(double a_rad, double b_rad, double inset_rad) {
  const auto [least, most] = std::minmax(a_rad, b_rad);
  if (most - least < 2 * inset_rad) return {(least + most) / 2, (least + most) / 2};
  return {least + inset_rad, most - inset_rad};
}

/// Of a joint that is sent `to`, within its range: a place farther from it than the play, below it if there is room.
double beside(double to_rad, double play_rad, double scale, double least_rad) {
  const double away_rad = (kBesidePlay * play_rad + kBeside_rad) / std::abs(scale);
  return to_rad - away_rad >= least_rad ? to_rad - away_rad : to_rad + away_rad;
}

void follow(double from_rad, double to_rad, int& side) {
  if (std::abs(to_rad - from_rad) > kSameCommand_rad) side = to_rad > from_rad ? 1 : -1;
}

Joints sent_without_play(JointMap map, const Joints& wanted) {
  map.pan_play_rad = map.tilt_play_rad = 0;
  return map.sent_for(wanted, {});
}

}  // namespace

bool JointMap::operator==(const JointMap& other) const {
  const auto all = [](const JointMap& m) {
    return std::tuple(m.pan_scale, m.tilt_scale, m.pan_play_rad, m.tilt_play_rad, m.askew_x, m.askew_y,
                      m.sent.pan_min_rad, m.sent.pan_max_rad, m.sent.tilt_min_rad, m.sent.tilt_max_rad,
                      m.sent.beam_min_rad, m.sent.beam_max_rad);
  };
  return all(*this) == all(other);
}

Joints JointMap::sent_for(const Joints& wanted, const Approach& from) const {
  Joints turned = wanted;  // the lamp, with its zero
  if (askew_x != 0) {
    // The beam lies on a cone about the lamp's X axis.
    const double length = std::hypot(1.0, askew_y);
    const double cosine = std::hypot(length, askew_x) / length * std::cos(wanted.tilt_rad);
    const double tilt_rad = std::remainder(wanted.tilt_rad, 2 * kPi);
    turned.tilt_rad = replaced(wanted.tilt_rad, std::copysign(std::acos(std::clamp(cosine, -1.0, 1.0)), tilt_rad));
    turned.pan_rad -= pan_of_askew(askew_x, length, turned.tilt_rad);
  }
  turned.tilt_rad -= std::atan(askew_y);
  return {std::clamp((turned.pan_rad + lag_rad(pan_scale, pan_play_rad, from.pan)) / pan_scale, sent.pan_min_rad,
                     sent.pan_max_rad),
          std::clamp((turned.tilt_rad + lag_rad(tilt_scale, tilt_play_rad, from.tilt)) / tilt_scale, sent.tilt_min_rad,
                     sent.tilt_max_rad),
          wanted.beam_rad};
}

Joints JointMap::reached_by(const Joints& command, const Approach& from) const {
  Joints reached{command.pan_rad * pan_scale - lag_rad(pan_scale, pan_play_rad, from.pan),
                 command.tilt_rad * tilt_scale - lag_rad(tilt_scale, tilt_play_rad, from.tilt) + std::atan(askew_y),
                 command.beam_rad};
  if (askew_x == 0) return reached;
  const double length = std::hypot(1.0, askew_y);
  reached.pan_rad += pan_of_askew(askew_x, length, reached.tilt_rad);
  const double tilt_rad = std::remainder(reached.tilt_rad, 2 * kPi);
  const double cosine = length / std::hypot(length, askew_x) * std::cos(tilt_rad);
  reached.tilt_rad = replaced(reached.tilt_rad, std::copysign(std::acos(cosine), tilt_rad));
  return reached;
}

JointRange JointMap::reach() const {
  JointRange reach = sent;
  std::tie(reach.pan_min_rad, reach.pan_max_rad) = ends(sent.pan_min_rad * pan_scale, sent.pan_max_rad * pan_scale,
                                                        pan_play_rad / 2 + kAskewToPan * std::abs(askew_x));
  std::tie(reach.tilt_min_rad, reach.tilt_max_rad) =
      ends(sent.tilt_min_rad * tilt_scale, sent.tilt_max_rad * tilt_scale,
           tilt_play_rad / 2 + std::abs(askew_x) + std::abs(askew_y));
  return reach;
}

Joints JointSender::send(const JointMap& map, const Joints& wanted) {
  const Joints middle = sent_without_play(map, wanted);
  follow(middle_.pan_rad, middle.pan_rad, from_.pan);
  follow(middle_.tilt_rad, middle.tilt_rad, from_.tilt);
  middle_ = middle;
  return map.sent_for(wanted, from_);
}

Joints JointSender::send_beside(const JointMap& map, const Joints& wanted) {
  middle_ = sent_without_play(map, wanted);
  middle_.pan_rad = beside(middle_.pan_rad, map.pan_play_rad, map.pan_scale, map.sent.pan_min_rad);
  middle_.tilt_rad = beside(middle_.tilt_rad, map.tilt_play_rad, map.tilt_scale, map.sent.tilt_min_rad);
  return middle_;
}

}  // namespace luxrig
