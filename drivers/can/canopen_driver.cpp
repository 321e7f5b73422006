#include "drivers/can/canopen_driver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "drivers/can/bus_state.h"
#include "drivers/can/can_datagrams.h"
#include "drivers/can/can_socket.h"
#include "drivers/can/canopen/cob_id.h"
#include "drivers/can/cia402/head_axes.h"
#include "drivers/io/udp.h"
#include "drivers/life.h"
#include "drivers/options.h"

namespace luxrig {
namespace {

using cia402::HeadAxes;
using std::chrono::milliseconds;

constexpr Duration kCallBound = milliseconds(20);  ///< nothing waits; this allows for a slow machine
constexpr Duration kShortestReopen = milliseconds(100), kLongestReopen = milliseconds(1000);
constexpr Duration kShortestQueuePause = milliseconds(20), kLongestQueuePause = milliseconds(200);
constexpr int kMaxFramesAtOnce = 2000;  ///< per call, so that a flood cannot delay it
constexpr double kTravelSlack_rad = 1e-6;

cia402::AxesOptions axes_options(const Bus& bus) {
  const auto docs = canopen_options();
  const auto number = [&](std::string_view key) { return integer_option(bus, docs, key); };
  cia402::AxesOptions options;
  options.master_node = static_cast<int>(number("master_node"));
  options.cycle = milliseconds(number("cycle_ms"));
  options.heartbeat = milliseconds(number("heartbeat_ms"));
  const std::string home = string_option(bus, docs, "home");
  options.home = home == "never"         ? cia402::HomeRule::never
                 : home == "when needed" ? cia402::HomeRule::when_needed
                                         : cia402::HomeRule::at_start;
  options.homing_method = static_cast<int>(number("homing_method"));
  options.homing_speed_share = static_cast<double>(number("homing_speed_percent")) / 100;
  options.homing_timeout = std::chrono::seconds(number("homing_timeout_s"));
  options.hold_on_stop = string_option(bus, docs, "on_stop") == "hold";
  options.fault_resets = static_cast<int>(number("fault_resets"));
  return options;
}

class CanopenDriver final : public Driver, public Mover {
 public:
  CanopenDriver(const Rig& rig, std::size_t bus, std::unique_ptr<can::CanChannel> channel)
      : options_(axes_options(rig.buses[bus])),
        period_(options_.cycle),
        channel_(std::move(channel)),
        life_(rig.buses[bus].name) {
    for (std::size_t i = 0; i < rig.fixtures.size(); ++i) {
      const Fixture& fixture = rig.fixtures[i];
      if (!fixture.axes || fixture.axes->bus != bus) continue;
      ranges_.emplace(i, fixture.sent_range());
      if (fixture.housing.value_or(i) != i) continue;  // the first light of a housing turns it
      heads_.push_back(
          {i, HeadAxes(fixture, options_), LifeRecord(pan_axis_name(fixture)), LifeRecord(tilt_axis_name(fixture))});
    }
  }

  DriverBounds bounds() const override {
    DriverBounds bounds;
    bounds.write = kCallBound;
    bounds.write_period = period_;
    bounds.fault_after = 3 * options_.heartbeat + period_ + kCallBound;
    return bounds;
  }

  Result<void> activate(Time now) override {
    if (life_.life() != Life::configured) return {};
    for (Head& head : heads_) head.axes.activate(now);
    state_.reset();
    last_heard_.reset();
    next_cycle_ = heartbeat_at_ = open_at_ = quiet_until_ = now;
    reopen_after_ = kShortestReopen;
    set_lives(now, "no node has been heard yet", Cause::timeout, false);
    open(now);
    return {};
  }

  void deactivate(Time now) override {
    if (life_.life() == Life::configured) return;
    if (channel_->is_open()) {
      cia402::Frames frames;
      for (const Head& head : heads_) head.axes.stop(frames);
      if (!frames.empty()) frames.push_back(can::data_frame(canopen::kSync, {}));
      send(now, frames);
      channel_->close();
    }
    for (Head& head : heads_) {
      head.pan.configured(now);
      head.tilt.configured(now);
    }
    life_.configured(now);
  }

  std::vector<Health> health(Time) const override {
    std::vector<Health> all{life_.health()};
    for (const Head& head : heads_) {
      all.push_back(head.pan.health());
      all.push_back(head.tilt.health());
    }
    return all;
  }

  Mover* mover() override { return this; }

