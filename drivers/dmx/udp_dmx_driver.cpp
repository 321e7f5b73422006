#include "drivers/dmx/udp_dmx_driver.h"

#include <fmt/format.h>

#include <algorithm>

namespace luxrig {
namespace {

constexpr Duration kReopenEvery = std::chrono::seconds(1);
// Network errors may come only once a second (Linux limits ICMP to that), so silence means recovery only after more
// than a second.
constexpr Duration kQuietBeforeRecovery = std::chrono::milliseconds(1200);
constexpr int kErrorsPerCycle = 64;
constexpr int kDatagramsPerCycle = 256;  // a flood must not delay the output

}  // namespace

UdpDmxDriver::UdpDmxDriver(std::vector<std::unique_ptr<DatagramChannel>> channels, const Rig& rig, std::size_t bus,
                           DeskOptions desk)
    : bay_(rig, bus),
      life_(rig.buses[bus].name),
      channels_(std::move(channels)),
      desk_(desk),
      frames_(bay_.universes().size()),
      silent_(bay_.universes().size(), 0) {}

Fault UdpDmxDriver::inactive() const {
  return {Cause::inactive, life_.health().device, "the driver is not active", {}};
}

bool UdpDmxDriver::any_open() const {
  return std::any_of(channels_.begin(), channels_.end(), [](const auto& channel) { return channel->is_open(); });
}

Duration UdpDmxDriver::write_bound() const {
  return std::chrono::milliseconds(5) +
         std::chrono::microseconds(100) * static_cast<std::int64_t>(bay_.universes().size() * channels_.size());
}

Result<void> UdpDmxDriver::activate(Time now) {
  if (life_.life() != Life::configured) return {};
  latest_ = now;
  life_.active(now);
  last_error_.reset();
  begin(now);
  open(now);
  return {};
}

void UdpDmxDriver::deactivate(Time now) {
  if (life_.life() == Life::configured) return;
  latest_ = now;
  close();
  life_.configured(now);
}

std::vector<DeskPart> UdpDmxDriver::parts() const {
  std::vector<DeskPart> parts;
  for (std::size_t i = 0; i < bay_.universes().size(); ++i) {
    parts.push_back(
        {fmt::format("{}, universe {}", life_.health().device, bay_.universes()[i].number), bay_.fixtures_of(i)});
  }
  return parts;
}

std::vector<CarriedUniverse> UdpDmxDriver::carried() const {
  std::vector<CarriedUniverse> carried;
  for (std::size_t i = 0; i < bay_.universes().size(); ++i) {
    const DmxUniverse& universe = bay_.universes()[i];
    carried.push_back({universe.number, {universe.slots.begin(), universe.slots.end()}, is_silent(i)});
  }
  return carried;
}

std::vector<int> UdpDmxDriver::desk_universes() const {
  std::vector<int> numbers;
  for (const DmxUniverse& universe : bay_.universes()) numbers.push_back(universe.number + desk_.offset);
  return numbers;
}

std::span<const DeskFrame> UdpDmxDriver::listen(Time now) {
  listen_to_network(now);
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    const HeardUniverse universe = heard(now, bay_.universes()[i].number + desk_.offset);
    frames_[i].presence = universe.presence;
    frames_[i].source = universe.source;
    frames_[i].commands = bay_.decode(i, universe.levels.slots, universe.levels.given);
  }
  return frames_;
}

void UdpDmxDriver::set_silent(Time now, std::size_t part, bool silent) {
  if (is_silent(part) == silent) return;
  silent_[part] = silent;
  if (silent && life_.life() != Life::configured) fall_silent(now, bay_.universes()[part]);
}

Result<void> UdpDmxDriver::move(Time, std::span<const AimCommand> commands) {
  if (life_.life() == Life::configured) return tl::unexpected(inactive());
  return bay_.set_aims(commands);
}

Result<void> UdpDmxDriver::write(Time now, std::span<const LevelCommand> commands) {
  if (life_.life() == Life::configured) return tl::unexpected(inactive());
  if (auto set = bay_.set_levels(commands); !set) return set;
  listen_to_network(now);
  if (!any_open()) return tl::unexpected(life_.fault());
  send_frame(now);
  update_life(now);
  if (life_.life() == Life::faulted) return tl::unexpected(life_.fault());
  return {};
}

bool UdpDmxDriver::settled() const {
  for (std::size_t i = 0; i < bay_.universes().size(); ++i)
    if (!is_silent(i) && !is_sent(bay_.universes()[i])) return false;
  return true;
}

void UdpDmxDriver::open(Time now) {
  reopen_at_ = now + kReopenEvery;
  for (const auto& channel : channels_) {
    if (channel->is_open()) continue;
    if (auto done = channel->open(); !done) {
      note_error(now, done.error());
    } else {
      opened(*channel);
    }
  }
}

void UdpDmxDriver::close() {
  if (any_open()) say_goodbye(latest_);
  for (const auto& channel : channels_) channel->close();
  rest();
}

void UdpDmxDriver::listen_to_network(Time now) {
  if (life_.life() == Life::configured) return;
  latest_ = now;
  const bool all_open =
      std::all_of(channels_.begin(), channels_.end(), [](const auto& channel) { return channel->is_open(); });
  if (!all_open && now >= reopen_at_) open(now);
  for (const auto& channel : channels_) {
    if (!channel->is_open()) continue;
    for (int i = 0; i < kErrorsPerCycle; ++i) {
      const auto error = channel->take_error();
      if (!error) break;
      note_error(now, *error);
    }
    for (int i = 0; i < kDatagramsPerCycle; ++i) {
      const auto datagram = channel->receive();
      if (!datagram) break;
      hear(now, *datagram);
    }
  }
}

void UdpDmxDriver::send(Time now, const SocketAddress& to, std::span<const std::uint8_t> bytes) {
  for (const auto& channel : channels_) {
    if (!channel->is_open()) continue;
    if (auto sent = channel->send(to, bytes); !sent) {
      note_error(now, sent.error());
      continue;
    }
    life_.count_sent();
    if (!has_answers() && last_error_ != now) life_.mark_ok(now);
  }
}

void UdpDmxDriver::note_error(Time now, const Fault& fault) {
  if (life_.life() == Life::configured) return;  // an unsendable goodbye has no one to report to
  last_error_ = now;
  Fault with_figures = fault;
  with_figures.detail += fmt::format(" ({} errors, {} packets)", life_.health().errors + 1, life_.health().sent);
  life_.faulted(now, with_figures);
}

void UdpDmxDriver::update_life(Time now) {
  if (const auto what = missing(now)) {
    life_.faulted(now, {Cause::timeout, {}, *what, {}}, life_.life() != Life::faulted);
    return;
  }
  if (life_.life() == Life::faulted && (!last_error_ || now - *last_error_ >= kQuietBeforeRecovery)) {
    life_.active(now);
    last_error_.reset();
  }
}

}  // namespace luxrig
