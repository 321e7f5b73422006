#include "drivers/modbus/modbus_driver.h"

#include <fmt/format.h>

#include <algorithm>

#include "drivers/modbus/modbus_registers.h"

namespace luxrig {
namespace {

using modbus::ReadSchedule;
using modbus::WriteSchedule;
using std::chrono::milliseconds;

constexpr Duration kModbusWritePeriod = milliseconds(100);
constexpr Duration kShortestBackoff = milliseconds(100), kLongestBackoff = milliseconds(1000);
constexpr milliseconds kSchedulingSlack(50);
/// Allowed on top of the calls' period; a longer gap between two calls is this computer's own lateness.
constexpr Duration kCallSlack = milliseconds(150);
/// A bus is lost after two timeouts, once all its units are silent or none has answered for this long (two rounds, if
/// longer). One silent unit among answering ones is a fault of that unit only, after two timeouts in a row.
constexpr Duration kBusSilent = milliseconds(500);

}  // namespace

ModbusDriver::ModbusDriver(std::unique_ptr<modbus::Link> link, const ModbusTiming& timing, const Rig& rig,
                           std::size_t bus)
    : link_(std::move(link)),
      timing_(timing),
      rules_(modbus::unit_rules(rig, bus, timing.response_timeout, timing.behind_gateway,
                                timing.contact ? std::optional(timing.contact->unit) : std::nullopt)),
      writes_(rig, bus, timing.refresh, rules_),
      reads_(rig, bus, timing.poll, rules_),
      failures_(rules_, writes_.channels()),
      setup_(rules_),
      life_(rig.buses[bus].name),
      backoff_(kShortestBackoff) {
  for (const modbus::Channel& channel : writes_.channels()) {
    channel_lives_.emplace_back(rig.fixtures[channel.fixture].name);
  }
  if (timing.contact) contact_.emplace(*timing.contact);
  for (const std::size_t i : reads_.meters()) {
    const Luxmeter& meter = rig.luxmeters[i];
    meters_.push_back({i, meter.patch, meter.range_lx, LifeRecord(meter.name)});
  }
}

DriverBounds ModbusDriver::bounds() const {
  milliseconds longest = timing_.response_timeout;
  for (const auto& [unit, rule] : rules_) longest = std::max(longest, rule.timeout);
  DriverBounds bounds;
  // A request starts only within the response timeout and takes the longest unit timeout at most.
  bounds.write = bounds.read = timing_.response_timeout + longest + link_->longest_on_wire() + kSchedulingSlack;
  bounds.write_period = kModbusWritePeriod;
  bounds.read_period = meters_.empty() ? Duration{} : timing_.poll;
  if (contact_ && channel_lives_.empty())
    bounds.read_period = meters_.empty() ? kModbusWritePeriod : std::min(timing_.poll, kModbusWritePeriod);
  bounds.fault_after = asked_every() + silence_allowed() + bounds.write + kModbusWritePeriod;
  return bounds;
}

Result<void> ModbusDriver::activate(Time now) {
  if (life_.life() != Life::configured) return {};
  for (LifeRecord& life : channel_lives_) life.active(now);
  for (Meter& meter : meters_) meter.life.active(now);
  life_.active(now);
  backoff_ = kShortestBackoff;
  last_answer_ = now;
  called_at_ = now;
  silence_ = {};
  misses_ = 0;
  connect(now);
  return {};
}

void ModbusDriver::deactivate(Time now) {
  if (life_.life() == Life::configured) return;
  disconnect();
  for (LifeRecord& life : channel_lives_) life.configured(now);
  for (Meter& meter : meters_) meter.life.configured(now);
  reads_.forget();
  for (modbus::Channel& channel : writes_.channels()) channel.wanted.reset();
  life_.configured(now);
}

std::vector<Health> ModbusDriver::health(Time) const {
  std::vector<Health> all{life_.health()};
  for (std::size_t i = 0; i < channel_lives_.size(); ++i) {
    all.push_back(channel_lives_[i].health());
    const std::string failing = all.back().life == Life::active ? failures_.of_channel(i) : std::string();
    if (!failing.empty()) all.back().detail = "reports " + failing;
  }
  for (const Meter& meter : meters_) all.push_back(meter.life.health());
  return all;
}

Result<void> ModbusDriver::write(Time now, std::span<const LevelCommand> commands) {
  if (life_.life() == Life::configured) return tl::unexpected(inactive());
  if (auto set = set_wanted(commands); !set) return set;
  count_silence(now);
  const Deadline start_until(timing_.response_timeout);
  if (!ensure_connected(now)) return tl::unexpected(life_.fault());
  read_contact(now, start_until);
  for (const WriteSchedule::Run& run : writes_.due(now, units_silent_)) {
    if (start_until.passed() || write_run(now, run, start_until) == Outcome::over) break;
  }
  if (life_.life() != Life::faulted) {
    for (const modbus::FailureBits::Batch& batch : failures_.due(now, units_silent_)) {
      if (start_until.passed() || read_failures(now, batch, start_until) == Outcome::over) break;
    }
  }
  if (life_.life() == Life::faulted) return tl::unexpected(life_.fault());
  if (missed_) return tl::unexpected(fault_);
  for (const LifeRecord& life : channel_lives_) {
    if (life.life() == Life::faulted) return tl::unexpected(life.fault());
  }
  return {};
}

Result<std::vector<LuxReading>> ModbusDriver::read(Time now) {
  if (life_.life() == Life::configured) return tl::unexpected(inactive());
  count_silence(now);
  const Deadline start_until(timing_.response_timeout);
  if (!ensure_connected(now)) return tl::unexpected(life_.fault());
  if (channel_lives_.empty()) read_contact(now, start_until);  // else with the levels, which come more often
  std::vector<LuxReading> readings;
  for (const ReadSchedule::Batch& batch : reads_.due(now, units_silent_)) {
    if (start_until.passed() || read_batch(now, batch, start_until, readings) == Outcome::over) break;
  }
  if (readings.empty() && life_.life() == Life::faulted) return tl::unexpected(life_.fault());
  if (readings.empty() && missed_) return tl::unexpected(fault_);
  return readings;
}

std::optional<Contact> ModbusDriver::contact(Time now) const {
  return contact_ ? std::optional(contact_->contact(now)) : std::nullopt;
}

Fault ModbusDriver::inactive() const {
  return {Cause::inactive, life_.health().device, "the driver is not active", {}};
}

Duration ModbusDriver::asked_every() const {
  if (meters_.empty()) return timing_.refresh;
  return channel_lives_.empty() ? timing_.poll : std::min(timing_.poll, timing_.refresh);
}

Duration ModbusDriver::silence_allowed() const { return std::max(kBusSilent, 2 * asked_every()); }

void ModbusDriver::count_silence(Time now) {
  const Duration apart = std::max(asked_every(), kModbusWritePeriod) + kCallSlack;
  if (called_at_) silence_ += std::clamp(now - *called_at_, Duration{}, apart);
  called_at_ = now;
  missed_ = false;
}

Result<void> ModbusDriver::set_wanted(std::span<const LevelCommand> commands) {
  std::vector<modbus::Channel>& channels = writes_.channels();
  const auto find = [&](std::size_t fixture) {
    return std::find_if(channels.begin(), channels.end(), [&](const auto& c) { return c.fixture == fixture; });
  };
  for (const LevelCommand& command : commands) {
    const auto channel = find(command.fixture);
    if (channel == channels.end()) {
      return tl::unexpected(Fault{
          Cause::invalid, life_.health().device, fmt::format("fixture {} is not on this bus", command.fixture), {}});
    }
    if (!(command.drive >= 0 && command.drive <= 1)) {  // also when NaN
      const auto index = static_cast<std::size_t>(channel - channels.begin());
      return tl::unexpected(Fault{Cause::invalid,
                                  channel_lives_[index].health().device,
                                  fmt::format("drive {} is outside 0…1", command.drive),
                                  {}});
    }
  }
  for (const LevelCommand& command : commands) {
    const auto channel = find(command.fixture);
    channel->wanted = modbus::words_from_drive(command.drive, channel->patch, channel->wanted);
  }
  return {};
}

bool ModbusDriver::ensure_connected(Time now) {
  // Gateways close idle connections. That is no fault if the next connection is accepted.
  if (link_->connected() && link_->found_closed()) {
    writes_.forget();
    setup_.restart_all();
    connect_at_ = last_answer_ == answer_at_last_close_ ? now + backoff_ : now;
    answer_at_last_close_ = last_answer_;
    if (connect_at_ > now) bus_fault(now, {Cause::network, {}, "the peer closed the connection", {}});
  }
  if (link_->connected()) return true;
  if (now < connect_at_) return false;
  return connect(now);
}

bool ModbusDriver::connect(Time now) {
  auto connected = link_->connect(timing_.response_timeout);
  if (connected) return true;
  bus_fault(now, connected.error());
  return false;
}

void ModbusDriver::disconnect() {
  link_->close();
  writes_.forget();
  setup_.restart_all();  // the device behind a new connection may have restarted
  units_silent_.forget();
  failures_.forget();
}

void ModbusDriver::reconnect_later(Time now) {
  disconnect();
  connect_at_ = now + backoff_;
  backoff_ = std::min(2 * backoff_, kLongestBackoff);
}

/// The connection is lost, and with it every device behind it.
void ModbusDriver::bus_fault(Time now, const Fault& fault) {
  reconnect_later(now);
  all_faulted(now, fault);
}

void ModbusDriver::all_faulted(Time now, const Fault& fault) {
  life_.faulted(now, fault);
  for (LifeRecord& life : channel_lives_) life.faulted(now, fault);
  for (Meter& meter : meters_) meter.life.faulted(now, fault);
}

void ModbusDriver::answered(Time now, int unit) {
  last_answer_ = now;
  silence_ = {};
  misses_ = 0;
  backoff_ = kShortestBackoff;
  units_silent_.answered(unit);
  life_.count_received(now);
  if (life_.life() != Life::active) life_.active(now);
}

void ModbusDriver::unit_faulted(Time now, int unit, const Fault& fault) {
  for (std::size_t i = 0; i < channel_lives_.size(); ++i) {
    if (writes_.channels()[i].patch.unit == unit) channel_lives_[i].faulted(now, fault);
  }
  for (Meter& meter : meters_) {
    if (meter.patch.unit == unit) meter.life.faulted(now, fault);
  }
}

}  // namespace luxrig
