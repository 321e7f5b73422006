#pragma once
/// All axes of one CAN bus, with the faults of axes and bus; they turn the heads of the world. Steps of 1 ms;
/// deterministic in its timed inputs. No socket: can_endpoint.cpp adds one.

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "sim/wire/bus_endpoint.h"
#include "sim/wire/can/axis_node.h"

namespace luxrig::sim {

/// True axis, where the rig file is silent. If the home position is at or beyond an end of the travel, that limit
/// switch stands there; otherwise the switches are 5° past the ends. The end stops are 3° past the switches.
[[nodiscard]] AxisTruth axis_truth(const AxisPatch& patch, double min_rad, double max_rad);

class AxisBus {
 public:
  /// The axes have power from `parts.world.now()` on, and start at the world's head positions.
  explicit AxisBus(const EndpointParts& parts);

  /// A frame from the master. It takes effect at `now`, or later under the fault `slow`.
  void receive(Time now, const BusFrame& frame);
  /// Runs to `now` and turns the world's heads.
  void advance(Time now);
  /// Frames that the nodes have sent up to the time of advance().
  [[nodiscard]] std::vector<BusFrame> take_sent();

  /// True node of a fixture, for tests.
  [[nodiscard]] const AxisNode& pan(std::size_t fixture) const { return *axis_of(fixture, false).node; }
  [[nodiscard]] const AxisNode& tilt(std::size_t fixture) const { return *axis_of(fixture, true).node; }

 private:
  struct Axis {
    std::size_t fixture;
    bool tilts;
    std::string name;
    std::unique_ptr<AxisNode> node;
    bool was_reset = false;
  };
  struct Due {
    Time when;
    BusFrame frame;
  };

  [[nodiscard]] const Axis& axis_of(std::size_t fixture, bool tilts) const;
  void switch_faults(Time now);
  void deliver(Time now);
  void collect(Time now);
  static BusFrame garbled(BusFrame frame, std::uint64_t random);

  EndpointParts parts_;
  std::vector<Axis> axes_;
  std::deque<Due> arriving_, leaving_;
  std::vector<BusFrame> sent_;
  Time now_{};
  std::uint64_t exchanges_ = 0;
  bool off_ = false;
};

}  // namespace luxrig::sim
