#include "drivers/can/cia402/head_axes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace luxrig::cia402 {
namespace {

constexpr double kThere_rad = rad_from_deg(0.5);
constexpr double kExact_rad = rad_from_deg(0.03);  // backlash, and the error of a standing servo
constexpr Duration kReturnSlack = std::chrono::seconds(1);
constexpr Duration kArrivalSlack = std::chrono::seconds(3);  // it may have to turn back first
constexpr Duration kBeginsWithin = std::chrono::milliseconds(300);
constexpr int kCyclesToBegin = 6;  // three objects by SDO, a read in progress, and the offer

double counts_per_rad(const AxisPatch& patch) { return std::abs(patch.counts_per_degree) * deg_from_rad(1.0); }

/// A speed or acceleration for the drive: whole, and at least 1.
std::uint32_t whole_counts(double counts) {
  return static_cast<std::uint32_t>(std::clamp(std::round(counts), 1.0, 4e9));
}

std::int32_t whole_position(double counts) {
  constexpr double kMax = std::numeric_limits<std::int32_t>::max();
  return static_cast<std::int32_t>(std::clamp(std::round(counts), -kMax, kMax));
}

AxisSettings settings_of(const AxisPatch& patch, double min_rad, double max_rad, double speed_rad_s,
                         const AxesOptions& options) {
  AxisSettings s;
  s.node = patch.node;
  s.master_node = options.master_node;
  s.cycle = options.cycle;
  s.heartbeat = options.heartbeat;
  const double from = patch.counts_at(min_rad), to = patch.counts_at(max_rad);
  s.lowest = whole_position(std::min(from, to));
  s.highest = whole_position(std::max(from, to));
  s.speed = whole_counts(speed_rad_s * counts_per_rad(patch));
  s.acceleration = whole_counts(patch.acceleration_rad_s2 * counts_per_rad(patch));
  s.home = options.home;
  s.homing_method = options.homing_method;
  s.homing_speed = whole_counts(options.homing_speed_share * speed_rad_s * counts_per_rad(patch));
  s.homing_timeout = options.homing_timeout;
  s.hold_on_stop = options.hold_on_stop;
  s.fault_resets = options.fault_resets;
  return s;
}

/// Faster than the noise of a standing encoder.
bool under_way(const Axis& axis) {
  return std::abs(static_cast<double>(axis.velocity())) > std::max(0.01 * axis.settings().speed, 2.0);
}

SetPoint set_point(const Axis& axis, const AxisPatch& patch, double target_rad, const AxisLimits& limits) {
  SetPoint order;
  order.position =
      std::clamp(whole_position(patch.counts_at(target_rad)), axis.settings().lowest, axis.settings().highest);
  order.speed = whole_counts(limits.speed * counts_per_rad(patch));
  order.acceleration = whole_counts(limits.acceleration * counts_per_rad(patch));
  return order;
}

}  // namespace

HeadAxes::HeadAxes(const Fixture& fixture, const AxesOptions& options)
    : pan_patch_(fixture.axes->pan),
      tilt_patch_(fixture.axes->tilt),
      pan_limits_{fixture.pan_speed_rad_s, pan_patch_.acceleration_rad_s2},
      tilt_limits_{fixture.tilt_speed_rad_s, tilt_patch_.acceleration_rad_s2},
      pan_(settings_of(pan_patch_, fixture.range.pan_min_rad, fixture.range.pan_max_rad, fixture.pan_speed_rad_s,
                       options)),
      tilt_(settings_of(tilt_patch_, fixture.range.tilt_min_rad, fixture.range.tilt_max_rad, fixture.tilt_speed_rad_s,
                        options)) {}

void HeadAxes::activate(Time now) {
  pan_.activate(now);
  tilt_.activate(now);
  target_.reset();
  ordered_.reset();
  due_back_.reset();
  arrive_by_.reset();
  waits_since_.reset();
  under_way_until_ = now;
  returning_ = true;
}

void HeadAxes::receive(Time now, const can::CanFrame& frame) {
  pan_.receive(now, frame);
  tilt_.receive(now, frame);
}

