#include "drivers/modbus/modbus_tcp_driver.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "drivers/io/datagram.h"
#include "drivers/io/deadline.h"
#include "drivers/life.h"
#include "drivers/modbus/modbus_link.h"
#include "drivers/modbus/modbus_registers.h"
#include "drivers/modbus/modbus_schedule.h"
#include "drivers/options.h"

namespace luxrig {
namespace {

using modbus::Function;
using modbus::Link;
using modbus::Request;
using modbus::WriteSchedule;
using std::chrono::milliseconds;

constexpr OptionDoc kModbusOptions[] = {
    {"host", "text", "", "required", "an IPv4 address", "the Modbus TCP server: a device or a gateway"},
    {"port", "whole number", "", "502", "1 to 65535", "its TCP port"},
    {"response_timeout_ms", "whole number", "ms", "200", "20 to 5000",
     "how long one request may take; gateways to slow serial lines need up to 1000"},
    {"refresh_ms", "whole number", "ms", "400", "100 to 10000",
     "unchanged dimmer values are written again this often, so that a restarted dimmer gets its level back"},
    {"poll_ms", "whole number", "ms", "200", "20 to 10000", "each luxmeter is read this often"},
};

constexpr Duration kModbusWritePeriod = milliseconds(100);
constexpr Duration kShortestBackoff = milliseconds(100), kLongestBackoff = milliseconds(1000);
constexpr milliseconds kSchedulingSlack(50);
/// A bus is gone when nobody has answered for this long (or for two rounds, if rounds are longer) and a request timed
/// out; one silent unit among others that answer is that unit's fault only.
constexpr Duration kBusSilent = milliseconds(500);
constexpr Duration kReconnectSilentAfter = milliseconds(1000);

class ModbusTcpDriver final : public Driver, public LevelOutput, public LuxReader {
 public:
  ModbusTcpDriver(const Rig& rig, std::size_t bus, const std::optional<Redirect>& redirect)
      : timeout_(integer_option(rig.buses[bus], kModbusOptions, "response_timeout_ms")),
        refresh_(milliseconds(integer_option(rig.buses[bus], kModbusOptions, "refresh_ms"))),
        poll_(milliseconds(integer_option(rig.buses[bus], kModbusOptions, "poll_ms"))),
        link_(redirect ? redirect->host : string_option(rig.buses[bus], kModbusOptions, "host"),
              redirect ? redirect->port : static_cast<int>(integer_option(rig.buses[bus], kModbusOptions, "port"))),
        writes_(rig, bus, refresh_),
        life_(rig.buses[bus].name) {
    for (const modbus::Channel& channel : writes_.channels()) {
      channel_lives_.emplace_back(rig.fixtures[channel.fixture].name);
      units_.insert(channel.patch.unit);
    }
    for (std::size_t i = 0; i < rig.luxmeters.size(); ++i) {
      if (rig.luxmeters[i].bus != bus) continue;
      meters_.push_back({i, rig.luxmeters[i].patch, rig.luxmeters[i].range_lx, LifeRecord(rig.luxmeters[i].name), {}});
      units_.insert(rig.luxmeters[i].patch.unit);
    }
  }

  DriverBounds bounds() const override {
    DriverBounds bounds;
    // A request starts only within the first timeout, and takes one at most.
    bounds.write = bounds.read = 2 * timeout_ + kSchedulingSlack;
    bounds.write_period = kModbusWritePeriod;
    bounds.read_period = meters_.empty() ? Duration{} : poll_;
    bounds.fault_after = asked_every() + silence_allowed() + bounds.write + kModbusWritePeriod;
    return bounds;
  }

  Result<void> activate(Time now) override {
    if (life_.life() != Life::configured) return {};
    for (LifeRecord& life : channel_lives_) life.active(now);
    for (Meter& meter : meters_) meter.life.active(now);
    life_.active(now);
    backoff_ = kShortestBackoff;
    last_answer_ = now;
    connect(now);
    return {};
  }

  void deactivate(Time now) override {
    if (life_.life() == Life::configured) return;
    disconnect();
    for (LifeRecord& life : channel_lives_) life.configured(now);
    for (Meter& meter : meters_) {
      meter.life.configured(now);
      meter.asked.reset();
    }
    for (modbus::Channel& channel : writes_.channels()) channel.wanted_raw.reset();
    life_.configured(now);
  }

