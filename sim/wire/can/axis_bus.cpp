#include "sim/wire/can/axis_bus.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/check.h"

namespace luxrig::sim {
namespace {

constexpr Duration kAxisStep = std::chrono::milliseconds(1);
constexpr double kSwitchPastTravel_deg = 5, kStopPastSwitch_deg = 3;
constexpr double kFollowingWindow_deg = 2;
constexpr std::size_t kMaxDelayed = 4096;

std::uint32_t refusal_of(double value) { return value < 2 ? kNotMappable : value < 3 ? kPdoTooLong : kOutOfRange; }

}  // namespace

AxisTruth axis_truth(const AxisPatch& patch, double min_rad, double max_rad) {
  AxisTruth truth;
  const double home = deg_from_rad(patch.home_rad), min = deg_from_rad(min_rad), max = deg_from_rad(max_rad);
  truth.switch_min_deg = home <= min ? home : min - kSwitchPastTravel_deg;
  truth.switch_max_deg = home >= max ? home : max + kSwitchPastTravel_deg;
  truth.stop_min_deg = truth.switch_min_deg - kStopPastSwitch_deg;
  truth.stop_max_deg = truth.switch_max_deg + kStopPastSwitch_deg;
  truth.index_deg = home;
  truth.counts_per_degree = patch.counts_per_degree;
  truth.max_torque_deg_s2 = std::max(truth.max_torque_deg_s2, 3 * deg_from_rad(patch.acceleration_rad_s2));
  return truth;
}

AxisBus::AxisBus(const EndpointParts& parts) : parts_(parts), now_(parts.world.now()) {
  const std::vector<Joints> joints = parts.world.joints();
  for (std::size_t f = 0; f < parts.rig.fixtures.size(); ++f) {
    const Fixture& fixture = parts.rig.fixtures[f];
    if (!fixture.axes || fixture.axes->bus != parts.bus || fixture.housing.value_or(f) != f) continue;
    const auto add = [&](bool tilts, const std::string& name, const AxisPatch& patch, double min_rad, double max_rad,
                         double at_rad) {
      const auto window = std::lround(std::abs(kFollowingWindow_deg * patch.counts_per_degree));
      axes_.push_back({f, tilts, name,
                       std::make_unique<AxisNode>(patch.node, axis_truth(patch, min_rad, max_rad), deg_from_rad(at_rad),
                                                  static_cast<std::uint32_t>(std::max(window, 1l))),
                       false});
    };
    const JointRange& range = fixture.range;
    add(false, pan_axis_name(fixture), fixture.axes->pan, range.pan_min_rad, range.pan_max_rad, joints[f].pan_rad);
    add(true, tilt_axis_name(fixture), fixture.axes->tilt, range.tilt_min_rad, range.tilt_max_rad, joints[f].tilt_rad);
  }
}

const AxisBus::Axis& AxisBus::axis_of(std::size_t fixture, bool tilts) const {
  const auto found = std::find_if(axes_.begin(), axes_.end(),
                                  [&](const Axis& axis) { return axis.fixture == fixture && axis.tilts == tilts; });
  LUXRIG_CHECK(found != axes_.end(), "fixture {} has no axes here", fixture);
  return *found;
}

BusFrame AxisBus::garbled(BusFrame frame, std::uint64_t random) {
  // A CRC catches line errors, so this models a node that sends wrong data.
  if (random % 3 == 0) {
    frame.size = static_cast<std::uint8_t>(random / 3 % 9);
  } else if (frame.size > 0) {
    frame.data[random / 3 % frame.size] ^= static_cast<std::uint8_t>(1 + random / 64 % 255);
  }
  return frame;
}

void AxisBus::receive(Time now, const BusFrame& frame) {
  const std::string& bus = parts_.rig.buses[parts_.bus].name;
  const Disturbance disturbance = parts_.faults.disturbance({&bus, 1}, exchanges_++);
  if (disturbance.silent || off_ || arriving_.size() >= kMaxDelayed) return;
  Time due = now + disturbance.delay;
  if (!arriving_.empty()) due = std::max(due, arriving_.back().when);
  for (int i = 0; i < (disturbance.duplicated ? 2 : 1); ++i) arriving_.push_back({due, frame});
  deliver(now_);
}

void AxisBus::deliver(Time now) {
  while (!arriving_.empty() && arriving_.front().when <= now) {
    const BusFrame frame = arriving_.front().frame;
    arriving_.pop_front();
    for (Axis& axis : axes_) {
      const Disturbance disturbance = parts_.faults.disturbance({&axis.name, 1}, exchanges_++);
      if (!disturbance.silent) axis.node->receive(now, frame);
    }
  }
  collect(now);
}

void AxisBus::collect(Time now) {
  const std::string& bus = parts_.rig.buses[parts_.bus].name;
  for (Axis& axis : axes_) {
    const std::array<std::string, 2> names{bus, axis.name};
    for (const BusFrame& frame : axis.node->take_sent()) {
      const Disturbance disturbance = parts_.faults.disturbance(names, exchanges_++);
      if (disturbance.silent || off_ || leaving_.size() >= kMaxDelayed) continue;
      Time due = now + disturbance.delay;
      if (!leaving_.empty()) due = std::max(due, leaving_.back().when);
      const BusFrame said = disturbance.garbled ? garbled(frame, disturbance.random) : frame;
      for (int i = 0; i < (disturbance.duplicated ? 2 : 1); ++i) leaving_.push_back({due, said});
    }
  }
}

void AxisBus::switch_faults(Time now) {
  const std::string& bus = parts_.rig.buses[parts_.bus].name;
  if (const bool off = parts_.faults.find(bus, FaultKind::bus_off).has_value(); off != off_) {
    off_ = off;
    leaving_.clear();
    leaving_.push_back({now, {kErrorFrame | (off ? kBusOffError : kRestartedError), 8, {}}});
  }
  for (Axis& axis : axes_) {
    const auto unmappable = parts_.faults.find(axis.name, FaultKind::unmappable);
    axis.node->refuse_limits_in_pdos(unmappable ? std::optional(refusal_of(*unmappable)) : std::nullopt);
    axis.node->set_power(now, !parts_.faults.find(axis.name, FaultKind::dead));
    const bool reset = parts_.faults.find(axis.name, FaultKind::reset).has_value();
    if (reset && !axis.was_reset) axis.node->reset(now);
    axis.was_reset = reset;
  }
}

void AxisBus::advance(Time now) {
  switch_faults(now_);
  while (now_ + kAxisStep <= now) {
    now_ += kAxisStep;
    for (Axis& axis : axes_) axis.node->step(now_, parts_.faults.find(axis.name, FaultKind::stuck).has_value());
    deliver(now_);
  }
  for (std::size_t i = 0; i + 1 < axes_.size(); i += 2) {  // pan, then tilt of each head
    const Joints joints{rad_from_deg(axes_[i].node->drive().joint_deg()),
                        rad_from_deg(axes_[i + 1].node->drive().joint_deg())};
    for (std::size_t f = 0; f < parts_.rig.fixtures.size(); ++f) {
      const auto head = parts_.rig.fixtures[f].housing.value_or(f);
      if (head == axes_[i].fixture) parts_.world.set_joints(f, joints);
    }
  }
}

std::vector<BusFrame> AxisBus::take_sent() {
  while (!leaving_.empty() && leaving_.front().when <= now_) {
    sent_.push_back(leaving_.front().frame);
    leaving_.pop_front();
  }
  return std::exchange(sent_, {});
}

}  // namespace luxrig::sim
