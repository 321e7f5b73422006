#pragma once
/// All axes of one CAN bus, with the faults that befall them and the bus, and the heads of the world turned by them.
/// Steps of 1 ms; a function of what it was told when. No socket: can_endpoint.cpp puts one around it.

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "sim/wire/bus_endpoint.h"
#include "sim/wire/can/axis_node.h"

namespace luxrig::sim {

/// What an axis truly is, where the rig file says nothing: its limit switches stand at its home when that is at or
/// beyond an end of its travel, else 5° past the ends; the end stops 3° past the switches.
[[nodiscard]] AxisTruth axis_truth(const AxisPatch& patch, double min_rad, double max_rad);

class AxisBus {
 public:
  /// The axes have power from `parts.world.now()` on, and stand where the world's heads do.
  explicit AxisBus(const EndpointParts& parts);

  /// A frame from outside, the master's. It takes effect at `now`, or later under the fault `slow`.
  void receive(Time now, const BusFrame& frame);
  /// Runs to `now`, and turns the world's heads.
  void advance(Time now);
  /// What the nodes have sent to the outside until the time it was run to.
  [[nodiscard]] std::vector<BusFrame> take_sent();

  /// Of a fixture, as it truly is; for tests.
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