  std::vector<Health> health(Time) const override {
    std::vector<Health> all{life_.health()};
    for (const LifeRecord& life : channel_lives_) all.push_back(life.health());
    for (const Meter& meter : meters_) all.push_back(meter.life.health());
    return all;
  }

  LevelOutput* level_output() override { return channel_lives_.empty() ? nullptr : this; }
  LuxReader* lux_reader() override { return meters_.empty() ? nullptr : this; }

  Result<void> write(Time now, std::span<const LevelCommand> commands) override {
    if (life_.life() == Life::configured) return tl::unexpected(inactive());
    if (auto set = set_wanted(commands); !set) return set;
    const Deadline start_until(timeout_);
    if (!ensure_connected(now)) return tl::unexpected(life_.fault());
    bool cut = false;
    for (const WriteSchedule::Run& run : writes_.due(now, units_silent_)) {
      if (cut || start_until.passed()) break;
      cut = !write_run(now, run, start_until);
    }
    if (life_.life() == Life::faulted) return tl::unexpected(life_.fault());
    for (const LifeRecord& life : channel_lives_) {
      if (life.life() == Life::faulted) return tl::unexpected(life.fault());
    }
    return {};
  }

  Result<std::vector<LuxReading>> read(Time now) override {
    if (life_.life() == Life::configured) return tl::unexpected(inactive());
    const Deadline start_until(timeout_);
    if (!ensure_connected(now)) return tl::unexpected(life_.fault());
    std::vector<LuxReading> readings;
    for (const std::size_t index : due_meters(now)) {
      if (start_until.passed()) break;
      next_meter_ = (index + 1) % meters_.size();
      meters_[index].asked = now;
      if (!read_meter(now, meters_[index], readings)) break;
    }
    if (readings.empty() && life_.life() == Life::faulted) return tl::unexpected(life_.fault());
    return readings;
  }

 private:
  struct Meter {
    std::size_t luxmeter = 0;
    ModbusMeterPatch patch;
    double range_lx = 0;
    LifeRecord life;
    std::optional<Time> asked;
  };

  Fault inactive() const { return {Cause::inactive, life_.health().device, "the driver is not active", {}}; }

  Duration asked_every() const {
    if (meters_.empty()) return refresh_;
    return channel_lives_.empty() ? poll_ : std::min(poll_, refresh_);
  }
  Duration silence_allowed() const { return std::max(kBusSilent, 2 * asked_every()); }

  Result<void> set_wanted(std::span<const LevelCommand> commands) {
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
      channel->wanted_raw = modbus::raw_from_drive(command.drive, channel->patch.full_scale_raw);
    }
    return {};
  }

  // --- the connection ---

  bool ensure_connected(Time now) {
    // Gateways close connections that were idle for a while: that is no fault, if the next one is accepted.
    if (link_.connected() && link_.found_closed()) {
      writes_.forget();
      connect_at_ = last_answer_ == answer_at_last_close_ ? now + backoff_ : now;
      answer_at_last_close_ = last_answer_;
      if (connect_at_ > now) bus_fault(now, {Cause::network, {}, "the peer closed the connection", {}});
    }
    if (link_.connected()) return true;
    if (now < connect_at_) return false;
    return connect(now);
  }

  bool connect(Time now) {
    auto connected = link_.connect(timeout_);
    if (connected) return true;
    bus_fault(now, connected.error());
    return false;
  }

  void disconnect() {
    link_.close();
    writes_.forget();
    units_silent_.forget();  // a new connection may lead to a device that has restarted
  }

  /// The connection is gone, and with it every device behind it.
  void bus_fault(Time now, const Fault& fault) {
    disconnect();
    connect_at_ = now + backoff_;
    backoff_ = std::min(2 * backoff_, kLongestBackoff);
    all_faulted(now, fault);
  }

  void all_faulted(Time now, const Fault& fault) {
    life_.faulted(now, fault);
    for (LifeRecord& life : channel_lives_) life.faulted(now, fault);
    for (Meter& meter : meters_) meter.life.faulted(now, fault);
  }

  // --- requests ---

  void answered(Time now, int unit) {
    last_answer_ = now;
    backoff_ = kShortestBackoff;
    units_silent_.answered(unit);
    life_.count_received(now);
    if (life_.life() != Life::active) life_.active(now);
  }

