// The requests of ModbusDriver, and the effect of their answers on the devices.
#include <fmt/format.h>
#include <poll.h>

#include <algorithm>

#include "drivers/modbus/modbus_driver.h"
#include "drivers/modbus/modbus_registers.h"

namespace luxrig {
namespace {

using modbus::Function;
using modbus::ReadSchedule;
using modbus::Request;
using modbus::WriteSchedule;
using std::chrono::milliseconds;

constexpr Duration kReconnectSilentAfter = milliseconds(1000);

/// Function 16, or reading several, may be unknown, or one of the registers bad: single requests may succeed.
bool may_be_good_singly(int exception) { return exception >= 1 && exception <= 3; }

}  // namespace

void ModbusDriver::unit_silent(Time now, int unit, const Fault& fault) {
  // Where answers are not numbered, a late one would pass for the next. So the unit is left alone until its longest
  // answer time has passed once more.
  const Duration timeout = rules_.at(unit).timeout;
  const bool again = units_silent_.is_silent(unit);
  units_silent_.silent(unit, now, link_->answers_are_numbered() ? Duration{} : 2 * timeout, timeout);
  ++misses_;
  missed_ = true;
  // One missing answer, perhaps of a busy machine, is not a failure: the unit is asked once more.
  const bool nobody =
      std::all_of(rules_.begin(), rules_.end(), [&](const auto& rule) { return units_silent_.is_silent(rule.first); });
  const bool bus_is_gone = misses_ > 1 && (nobody || silence_ >= silence_allowed());
  if (!again && !bus_is_gone && fault.cause == Cause::timeout) {
    life_.count_error();
    // The error count in the health report reveals a unit that comes and goes.
    for (std::size_t i = 0; i < channel_lives_.size(); ++i)
      if (writes_.channels()[i].patch.unit == unit) channel_lives_[i].count_error();
    for (Meter& meter : meters_)
      if (meter.patch.unit == unit) meter.life.count_error();
    return;
  }
  setup_.restart(unit);
  failures_.forget(unit);
  unit_faulted(now, unit, fault);
  life_.count_error();
  if (nobody || bus_is_gone) all_faulted(now, fault);
  // A peer that lost power leaves a connection that TCP retries ever more slowly; a new one finds it at once.
  if (silence_ >= kReconnectSilentAfter && nobody) reconnect_later(now);
}

ModbusDriver::Outcome ModbusDriver::ask(Time now, const Request& request, const Deadline& start_until) {
  const modbus::UnitRules& rule = rules_.at(request.unit);
  if (const auto rest = resting_.find(request.unit); rest != resting_.end()) {
    const milliseconds left = rest->second.left();
    if (left > start_until.left()) return Outcome::skipped;
    if (left > milliseconds(0)) ::poll(nullptr, 0, static_cast<int>(left.count()));
    resting_.erase(rest);
  }
  life_.count_sent();
  auto values = link_->exchange(request, rule.timeout);
  if (!values && link_->connected() && link_->may_repeat() && !start_until.passed()) {
    life_.count_error();
    life_.count_sent();
    values = link_->exchange(request, rule.timeout);
  }
  if (rule.gap > milliseconds(0)) resting_.insert_or_assign(request.unit, Deadline(rule.gap));
  if (values) {
    answered(now, request.unit);
    values_ = std::move(*values);
    return Outcome::done;
  }
  fault_ = std::move(values.error());
  fault_.detail = fmt::format("unit {}: {}", request.unit, fault_.detail);
  if (!link_->connected()) {
    bus_fault(now, fault_);
    return Outcome::over;
  }
  if (fault_.cause == Cause::refused) {
    answered(now, request.unit);  // it refused, but it answered
    return Outcome::refused;
  }
  unit_silent(now, request.unit, fault_);
  return Outcome::over;
}

ModbusDriver::Outcome ModbusDriver::set_up(Time now, int unit, const Deadline& start_until) {
  while (const modbus::UnitSetup::Write* write = setup_.next(unit)) {
    if (start_until.passed()) return Outcome::skipped;
    Request request;
    request.unit = unit;
    request.function = write->coil               ? Function::write_coil
                       : write->words.count == 1 ? Function::write_single
                                                 : Function::write_multiple;
    request.first_register = write->first_register;
    request.values.assign(write->words.word.begin(),
                          write->words.word.begin() + static_cast<std::ptrdiff_t>(write->words.count));
    const Outcome outcome = ask(now, request, start_until);
    if (outcome == Outcome::refused) {
      // Without an armed watchdog it would hold its light when it must not, so it gets no levels.
      unit_faulted(now, unit,
                   {fault_.cause,
                    {},
                    fmt::format("{} while \"{}\" was set up: check that its register map is of this product",
                                fault_.detail, write->name),
                    {}});
      units_silent_.silent(unit, now, kReconnectSilentAfter, {});
      setup_.restart(unit);
      return Outcome::skipped;
    }
    if (outcome != Outcome::done) return outcome;
    setup_.written(unit);
  }
  return Outcome::done;
}

ModbusDriver::Outcome ModbusDriver::write_run(Time now, const WriteSchedule::Run& run, const Deadline& start_until) {
  const Request request = writes_.request_for(run);
  if (const Outcome ready = set_up(now, request.unit, start_until); ready != Outcome::done) return ready;
  const Outcome outcome = ask(now, request, start_until);
  if (outcome == Outcome::skipped) return outcome;
  for (std::size_t i = run.begin; i < run.end; ++i) channel_lives_[i].count_sent();
  writes_.tried(run, now);
  if (outcome == Outcome::done) {
    writes_.confirmed(run);
    for (std::size_t i = run.begin; i < run.end; ++i) {
      channel_lives_[i].count_received(now);
      if (channel_lives_[i].life() != Life::active) channel_lives_[i].active(now);
    }
  }
  if (outcome != Outcome::refused) return outcome;
  if (run.size() > 1 && may_be_good_singly(link_->last_exception())) {
    writes_.write_singly(request.unit);
    for (std::size_t i = run.begin; i < run.end && !start_until.passed(); ++i) {
      const Outcome single = write_run(now, writes_.alone(i), start_until);
      if (single == Outcome::over) return single;
    }
    return Outcome::done;
  }
  for (std::size_t i = run.begin; i < run.end; ++i) {
    channel_lives_[i].faulted(
        now,
        {fault_.cause,
         {},
         fmt::format("unit {} {} {}: {}", request.unit, writes_.channels()[i].patch.coil ? "coil" : "register",
                     writes_.channels()[i].patch.holding_register, modbus::exception_name(link_->last_exception())),
         {}});
  }
  return outcome;
}

ModbusDriver::Outcome ModbusDriver::read_batch(Time now, const ReadSchedule::Batch& batch, const Deadline& start_until,
                                               std::vector<LuxReading>& readings) {
  const Request& request = batch.request;
  if (const Outcome ready = set_up(now, request.unit, start_until); ready != Outcome::done) return ready;
  const Outcome outcome = ask(now, request, start_until);
  if (outcome == Outcome::skipped) return outcome;
  reads_.asked(batch, now);
  for (std::size_t i = batch.begin; i < batch.end; ++i) meters_[i].life.count_sent();
  if (outcome == Outcome::over) return outcome;
  if (outcome == Outcome::done) {
    std::span<const std::uint16_t> rest = values_;
    for (std::size_t i = batch.begin; i < batch.end; ++i) {
      const auto registers = static_cast<std::size_t>(meters_[i].patch.registers);
      take_reading(now, meters_[i], rest.first(registers), readings);
      rest = rest.subspan(registers);
    }
    return outcome;
  }
  if (batch.end - batch.begin > 1 && may_be_good_singly(link_->last_exception())) {
    reads_.read_singly(request.unit);
    for (std::size_t i = batch.begin; i < batch.end && !start_until.passed(); ++i) {
      const ModbusMeterPatch& patch = meters_[i].patch;
      const Request single{
          patch.unit, request.function, patch.first_register, static_cast<std::size_t>(patch.registers), {}};
      if (read_batch(now, {i, i + 1, single}, start_until, readings) == Outcome::over) return Outcome::over;
    }
    return Outcome::done;
  }
  for (std::size_t i = batch.begin; i < batch.end; ++i) {
    meters_[i].life.faulted(now, {fault_.cause,
                                  {},
                                  fmt::format("unit {} register {}: {}", request.unit, meters_[i].patch.first_register,
                                              modbus::exception_name(link_->last_exception())),
                                  {}});
  }
  return outcome;
}

ModbusDriver::Outcome ModbusDriver::read_failures(Time now, const modbus::FailureBits::Batch& batch,
                                                  const Deadline& start_until) {
  const Outcome outcome = ask(now, batch.request, start_until);
  if (outcome == Outcome::skipped) return outcome;
  failures_.asked(batch, now);
  // Refusing these reads is no fault of the unit; its levels are as good as before.
  if (outcome == Outcome::refused) life_.count_error();
  if (outcome == Outcome::done) failures_.answered(batch, values_);
  return outcome;
}

void ModbusDriver::read_contact(Time now, const Deadline& start_until) {
  if (!contact_ || !units_silent_.may_ask(contact_->unit(), now)) return;
  const auto request = contact_->due(now);
  if (!request) return;
  const Outcome outcome = ask(now, *request, start_until);
  if (outcome == Outcome::skipped) return;
  contact_->asked(now);
  if (outcome == Outcome::done && !values_.empty()) contact_->answered(now, values_.front() != 0);
}

void ModbusDriver::take_reading(Time now, Meter& meter, std::span<const std::uint16_t> words,
                                std::vector<LuxReading>& readings) {
  const double lux = modbus::lux_from_registers(meter.patch, words);
  const auto plausible = modbus::plausible_lux(lux, meter.range_lx);
  if (!plausible) {
    meter.life.faulted(
        now, {Cause::protocol, {}, fmt::format("reads {} lx, but its range ends at {} lx", lux, meter.range_lx), {}});
    return;
  }
  meter.life.count_received(now);
  if (meter.life.life() != Life::active) meter.life.active(now);
  readings.push_back({meter.luxmeter, *plausible, now});
}

}  // namespace luxrig
