#pragma once
/// The drive of one axis as in CiA 402-2: state machine, profile position, homing, quick stop, limits and following
/// error, with a servo loop on the mechanics. In counts of its encoder. Knows no bus. Steps of 1 ms.

#include <cstdint>
#include <optional>

#include "sim/devices/axis_mechanics.h"

namespace luxrig::sim {

/// Objects that are set from outside, with their numbers.
struct DriveParameters {
  std::int8_t mode = 0;                                               ///< 6060: 1 profile position, 6 homing
  std::int32_t target = 0;                                            ///< 607A
  std::int32_t lowest = INT32_MIN, highest = INT32_MAX;               ///< 607D; equal or crossed = off
  std::uint32_t speed = 1000;                                         ///< 6081
  std::uint32_t acceleration = 10000, deceleration = 10000;           ///< 6083, 6084
  std::uint32_t quick_stop_deceleration = 50000;                      ///< 6085
  std::int16_t quick_stop_option = 2;                                 ///< 605A: 2 ramp then off, 6 ramp and hold
  std::int32_t home_offset = 0;                                       ///< 607C: position counted at home
  std::int8_t homing_method = 0;                                      ///< 6098
  std::uint32_t homing_speed_switch = 1000, homing_speed_zero = 100;  ///< 6099
  std::uint32_t homing_acceleration = 10000;                          ///< 609A
  std::uint32_t following_window = 0;                                 ///< 6065; 0 = not watched
  std::uint16_t following_time_ms = 20;                               ///< 6066
};

class AxisDrive {
 public:
  /// Starts without power at the joint's angle and counts from 0 there.
  AxisDrive(const AxisTruth& truth, double angle_deg);

  DriveParameters parameters;

  /// Electronics on or off. When off, the motor is free and runs on by its momentum. When on again, the count starts at
  /// 0 and home is unknown.
  void set_power(bool on);
  void set_controlword(std::uint16_t word);
  /// Reaction to the loss of the master, by the abort connection option (6007): 0 nothing, 1 fault, 2 voltage off, 3
  /// quick stop.
  void abort_connection(int option);
  void step(bool stuck);

  [[nodiscard]] std::uint16_t statusword() const;
  [[nodiscard]] int mode_display() const { return mode_; }
  [[nodiscard]] std::int32_t position() const;                            ///< 6064
  [[nodiscard]] std::int32_t velocity() const;                            ///< 606C
  [[nodiscard]] std::uint16_t error_code() const { return error_code_; }  ///< 603F
  [[nodiscard]] std::uint32_t digital_inputs() const;                     ///< 60FD
  [[nodiscard]] bool homed() const { return homed_; }
  [[nodiscard]] double joint_deg() const { return mechanics_.joint_deg(); }
  [[nodiscard]] double speed_deg_s() const { return mechanics_.speed_deg_s(); }

 private:
  enum class State { disabled, ready, switched_on, enabled, quick_stop, fault };
  enum class Homing { idle, to_switch, off_switch, to_index, stopping, done, error };

  [[nodiscard]] double counts_of(double motor_deg) const { return motor_deg * mechanics_.truth().counts_per_degree; }
  [[nodiscard]] double raw() const { return counts_of(mechanics_.motor_deg()) - zero_; }
  [[nodiscard]] bool negative_switch() const;
  [[nodiscard]] bool positive_switch() const;
  void enter(State state);
  void fail(std::uint16_t code);
  void take_enabled_word(std::uint16_t word, std::uint16_t rising);
  void new_set_point(bool immediately, bool relative);
  void step_profile(double dt_s);
  void step_homing(double dt_s);
  void found_home();
  void ramp_to(double speed, double acceleration, double dt_s);
  void run_towards(double target, double speed, double acceleration, double deceleration, double dt_s);
  [[nodiscard]] double torque() const;

  AxisMechanics mechanics_;
  double zero_;  ///< encoder counts at which it shows 0
  bool powered_ = false, homed_ = false;
  State state_ = State::disabled;
  std::uint16_t word_ = 0, error_code_ = 0;
  int mode_ = 0;
  double demand_ = 0, demand_speed_ = 0, demand_acceleration_ = 0;  ///< followed by the servo
  double target_ = 0;
  bool acknowledged_ = false, internal_limit_ = false;
  std::optional<double> queued_;
  Homing homing_ = Homing::idle;
  int homing_direction_ = 0;
  long index_turn_ = 0;
  double off_window_ms_ = 0;
};

}  // namespace luxrig::sim
