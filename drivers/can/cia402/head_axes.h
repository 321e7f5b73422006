#pragma once
/// The two axes of one head, turned in step (core/output/head_move.h). When one of them is lost or has a fault the
/// other stops, so that the beam stays on the path it was on. That path is a straight line from a standstill; towards
/// an aim that replaces one under way each axis bends off as fast as its own limits let it. Neither begins before both
/// drives know how fast: one that is told by SDO needs some cycles for it. Pure.

#include <optional>
#include <string>

#include "core/output/head_move.h"
#include "core/rig/rig.h"
#include "drivers/can/cia402/axis.h"

namespace luxrig::cia402 {

/// What of the bus's options its axes share; units of the joint where it has any.
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
  /// Why the head does not look where it is asked: the axis's own trouble, or, after a loss, that it is on its way
  /// back. Empty in service, also while it turns to a new aim.
  [[nodiscard]] std::string pan_trouble() const { return trouble(pan_); }
  [[nodiscard]] std::string tilt_trouble() const { return trouble(tilt_); }
  /// Where the drives say it is; only once both are ready.
  [[nodiscard]] std::optional<Joints> joints() const;

 private:
  [[nodiscard]] std::string trouble(const Axis& axis) const;
  [[nodiscard]] bool begin_together(Time now);
  [[nodiscard]] bool is_there(const Joints& here, double within_rad) const;  ///< requires target_

  AxisPatch pan_patch_, tilt_patch_;
  AxisLimits pan_limits_, tilt_limits_;  ///< rad/s, rad/s²
  Axis pan_, tilt_;
  std::optional<Joints> target_, ordered_;
  bool ordered_again_ = false;       ///< as it stood a little beside its aim
  bool returning_ = true;            ///< from a loss, or from the start, to the aim
  std::optional<Time> due_back_;     ///< at the latest: it may follow an aim that moves
  Time under_way_until_{};           ///< by our own reckoning
  std::optional<Time> waits_since_;  ///< an order that has not begun
  std::optional<Time> arrive_by_;    ///< else the order did not mean what it should
};

}  // namespace luxrig::cia402