  Result<void> move(Time now, std::span<const AimCommand> commands) override {
    if (life_.life() == Life::configured)
      return tl::unexpected(Fault{Cause::inactive, life_.health().device, "the driver is not active", {}});
    if (auto good = check(commands); !good) return good;
    for (const AimCommand& command : commands) {
      const auto head =
          std::find_if(heads_.begin(), heads_.end(), [&](const Head& h) { return h.fixture == command.fixture; });
      // The zoom belongs to the lamp, on another bus: it turns no axis.
      if (head != heads_.end()) head->axes.set_target({command.joints.pan_rad, command.joints.tilt_rad, 0});
    }
    listen(now);
    if (now >= next_cycle_) {
      next_cycle_ = std::max(next_cycle_ + period_, now + period_ / 2);  // no burst after a stall
      cycle(now);
    }
    judge(now);
    if (life_.life() == Life::faulted) return tl::unexpected(life_.fault());
    for (const Head& head : heads_) {
      for (const LifeRecord* life : {&head.pan, &head.tilt}) {
        if (life->life() == Life::faulted) return tl::unexpected(life->fault());
      }
    }
    return {};
  }

 private:
  struct Head {
    std::size_t fixture;
    HeadAxes axes;
    LifeRecord pan, tilt;
  };

  Result<void> check(std::span<const AimCommand> commands) const {
    const auto invalid = [&](std::string detail) {
      return tl::unexpected(Fault{Cause::invalid, life_.health().device, std::move(detail), {}});
    };
    const auto within = [](double angle, double lowest, double highest) {
      return angle >= lowest - kTravelSlack_rad && angle <= highest + kTravelSlack_rad;  // false for a NaN
    };
    for (const AimCommand& command : commands) {
      const auto found = ranges_.find(command.fixture);
      if (found == ranges_.end()) return invalid(fmt::format("fixture {} is not turned by this bus", command.fixture));
      const JointRange& range = found->second;
      if (!within(command.joints.pan_rad, range.pan_min_rad, range.pan_max_rad) ||
          !within(command.joints.tilt_rad, range.tilt_min_rad, range.tilt_max_rad)) {
        return invalid(fmt::format("pan {}°, tilt {}° of fixture {} is outside its travel",
                                   deg_from_rad(command.joints.pan_rad), deg_from_rad(command.joints.tilt_rad),
                                   command.fixture));
      }
    }
    return {};
  }

  // --- the bus ---

  bool open(Time now) {
    if (channel_->is_open()) return true;
    if (now < open_at_) return false;
    auto opened = channel_->open();
    if (opened) {
      state_.reset();
      return true;
    }
    open_at_ = now + reopen_after_;
    reopen_after_ = std::min(2 * reopen_after_, kLongestReopen);
    trouble_ = opened.error();
    return false;
  }

  void listen(Time now) {
    for (int i = 0; i < kMaxFramesAtOnce; ++i) {
      const auto frame = channel_->receive();
      if (!frame) break;
      state_.heard(*frame);
      if (frame->error) continue;
      last_heard_ = now;
      trouble_.reset();
      reopen_after_ = kShortestReopen;
      life_.count_received(now);
      for (Head& head : heads_) {
        head.axes.receive(now, *frame);
        const auto node = static_cast<int>(frame->id & 0x7F);
        if (node == head.axes.pan().settings().node) head.pan.count_received(now);
        if (node == head.axes.tilt().settings().node) head.tilt.count_received(now);
      }
    }
    while (auto error = channel_->take_error()) {
      trouble_ = std::move(*error);
      if (!channel_->is_open()) open_at_ = now + reopen_after_;
    }
  }

  /// Sends each axis its frames, then the SYNC on which all act at once.
  void cycle(Time now) {
    cia402::Frames frames;
    if (now >= heartbeat_at_) {
      heartbeat_at_ = std::max(heartbeat_at_ + options_.heartbeat, now + options_.heartbeat / 2);
      frames.push_back(canopen::heartbeat_frame(canopen::NmtState::operational, options_.master_node));
    }
    for (Head& head : heads_) {
      const std::size_t before = frames.size();
      head.axes.step(now, frames);
      for (std::size_t i = before; i < frames.size(); ++i) {
        const auto node = static_cast<int>(frames[i].id & 0x7F);
        if (node == head.axes.pan().settings().node) head.pan.count_sent();
        if (node == head.axes.tilt().settings().node) head.tilt.count_sent();
      }
    }
    frames.push_back(can::data_frame(canopen::kSync, {}));
    if (open(now)) send(now, frames);
  }

  void send(Time now, const cia402::Frames& frames) {
    if (now < quiet_until_ || state_.state() == can::ControllerState::off) return;
    for (const can::CanFrame& frame : frames) {
      const auto sent = channel_->send(frame);
      if (!sent) {
        trouble_ = sent.error();
        if (!channel_->is_open()) open_at_ = now + reopen_after_;
        return;
      }
      if (*sent == can::Sent::queue_full) {
        // No node acknowledges, or the line is full: more frames would only wait. The next cycle repeats them.
        quiet_until_ = now + queue_pause_;
        queue_pause_ = std::min(2 * queue_pause_, kLongestQueuePause);
        trouble_ =
            Fault{Cause::network, "", "the transmit queue is full: no node acknowledges, or txqueuelen is short", {}};
        return;
      }
    }
    life_.count_sent();  // cycles; frames are counted at the axes
    queue_pause_ = kShortestQueuePause;
  }