  void unit_silent(Time now, int unit, const Fault& fault) {
    units_silent_.silent(unit, now);
    for (std::size_t i = 0; i < channel_lives_.size(); ++i) {
      if (writes_.channels()[i].patch.unit == unit) channel_lives_[i].faulted(now, fault);
    }
    for (Meter& meter : meters_) {
      if (meter.patch.unit == unit) meter.life.faulted(now, fault);
    }
    life_.count_error();
    const bool nobody = std::all_of(units_.begin(), units_.end(), [&](int u) { return units_silent_.is_silent(u); });
    if (nobody || now - last_answer_ >= silence_allowed()) all_faulted(now, fault);
    // A peer that lost power leaves a connection that TCP retries ever more slowly; a new one finds it at once.
    if (now - last_answer_ >= kReconnectSilentAfter && nobody) {
      disconnect();
      connect_at_ = now + backoff_;
      backoff_ = std::min(2 * backoff_, kLongestBackoff);
    }
  }

  /// False when the call should stop: a timeout has used up its bound, or the connection is gone.
  bool failed(Time now, int unit, Fault fault) {
    fault.detail = fmt::format("unit {}: {}", unit, fault.detail);
    if (!link_.connected()) {
      bus_fault(now, fault);
      return false;
    }
    if (fault.cause == Cause::timeout) {
      unit_silent(now, unit, fault);
      return false;
    }
    answered(now, unit);  // it said no, but it spoke
    return true;
  }

  bool write_run(Time now, WriteSchedule::Run run, const Deadline& start_until) {
    const std::vector<modbus::Channel>& channels = writes_.channels();
    const modbus::Channel& first = channels[run.begin];
    Request request;
    request.unit = first.patch.unit;
    request.function = run.size() == 1 ? Function::write_single : Function::write_multiple;
    request.first_register = first.patch.holding_register;
    for (std::size_t i = run.begin; i < run.end; ++i) request.values.push_back(*channels[i].wanted_raw);

    life_.count_sent();
    for (std::size_t i = run.begin; i < run.end; ++i) channel_lives_[i].count_sent();
    writes_.tried(run, now);
    auto done = link_.exchange(request, timeout_);
    if (done) {
      answered(now, request.unit);
      writes_.confirmed(run);
      for (std::size_t i = run.begin; i < run.end; ++i) {
        channel_lives_[i].count_received(now);
        if (channel_lives_[i].life() != Life::active) channel_lives_[i].active(now);
      }
      return true;
    }
    const int code = link_.last_exception();
    if (!failed(now, request.unit, done.error())) return false;
    if (run.size() > 1 && code >= 1 && code <= 3) {
      // Function 16 unknown, or one of the registers: the others shall not suffer for it.
      writes_.write_singly(request.unit);
      for (std::size_t i = run.begin; i < run.end && !start_until.passed(); ++i) {
        if (!write_run(now, {i, i + 1}, start_until)) return false;
      }
      return true;
    }
    for (std::size_t i = run.begin; i < run.end; ++i) {
      channel_lives_[i].faulted(now, {done.error().cause,
                                      {},
                                      fmt::format("unit {} register {}: {}", request.unit,
                                                  channels[i].patch.holding_register, done.error().detail),
                                      {}});
    }
    return true;
  }

  /// Meters to ask now, starting behind the last one asked. Those of silent units last: their timeout ends the call.
  std::vector<std::size_t> due_meters(Time now) const {
    std::vector<std::size_t> due;
    for (std::size_t i = 0; i < meters_.size(); ++i) {
      const std::size_t index = (next_meter_ + i) % meters_.size();
      const Meter& meter = meters_[index];
      if (meter.asked && now - *meter.asked < poll_) continue;
      if (units_silent_.may_ask(meter.patch.unit, now)) due.push_back(index);
    }
    std::stable_partition(due.begin(), due.end(),
                          [&](std::size_t i) { return !units_silent_.is_silent(meters_[i].patch.unit); });
    return due;
  }