std::optional<Joints> HeadAxes::joints() const {
  if (!pan_.ready() || !tilt_.ready()) return std::nullopt;
  return Joints{pan_patch_.joint_rad_at(pan_.position()), tilt_patch_.joint_rad_at(tilt_.position())};
}

void HeadAxes::step(Time now, Frames& out) {
  const auto here = joints();
  if (!here) {
    ordered_.reset();  // ordered again once both axes can follow
    returning_ = true;
    due_back_.reset();
    arrive_by_.reset();
    waits_since_.reset();
    // It stops by a quick stop, whatever the nodes report.
    under_way_until_ =
        std::min(under_way_until_, now + std::max(stops_within(pan_.settings()), stops_within(tilt_.settings())));
  }
  if (here && target_ && arrive_by_ && now >= *arrive_by_) {
    arrive_by_.reset();
    if (is_there(*here, kExact_rad)) {
      ordered_again_ = false;
    } else if (is_there(*here, kThere_rad)) {  // it paused unseen and went on without its order
      if (!ordered_again_) ordered_.reset();
      ordered_again_ = true;
    } else {  // computed from a wrong position, or part of the order was lost: order again from here
      ordered_.reset();
      returning_ = true;
      due_back_.reset();
    }
  }
  if (here && target_ && ordered_ != target_ && pan_.order_taken() && tilt_.order_taken()) {
    HeadMove move =
        head_move(target_->pan_rad - here->pan_rad, target_->tilt_rad - here->tilt_rad, pan_limits_, tilt_limits_);
    // From a standstill both axes keep step. A moving axis needs its full limits: scaled to the remaining distance,
    // they could be too low to stop it or to turn it back in time. A node's report of standstill is not proof of it.
    if (under_way(pan_) || under_way(tilt_) || now < under_way_until_) {
      move.pan = pan_limits_;
      move.tilt = tilt_limits_;
    }
    pan_.order(set_point(pan_, pan_patch_, target_->pan_rad, move.pan));
    tilt_.order(set_point(tilt_, tilt_patch_, target_->tilt_rad, move.tilt));
    ordered_ = target_;
    under_way_until_ = now + from_seconds(move.seconds);
    arrive_by_ = under_way_until_ + kArrivalSlack;
    waits_since_ = now;
    if (returning_ && !due_back_) due_back_ = now + from_seconds(move.seconds) + kReturnSlack;
  }
  if (returning_ && here) {
    returning_ = target_ && !is_there(*here, kThere_rad) && (!due_back_ || now < *due_back_);
  }
  const bool asked = target_.has_value(), pan_sound = pan_.sound(), tilt_sound = tilt_.sound();
  const bool together = begin_together(now);
  pan_.step(now, !tilt_sound, asked, together, out);
  tilt_.step(now, !pan_sound, asked, together, out);
}

/// True once both drives have their limits: if one axis gets them by SDO, the other waits. Too long a wait counts as a
/// loss, as others already reckon that the head is moving.
bool HeadAxes::begin_together(Time now) {
  if (!waits_since_) return true;
  const Duration waited = now - *waits_since_;
  if (!pan_.limits_told() || !tilt_.limits_told()) {
    if (waited > std::max(kBeginsWithin, kCyclesToBegin * pan_.settings().cycle)) returning_ = true;
    return false;
  }
  waits_since_.reset();
  under_way_until_ += waited;
  if (arrive_by_) *arrive_by_ += waited;
  if (due_back_) *due_back_ += waited;
  return true;
}

bool HeadAxes::is_there(const Joints& here, double within_rad) const {
  return std::max(std::abs(target_->pan_rad - here.pan_rad), std::abs(target_->tilt_rad - here.tilt_rad)) < within_rad;
}

std::string HeadAxes::trouble(const Axis& axis) const {
  std::string own = axis.trouble();
  if (!own.empty() || !returning_ || !target_) return own;
  return fmt::format("node {} is in order, but its head is not yet where it is asked to look", axis.settings().node);
}

void HeadAxes::stop(Frames& out) const {
  pan_.stop(out);
  tilt_.stop(out);
}

}  // namespace luxrig::cia402