  // --- health ---

  /// Life of the bus, then of each axis.
  void judge(Time now) {
    const Duration patience = 3 * options_.heartbeat;
    const bool heard = last_heard_ && now - *last_heard_ <= patience;
    if (state_.state() == can::ControllerState::off) {
      set_lives(now, "the controller is bus-off: check cable, termination and bit rate; restart-ms brings it back",
                Cause::network, life_.life() == Life::active);
      return;
    }
    if (!heard) {
      const std::string silence = last_heard_ ? "no node is heard any more" : "no node has been heard yet";
      set_lives(now, trouble_ ? trouble_->detail : silence, trouble_ ? trouble_->cause : Cause::timeout,
                life_.life() == Life::active);
      return;
    }
    if (life_.life() != Life::active) life_.active(now);
    for (Head& head : heads_) {
      judge_axis(now, head.axes.pan_trouble(), head.axes.pan(), head.pan);
      judge_axis(now, head.axes.tilt_trouble(), head.axes.tilt(), head.tilt);
    }
  }

  static void judge_axis(Time now, const std::string& trouble, const cia402::Axis& axis, LifeRecord& life) {
    if (!trouble.empty()) {
      life.faulted(now, {Cause::refused, {}, trouble, {}}, life.life() == Life::active);
    } else if (life.life() != Life::active) {
      life.active(now, axis.remark());
    }
  }

  void set_lives(Time now, const std::string& why, Cause cause, bool is_new) {
    const Fault fault{cause, {}, why, {}};
    life_.faulted(now, fault, is_new);
    for (Head& head : heads_) {
      head.pan.faulted(now, fault, is_new && head.pan.life() == Life::active);
      head.tilt.faulted(now, fault, is_new && head.tilt.life() == Life::active);
    }
  }

  cia402::AxesOptions options_;
  Duration period_;
  std::unique_ptr<can::CanChannel> channel_;
  can::BusState state_;
  std::vector<Head> heads_;
  std::map<std::size_t, JointRange> ranges_;  ///< by fixture, for every light that is turned here
  LifeRecord life_;
  Time next_cycle_{}, heartbeat_at_{}, open_at_{}, quiet_until_{};
  Duration reopen_after_ = kShortestReopen, queue_pause_ = kShortestQueuePause;
  std::optional<Time> last_heard_;
  std::optional<Fault> trouble_;  ///< of the channel, until a frame arrives
};

/// Identifiers that the bus's nodes send to a master.
std::vector<std::uint32_t> ids_to_hear(const Rig& rig, std::size_t bus) {
  std::vector<std::uint32_t> ids;
  for (const Fixture& fixture : rig.fixtures) {
    if (!fixture.axes || fixture.axes->bus != bus) continue;
    for (const AxisPatch& axis : {fixture.axes->pan, fixture.axes->tilt}) {
      for (const std::uint32_t kind :
           {canopen::kEmergency, canopen::kTransmitPdo1, canopen::kTransmitPdo1 + canopen::kNextPdo,
            canopen::kSdoToClient, canopen::kHeartbeat}) {
        ids.push_back(kind + static_cast<std::uint32_t>(axis.node));
      }
    }
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

}  // namespace

std::unique_ptr<Driver> make_canopen(const Rig& rig, std::size_t bus, std::unique_ptr<can::CanChannel> channel) {
  return std::make_unique<CanopenDriver>(rig, bus, std::move(channel));
}

std::unique_ptr<Driver> make_canopen(const Rig& rig, std::size_t bus, const std::optional<Redirect>& redirect) {
  if (redirect) {
    const SocketAddress to{parse_ipv4(redirect->host).value_or(0), static_cast<std::uint16_t>(redirect->port)};
    return make_canopen(rig, bus, can::make_can_datagrams(to, make_udp({})));
  }
  return make_canopen(
      rig, bus,
      can::make_can_socket({string_option(rig.buses[bus], canopen_options(), "interface"), ids_to_hear(rig, bus)}));
}

AxesWithoutData canopen_axes_without_data(const Rig& rig, std::size_t fixture) {
  const cia402::AxesOptions options = axes_options(rig.buses[rig.fixtures[fixture].axes->bus]);
  return {!options.hold_on_stop, to_seconds(3 * options.heartbeat),  // as object 1016 is set
          "CiA 301: 1016, 1029; CiA 402: 6007, 605A"};
}

}  // namespace luxrig