  bool read_meter(Time now, Meter& meter, std::vector<LuxReading>& readings) {
    Request request;
    request.unit = meter.patch.unit;
    request.function = meter.patch.input_registers ? Function::read_input : Function::read_holding;
    request.first_register = meter.patch.first_register;
    request.count = static_cast<std::size_t>(meter.patch.registers);
    life_.count_sent();
    meter.life.count_sent();
    auto values = link_.exchange(request, timeout_);
    if (!values) {
      if (!failed(now, request.unit, values.error())) return false;
      meter.life.faulted(
          now, {values.error().cause,
                {},
                fmt::format("unit {} register {}: {}", request.unit, request.first_register, values.error().detail),
                {}});
      return true;
    }
    answered(now, request.unit);
    const double lux = modbus::lux_from_registers(meter.patch, *values);
    const auto plausible = modbus::plausible_lux(lux, meter.range_lx);
    if (!plausible) {
      meter.life.faulted(
          now, {Cause::protocol, {}, fmt::format("reads {} lx, but its range ends at {} lx", lux, meter.range_lx), {}});
      return true;
    }
    meter.life.count_received(now);
    if (meter.life.life() != Life::active) meter.life.active(now);
    readings.push_back({meter.luxmeter, *plausible, now});
    return true;
  }

  milliseconds timeout_;
  Duration refresh_{}, poll_{};
  Link link_;
  WriteSchedule writes_;
  std::vector<LifeRecord> channel_lives_;  ///< beside writes_.channels()
  std::vector<Meter> meters_;
  std::size_t next_meter_ = 0;
  std::set<int> units_;
  modbus::UnitBackoff units_silent_;
  LifeRecord life_;
  Time last_answer_{}, answer_at_last_close_{};
  Time connect_at_{};
  Duration backoff_ = kShortestBackoff;
};

}  // namespace

std::span<const OptionDoc> modbus_tcp_options() { return kModbusOptions; }

std::vector<Problem> check_modbus_tcp(const Rig& rig, std::size_t bus) {
  const Bus& entry = rig.buses[bus];
  std::vector<Problem> problems = check_options(rig, entry, kModbusOptions);
  const auto report = [&](const Place& place, std::string what, std::string mend) {
    problems.push_back({rig.file.string(), place.line, place.column, std::move(what), std::move(mend)});
  };
  if (problems.empty()) {
    const std::string host = string_option(entry, kModbusOptions, "host");
    const auto address = parse_ipv4(host);
    if (!address || *address == 0 || is_multicast(*address) || *address == 0xFFFFFFFF) {
      problems.push_back(problem_at(rig, entry, "host", fmt::format("host = \"{}\" is no IPv4 address", host),
                                    "write numbers, such as \"192.168.1.30\" (a name would need a resolver, which may "
                                    "block)"));
    }
  }
  const auto check_registers = [&](const Place& place, const std::string& what, int unit, int first, int count) {
    if (unit < 0 || unit > 255) {
      report(place, fmt::format("{}: unit {} does not exist", what, unit), "choose a unit in 0…255");
    } else if (first < 0 || first + count > 65536) {
      report(place, fmt::format("{}: register {} does not exist", what, first),
             fmt::format("choose a register in 0…{}", 65536 - count));
    }
  };
  for (const Fixture& fixture : rig.fixtures) {
    if (fixture.bus != bus) continue;
    const std::string what = fmt::format("fixture \"{}\"", fixture.name);
    const auto* patch = std::get_if<ModbusPatch>(&fixture.patch);
    if (patch == nullptr) {
      report(fixture.place, fmt::format("{} has a DMX address, but its bus \"{}\" is Modbus", what, entry.name),
             "give it unit and register in place of universe and address, or another bus");
      continue;
    }
    check_registers(fixture.place, what, patch->unit, patch->holding_register, 1);
    if (patch->full_scale_raw < 1 || patch->full_scale_raw > 65535) {
      report(fixture.place, fmt::format("{}: full_scale {} does not fit a register", what, patch->full_scale_raw),
             "choose a full_scale in 1…65535");
    }
    if (fixture.moves && !fixture.axes) {
      report(fixture.place, fmt::format("{} has pan and tilt, which a Modbus dimmer cannot drive", what),
             "put it on a DMX bus, give it an axes_bus, or leave out its pan and tilt ranges");
    }
  }
  for (const Luxmeter& meter : rig.luxmeters) {
    if (meter.bus != bus) continue;
    check_registers(meter.place, fmt::format("luxmeter \"{}\"", meter.name), meter.patch.unit,
                    meter.patch.first_register, meter.patch.registers);
  }
  return problems;
}

std::unique_ptr<Driver> make_modbus_tcp(const Rig& rig, std::size_t bus, const std::optional<Redirect>& redirect) {
  return std::make_unique<ModbusTcpDriver>(rig, bus, redirect);
}

}  // namespace luxrig
