#pragma once
/// The two axes of one head, turned in step (core/output/head_move.h). If one is lost or faulted the other stops, so
/// that the beam stays on its path. From a standstill that path is a straight line. Towards an aim that replaces one
/// under way, each axis bends off as fast as its own limits allow. Neither begins before both drives have their limits;
/// a drive that gets them by SDO needs some cycles. Pure.

#include <optional>
#include <string>

#include "core/output/head_move.h"
#include "core/rig/equipment.h"
#include "drivers/can/cia402/axis.h"

namespace luxrig::cia402 {

/// Bus options that its axes share; in units of the joint.
struct AxesOptions {
  int master_node = 127;
  Duration cycle = std::chrono::milliseconds(20);
  Duration heartbeat = std::chrono::milliseconds(100);
  HomeRule home = HomeRule::at_start;
  int homing_method = 17;
  double homing_speed_share = 0.1;  ///< of the axis's speed
  Duration homing_timeout = std::chrono::seconds(60);
  bool hold_on_stop = true;
  int fault_resets = 3;
};

class HeadAxes {
 public:
  /// requires fixture.axes
  HeadAxes(const Fixture& fixture, const AxesOptions& options);

  void activate(Time now);
  void receive(Time now, const can::CanFrame& frame);
  void set_target(const Joints& joints) { target_ = joints; }
  void step(Time now, Frames& out);
  void stop(Frames& out) const;

  [[nodiscard]] const Axis& pan() const { return pan_; }
  [[nodiscard]] const Axis& tilt() const { return tilt_; }
  /// Why the head is not at its aim: the axis's own trouble, or its way back after a loss. Empty in service, even while
  /// it turns to a new aim.
  [[nodiscard]] std::string pan_trouble() const { return trouble(pan_); }
  [[nodiscard]] std::string tilt_trouble() const { return trouble(tilt_); }
  /// Position that the drives report; empty until both are ready.
  [[nodiscard]] std::optional<Joints> joints() const;

 private:
  [[nodiscard]] std::string trouble(const Axis& axis) const;
  [[nodiscard]] bool begin_together(Time now);
  [[nodiscard]] bool is_there(const Joints& here, double within_rad) const;  ///< requires target_

  AxisPatch pan_patch_, tilt_patch_;
  AxisLimits pan_limits_, tilt_limits_;  ///< rad/s, rad/s²
  Axis pan_, tilt_;
  std::optional<Joints> target_, ordered_;
  bool ordered_again_ = false;       ///< because it stood slightly beside its aim
  bool returning_ = true;            ///< to the aim, after a loss or the start
  std::optional<Time> due_back_;     ///< latest time of return: it may follow a moving aim
  Time under_way_until_{};           ///< by our own calculation
  std::optional<Time> waits_since_;  ///< an order has waited to begin since then
  std::optional<Time> arrive_by_;    ///< if missed, the order did not have its intended effect
};

}  // namespace luxrig::cia402
