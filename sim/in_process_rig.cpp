#include "sim/in_process_rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace luxrig::sim {

InProcessRig::InProcessRig(Rig rig, std::unique_ptr<World> world, const InProcessOptions& options)
    : rig_(std::move(rig)),
      world_(std::move(world)),
      options_(options),
      faults_(options.fault_seed),
      taken_(rig_.luxmeters.size()) {
  LUXRIG_CHECK(world_ != nullptr && world_->fixtures().size() == rig_.fixtures.size() &&
                   world_->meter_gains().size() == rig_.luxmeters.size(),
               "world of another rig");
  const auto device = [this](const std::string& name, std::size_t bus, bool answers) {
    Device made;
    made.health.device = name;
    made.health.since = options_.start;
    made.bus = bus;
    made.answers = answers;
    return made;
  };
  for (std::size_t b = 0; b < rig_.buses.size(); ++b) buses_.push_back(device(rig_.buses[b].name, b, true));
  for (const Fixture& fixture : rig_.fixtures) {
    fixtures_.push_back(device(fixture.name, fixture.bus, std::holds_alternative<ModbusPatch>(fixture.patch)));
  }
  for (const Fixture& fixture : rig_.fixtures) {
    heads_.push_back(device(fixture.axes ? pan_axis_name(fixture) : fixture.name, fixture.motion_bus(),
                            fixture.axes || std::holds_alternative<ModbusPatch>(fixture.patch)));
  }
  for (const Luxmeter& meter : rig_.luxmeters) luxmeters_.push_back(device(meter.name, meter.bus, true));
}

bool InProcessRig::bus_is_dead(std::size_t bus) const {
  return faults_.find(rig_.buses[bus].name, FaultKind::dead).has_value();
}

Disturbance InProcessRig::disturb(std::size_t bus, const std::string& device) {
  if (!faults_.any()) {
    ++exchanges_;
    return {};
  }
  const std::string names[] = {rig_.buses[bus].name, device};
  return faults_.disturbance(names, exchanges_++);
}

void InProcessRig::went_well(Device& device, Time now) {
  Health& health = device.health;
  if (health.life != Life::active) health.since = now;
  health.life = Life::active;
  health.detail.clear();
  health.last_ok = now;
  device.failing = false;
}

void InProcessRig::went_wrong(Device& device, Time now, const std::string& why) {
  ++device.health.errors;
  if (!device.failing) device.silent_since = now;
  device.failing = true;
  device.failure = why;
}

void InProcessRig::apply_until(Time now) {
  while (!pending_.empty() && pending_.front().due <= now) {
    const Pending order = pending_.front();
    pending_.pop_front();
    world_->advance(Time{} + (order.due - options_.start));
    if (order.drive) world_->set_drive(order.fixture, *order.drive);
    if (order.joints) world_->set_aim_target(order.fixture, *order.joints);
  }
}

void InProcessRig::advance(Time now) {
  lamp_faults_.obey(rig_, {}, faults_, *world_);
  apply_until(now);
  world_->advance(Time{} + (now - options_.start));
}

void InProcessRig::stride(Time now) {
  apply_until(now);
  answers_.clear();
  world_->stride(Time{} + (now - options_.start));
}

/// A head's axes count as one device that answers.
template <class Command, class Queue>
Result<void> InProcessRig::send(Time now, std::span<const Command> commands, std::vector<Device>& devices,
                                const Queue& queue) {
  advance(now);
  std::optional<Fault> gone;
  std::vector<bool> used(buses_.size(), false);
  for (const Command& command : commands) {
    Device& device = devices[command.fixture];
    Device& bus = buses_[device.bus];
    used[device.bus] = true;
    if (bus_is_dead(device.bus)) {
      went_wrong(device, now, "bus is gone");
      went_wrong(bus, now, "connection refused");
      if (!gone) gone = Fault{Cause::network, bus.health.device, "connection refused", bus.silent_since};
      continue;
    }
    const Disturbance disturbance = disturb(device.bus, device.health.device);
    ++device.health.sent;
    ++bus.health.sent;
    went_well(bus, now);
    // A garbled or refused frame has no effect at the far end; only a device that answers reveals it.
    if (disturbance.silent || disturbance.garbled || disturbance.on_line || disturbance.exception ||
        disturbance.delay > options_.fault_after) {
      if (!device.answers) {
        went_well(device, now);
      } else if (disturbance.exception) {
        went_wrong(device, now, fmt::format("refused: exception {}", *disturbance.exception));
      } else {
        went_wrong(device, now, disturbance.garbled || disturbance.on_line ? "answer is garbled" : "no answer");
      }
      // A late device still obeys, and so does one whose answer the line garbles.
      if (!(disturbance.delay > options_.fault_after) && !disturbance.on_line) continue;
    } else {
      if (device.answers) ++device.health.received;
      went_well(device, now);
    }
    Pending order = queue(command);
    order.due = now + options_.write_latency + disturbance.delay;
    // Orders of one fixture never overtake each other.
    for (const Pending& earlier : pending_) {
      if (earlier.fixture == order.fixture) order.due = std::max(order.due, earlier.due);
    }
    const auto place = std::upper_bound(pending_.begin(), pending_.end(), order,
                                        [](const Pending& a, const Pending& b) { return a.due < b.due; });
    pending_.insert(place, order);
  }
  apply_until(now);
  if (gone) return tl::unexpected(*gone);
  return {};
}

