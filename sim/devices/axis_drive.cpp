#include "sim/devices/axis_drive.h"

#include <algorithm>
#include <cmath>

namespace luxrig::sim {
namespace {

constexpr double kStep_s = 0.001;
constexpr double kServo_per_s2 = 4000, kDamping_per_s = 126;  // critically damped at 10 Hz
constexpr double kReached_deg = 0.01;
constexpr std::uint16_t kFollowingError = 0x8611, kCommunicationError = 0x8130, kLimitError = 0x8612;
constexpr int kPosition = 1, kHome = 6;

}  // namespace

AxisDrive::AxisDrive(const AxisTruth& truth, double angle_deg)
    : mechanics_(truth, angle_deg), zero_(counts_of(angle_deg)) {}

bool AxisDrive::negative_switch() const {
  return mechanics_.truth().counts_per_degree > 0 ? mechanics_.at_min_switch() : mechanics_.at_max_switch();
}
bool AxisDrive::positive_switch() const {
  return mechanics_.truth().counts_per_degree > 0 ? mechanics_.at_max_switch() : mechanics_.at_min_switch();
}

void AxisDrive::set_power(bool on) {
  if (on == powered_) return;
  powered_ = on;
  state_ = State::disabled;
  word_ = error_code_ = 0;
  mode_ = 0;
  homed_ = acknowledged_ = internal_limit_ = false;
  queued_.reset();
  homing_ = Homing::idle;
  parameters = {};
  if (on) zero_ = counts_of(mechanics_.motor_deg());
}

void AxisDrive::enter(State state) {
  if (state == State::enabled && state_ != State::quick_stop) {
    demand_ = target_ = raw();
    demand_speed_ = velocity();
  }
  if (state == State::enabled) target_ = demand_;
  if (state != State::enabled) {
    acknowledged_ = false;
    queued_.reset();
    if (homing_ != Homing::idle && homing_ != Homing::done) homing_ = Homing::idle;
  }
  state_ = state;
}

void AxisDrive::fail(std::uint16_t code) {
  error_code_ = code;
  enter(State::fault);
}

void AxisDrive::abort_connection(int option) {
  if (option == 1) {
    fail(kCommunicationError);
  } else if (option == 2 && state_ != State::fault) {
    enter(State::disabled);
  } else if (option == 3 && state_ == State::enabled) {
    enter(State::quick_stop);
  }
}

void AxisDrive::set_controlword(std::uint16_t word) {
  const auto rising = static_cast<std::uint16_t>(word & ~word_);
  word_ = word;
  if (!powered_) return;
  if (state_ == State::fault) {
    if ((rising & 0x80) == 0) return;
    error_code_ = 0;
    enter(State::disabled);
    return;
  }
  const bool voltage = (word & 0x02) != 0, no_quick_stop = (word & 0x04) != 0;
  const bool shutdown = (word & 0x07) == 0x06, switch_on = (word & 0x0F) == 0x07, enable = (word & 0x0F) == 0x0F;
  switch (state_) {
    case State::disabled:
      if (shutdown) enter(State::ready);
      return;
    case State::ready:
    case State::switched_on:
      if (!voltage || !no_quick_stop) return enter(State::disabled);
      if (shutdown) return enter(State::ready);
      if (enable && state_ == State::switched_on) return enter(State::enabled);
      if (switch_on || enable) enter(State::switched_on);
      return;
    case State::quick_stop:
      if (!voltage) return enter(State::disabled);
      if (enable && parameters.quick_stop_option >= 5) enter(State::enabled);
      return;
    case State::enabled:
      if (!voltage) return enter(State::disabled);
      if (!no_quick_stop) return enter(State::quick_stop);
      if (shutdown) return enter(State::ready);
      if (switch_on) return enter(State::switched_on);
      take_enabled_word(word, rising);
      return;
    case State::fault:
      return;
  }
}

void AxisDrive::take_enabled_word(std::uint16_t word, std::uint16_t rising) {
  const bool start_bit = (word & 0x10) != 0;
  if (mode_ == kPosition) {
    if ((rising & 0x10) != 0) new_set_point((word & 0x20) != 0, (word & 0x40) != 0);
    if (!start_bit && !queued_) acknowledged_ = false;
  } else if (mode_ == kHome) {
    if ((rising & 0x10) != 0) {
      homed_ = false;
      const int method = parameters.homing_method;
      const bool negative = method == 1 || method == 17 || method == 33;
      homing_direction_ = negative ? -1 : 1;
      index_turn_ = mechanics_.index_turn();
      if (method == 35 || method == 37) {
        found_home();
      } else if (method == 33 || method == 34) {
        homing_ = Homing::to_index;
      } else if (method == 1 || method == 2 || method == 17 || method == 18) {
        homing_ = Homing::to_switch;
      } else {
        homing_ = Homing::error;
      }
    }
    if (!start_bit && homing_ != Homing::done && homing_ != Homing::error) homing_ = Homing::idle;
  }
}

void AxisDrive::new_set_point(bool immediately, bool relative) {
  double target = parameters.target + (relative ? target_ : 0);
  internal_limit_ = false;
  if (homed_ && parameters.lowest < parameters.highest) {
    const double within =
        std::clamp(target, static_cast<double>(parameters.lowest), static_cast<double>(parameters.highest));
    internal_limit_ = within != target;
    target = within;
  }
  acknowledged_ = true;
  const bool standing = demand_ == target_ && demand_speed_ == 0;
  if (immediately || standing) {
    queued_.reset();
    target_ = target;
  } else {
    queued_ = target;
  }
}

void AxisDrive::ramp_to(double speed, double acceleration, double dt_s) {
  const double before = demand_speed_;
  demand_speed_ += std::clamp(speed - demand_speed_, -acceleration * dt_s, acceleration * dt_s);
  demand_acceleration_ = (demand_speed_ - before) / dt_s;
  demand_ += (before + demand_speed_) / 2 * dt_s;
}

void AxisDrive::run_towards(double target, double speed, double acceleration, double deceleration, double dt_s) {
  const double way = target - demand_;
  // The speed from which it can still stop there, one step ahead since it will have moved by then.
  const double step = deceleration * dt_s / 2;
  const double stopping = std::sqrt(step * step + 2 * deceleration * std::abs(way)) - step;
  const double wanted = std::copysign(std::min(speed, stopping), way);
  const bool slows = std::abs(wanted) < std::abs(demand_speed_) || wanted * demand_speed_ < 0;
  ramp_to(wanted, slows ? deceleration : acceleration, dt_s);
  if (std::abs(target - demand_) < 0.5 && std::abs(demand_speed_) <= 2 * deceleration * dt_s + 1) {
    demand_ = target;
    demand_speed_ = demand_acceleration_ = 0;
  }
}

void AxisDrive::found_home() {
  zero_ = counts_of(mechanics_.motor_deg()) - parameters.home_offset;
  demand_ = raw();
  homed_ = true;
  homing_ = Homing::stopping;
}

void AxisDrive::step_homing(double dt_s) {
  const double fast = parameters.homing_speed_switch, slow = parameters.homing_speed_zero;
  const double acceleration = parameters.homing_acceleration;
  const bool at_switch = homing_direction_ < 0 ? negative_switch() : positive_switch();
  switch (homing_) {
    case Homing::to_switch:
      if (at_switch) {
        homing_ = Homing::off_switch;
      } else {
        ramp_to(homing_direction_ * fast, acceleration, dt_s);
      }
      break;
    case Homing::off_switch:
      ramp_to(-homing_direction_ * slow, acceleration, dt_s);
      if (at_switch || demand_speed_ * homing_direction_ > 0) break;
      if (parameters.homing_method < 3) {
        homing_ = Homing::to_index;
        homing_direction_ = -homing_direction_;
        index_turn_ = mechanics_.index_turn();
      } else {
        found_home();
      }
      break;
    case Homing::to_index:
      ramp_to(homing_direction_ * slow, acceleration, dt_s);
      if (mechanics_.index_turn() != index_turn_) found_home();
      break;
    case Homing::stopping:
      ramp_to(0, acceleration, dt_s);
      if (demand_speed_ == 0) {
        homing_ = Homing::done;
        target_ = demand_;
      }
      break;
    case Homing::idle:
    case Homing::done:
    case Homing::error:
      ramp_to(0, acceleration, dt_s);
      target_ = demand_;
      break;
  }
}

void AxisDrive::step_profile(double dt_s) {
  const double most = std::abs(counts_of(1.0)) * 1e4;  // numbers may exceed what a motor can do
  const auto within = [most](std::uint32_t value) { return std::clamp(static_cast<double>(value), 1.0, most); };
  if (state_ == State::quick_stop) {
    ramp_to(0, within(parameters.quick_stop_deceleration), dt_s);
    if (demand_speed_ == 0 && parameters.quick_stop_option < 5) enter(State::disabled);
  } else if ((word_ & 0x100) != 0) {  // halt
    ramp_to(0, within(parameters.deceleration), dt_s);
    if (mode_ == kPosition && demand_speed_ == 0) target_ = demand_;
  } else if (mode_ == kHome) {
    step_homing(dt_s);
  } else if (mode_ == kPosition) {
    run_towards(target_, within(parameters.speed), within(parameters.acceleration), within(parameters.deceleration),
                dt_s);
    if (queued_ && demand_ == target_ && demand_speed_ == 0) {
      target_ = *queued_;
      queued_.reset();
      if ((word_ & 0x10) == 0) acknowledged_ = false;
    }
  } else {
    ramp_to(0, within(parameters.deceleration), dt_s);
  }
}

double AxisDrive::torque() const {
  if (state_ != State::enabled && state_ != State::quick_stop) return 0;
  const double per_count = 1 / mechanics_.truth().counts_per_degree;
  const double behind_deg = (demand_ - raw()) * per_count;
  const double demand_deg_s = demand_speed_ * per_count;
  double torque = kServo_per_s2 * behind_deg + kDamping_per_s * (demand_deg_s - mechanics_.speed_deg_s()) +
                  demand_acceleration_ * per_count;
  if (demand_deg_s != 0)
    torque += std::copysign(mechanics_.truth().dry_friction_deg_s2, demand_deg_s) +
              mechanics_.truth().viscous_friction_per_s * demand_deg_s;
  return torque;
}

void AxisDrive::step(bool stuck) {
  if (powered_) {
    const bool runs = state_ == State::enabled || state_ == State::quick_stop;
    const bool still = demand_speed_ == 0 && homing_ != Homing::to_switch;
    if (mode_ != parameters.mode && (!runs || still)) {
      mode_ = parameters.mode;
      if (mode_ == kHome) homing_ = Homing::idle;
      acknowledged_ = false;
    }
    if (runs) step_profile(kStep_s);
    if (runs && parameters.following_window > 0) {
      off_window_ms_ = std::abs(demand_ - raw()) > parameters.following_window ? off_window_ms_ + 1 : 0;
      if (off_window_ms_ > parameters.following_time_ms) fail(kFollowingError);
    }
    // Beyond a switch only the way back is allowed, as the end stop comes next. Homing searches for the switches.
    const bool outward = (negative_switch() && demand_speed_ < 0) || (positive_switch() && demand_speed_ > 0);
    if (state_ == State::enabled && outward && mode_ != kHome) fail(kLimitError);
  }
  mechanics_.step(kStep_s, powered_ ? torque() : 0, stuck);
}

std::uint16_t AxisDrive::statusword() const {
  if (!powered_) return 0;
  std::uint16_t word = 0x0210;  // remote, voltage
  const auto set = [&word](int bits) { word = static_cast<std::uint16_t>(word | bits); };
  switch (state_) {
    case State::disabled:
      set(0x40);
      break;
    case State::ready:
      set(0x21);
      break;
    case State::switched_on:
      set(0x23);
      break;
    case State::enabled:
      set(0x27);
      break;
    case State::quick_stop:
      set(0x07);
      break;
    case State::fault:
      set(0x08);
      break;
  }
  if (mode_ == kHome) {
    if (homed_) set(1 << 12);
    if (homing_ == Homing::error) set(1 << 13);
    if (homing_ == Homing::done || homing_ == Homing::idle || homing_ == Homing::error) set(1 << 10);
  } else {
    if (acknowledged_) set(1 << 12);
    const double off_deg = std::abs((target_ - raw()) / mechanics_.truth().counts_per_degree);
    if (demand_ == target_ && off_deg < kReached_deg) set(1 << 10);
  }
  if (internal_limit_ || negative_switch() || positive_switch()) set(1 << 11);
  return word;
}

std::int32_t AxisDrive::position() const {
  return powered_ ? static_cast<std::int32_t>(std::clamp(std::round(raw()), -2147483647.0, 2147483647.0)) : 0;
}
std::int32_t AxisDrive::velocity() const {
  return static_cast<std::int32_t>(std::round(counts_of(mechanics_.speed_deg_s())));
}
std::uint32_t AxisDrive::digital_inputs() const {
  return (negative_switch() ? 1u : 0u) | (positive_switch() ? 2u : 0u);
}

}  // namespace luxrig::sim