Result<void> InProcessRig::write(Time now, std::span<const LevelCommand> commands) {
  for (const LevelCommand& command : commands) {
    if (command.fixture >= fixtures_.size() || !(command.drive >= 0 && command.drive <= 1)) {
      return tl::unexpected(Fault{
          Cause::invalid, "",
          fmt::format("drive {} for fixture {} of {}: nothing sent", command.drive, command.fixture, fixtures_.size()),
          now});
    }
  }
  return send(now, commands, fixtures_, [](const LevelCommand& command) {
    return Pending{{}, command.fixture, command.drive, std::nullopt};
  });
}

Result<void> InProcessRig::move(Time now, std::span<const AimCommand> commands) {
  for (const AimCommand& command : commands) {
    if (command.fixture >= fixtures_.size() || !rig_.fixtures[command.fixture].moves ||
        !std::isfinite(command.joints.pan_rad) || !std::isfinite(command.joints.tilt_rad) ||
        !std::isfinite(command.joints.beam_rad)) {
      return tl::unexpected(Fault{Cause::invalid, "",
                                  fmt::format("cannot move fixture {} to pan {} rad, tilt {} rad: nothing sent",
                                              command.fixture, command.joints.pan_rad, command.joints.tilt_rad),
                                  now});
    }
  }
  return send(now, commands, heads_, [](const AimCommand& command) {
    return Pending{{}, command.fixture, std::nullopt, command.joints};
  });
}

Result<std::vector<LuxReading>> InProcessRig::read(Time now) {
  advance(now);
  std::optional<Fault> gone;
  std::size_t reachable = 0;
  for (std::size_t m = 0; m < luxmeters_.size(); ++m) {
    Device& device = luxmeters_[m];
    Device& bus = buses_[device.bus];
    const double honest_lx = world_->meter_reading_lx(m);
    const double shown_lx = faults_.shown_lx(device.health.device, honest_lx);
    if (bus_is_dead(device.bus)) {
      went_wrong(device, now, "bus is gone");
      went_wrong(bus, now, "connection refused");
      gone = Fault{Cause::network, bus.health.device, "connection refused", bus.silent_since};
      continue;
    }
    ++reachable;
    const Time sampled = world_->meter_sampled_at(m);
    if (sampled == taken_[m]) continue;  // no new sample
    taken_[m] = sampled;
    const Disturbance disturbance = disturb(device.bus, device.health.device);
    ++device.health.sent;
    ++bus.health.sent;
    went_well(bus, now);
    if (disturbance.exception) {
      went_wrong(device, now, fmt::format("refused: exception {}", *disturbance.exception));
    } else if (disturbance.silent || disturbance.delay > options_.fault_after) {
      went_wrong(device, now, "no answer");
    } else if (disturbance.garbled || disturbance.on_line) {
      went_wrong(device, now, "answer is garbled");
    } else {
      const Time taken = options_.start + (sampled - Time{});
      answers_.push_back({taken + options_.read_latency + disturbance.delay, {m, shown_lx, taken}});
      ++device.health.received;
      ++bus.health.received;
      went_well(device, now);
    }
  }
  if (gone && reachable == 0) return tl::unexpected(*gone);
  std::vector<LuxReading> readings;
  std::erase_if(answers_, [&](const Answer& answer) {  // visits each once, in order
    if (answer.due > now) return false;
    readings.push_back(answer.reading);
    return true;
  });
  return readings;
}

std::vector<Health> InProcessRig::health(Time now) {
  advance(now);
  std::vector<Health> all;
  const auto add = [&](Device& device, Duration patience) {
    Health& health = device.health;
    if (device.failing && now - device.silent_since >= patience) {
      if (health.life != Life::faulted) health.since = now;
      health.life = Life::faulted;
      health.detail = fmt::format("{} for {:.1f} s", device.failure, to_seconds(now - device.silent_since));
    }
    all.push_back(health);
  };
  for (Device& bus : buses_) add(bus, Duration{});  // a refused connection is known at once
  for (Device& fixture : fixtures_) {
    if (fixture.answers) add(fixture, options_.fault_after);
  }
  for (std::size_t f = 0; f < heads_.size(); ++f) {
    if (rig_.fixtures[f].axes) add(heads_[f], options_.fault_after);
  }
  for (Device& meter : luxmeters_) add(meter, options_.fault_after);
  return all;
}

}  // namespace luxrig::sim
