#include "core/show/health_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "core/show/alarm_log.h"

namespace luxrig {

HealthWatch::HealthWatch(const Rig& rig)
    : known_(names_of(rig)), fixtures_on_bus_(rig.buses.size(), 0), heads_on_bus_(rig.buses.size(), 0) {
  for (const Fixture& fixture : rig.fixtures) {
    bus_of_fixture_.push_back(fixture.bus);
    motion_bus_of_fixture_.push_back(fixture.motion_bus());
    if (fixture.bus < fixtures_on_bus_.size()) ++fixtures_on_bus_[fixture.bus];
    const auto* modbus = std::get_if<ModbusPatch>(&fixture.patch);
    unit_of_fixture_.push_back(modbus != nullptr ? std::optional<int>(modbus->unit) : std::nullopt);
    if (fixture.axes && fixture.axes->bus < heads_on_bus_.size()) ++heads_on_bus_[fixture.axes->bus];
  }
  lamp_lost_.assign(rig.fixtures.size(), false);
  lamp_silent_.assign(rig.fixtures.size(), false);
  lamp_failing_.assign(rig.fixtures.size(), false);
  lamp_bypassed_.assign(rig.fixtures.size(), false);
  motion_lost_.assign(rig.fixtures.size(), false);
  for (const Luxmeter& luxmeter : rig.luxmeters) {
    meters_.emplace_back();
    meters_.back().name = luxmeter.name;
    meters_.back().bus = luxmeter.bus;
    meters_.back().unit = luxmeter.patch.unit;
  }
  for (const Bus& bus : rig.buses) bus_names_.push_back(bus.name);
}

std::map<std::string, HealthWatch::Known> HealthWatch::names_of(const Rig& rig) {
  std::map<std::string, Known> known;
  for (std::size_t b = 0; b < rig.buses.size(); ++b) {
    const bool lights =
        std::any_of(rig.fixtures.begin(), rig.fixtures.end(), [&](const auto& f) { return f.bus == b; });
    const bool turns = std::any_of(rig.fixtures.begin(), rig.fixtures.end(),
                                   [&](const auto& f) { return f.axes && f.axes->bus == b; });
    known.emplace(rig.buses[b].name, Known{lights ? Role::light_bus : turns ? Role::axes_bus : Role::meter_bus, b});
  }
  for (std::size_t i = 0; i < rig.fixtures.size(); ++i) known.emplace(rig.fixtures[i].name, Known{Role::fixture, i});
  for (std::size_t i = 0; i < rig.fixtures.size(); ++i) {
    if (!rig.fixtures[i].axes) continue;
    known.emplace(pan_axis_name(rig.fixtures[i]), Known{Role::axis, i});
    known.emplace(tilt_axis_name(rig.fixtures[i]), Known{Role::axis, i});
  }
  for (std::size_t i = 0; i < rig.luxmeters.size(); ++i) {
    known.emplace(rig.luxmeters[i].name, Known{Role::luxmeter, i});
  }
  return known;
}

void HealthWatch::report(std::span<const Health> devices) {
  const Health* const before = report_.data();
  report_.assign(devices.begin(), devices.end());
  const auto is_named = [](const Health& health, const std::string& name) { return health.device == name; };
  looked_up_ = looked_up_ && report_.data() == before &&
               std::equal(report_.begin(), report_.end(), reported_.begin(), reported_.end(), is_named);
}

void HealthWatch::look_up() {
  if (std::exchange(looked_up_, true)) return;
  reported_.clear();
  counted_of_report_.clear();
  for (const Health& health : report_) {
    reported_.push_back(health.device);
    const auto [entry, fresh] = counted_.try_emplace(health.device);
    if (fresh) entry->second.known = known(health.device);
    counted_of_report_.push_back(&entry->second);
  }
  counted_of_meter_.assign(meters_.size(), nullptr);
  report_of_meter_.assign(meters_.size(), nullptr);
  for (std::size_t i = 0; i < meters_.size(); ++i) {
    const auto counted = counted_.find(meters_[i].name);
    if (counted != counted_.end()) counted_of_meter_[i] = &counted->second;
    const auto own =
        std::find_if(report_.begin(), report_.end(), [&](const Health& h) { return h.device == meters_[i].name; });
    if (own != report_.end()) report_of_meter_[i] = &*own;
  }
}

void HealthWatch::heard(std::size_t luxmeter, Time taken) {
  meters_[luxmeter].heard = std::max(meters_[luxmeter].heard, taken);
  meters_[luxmeter].was_garbled = false;
}

void HealthWatch::garbled(std::size_t luxmeter, Time now) {
  meters_[luxmeter].garbled = now;
  meters_[luxmeter].was_garbled = true;
}

void HealthWatch::judged(std::size_t luxmeter, Time now, const std::string& why, bool stuck) {
  Meter& meter = meters_[luxmeter];
  if (meter.implausible.empty() && !why.empty()) meter.implausible_since = now;
  meter.implausible = why;
  meter.stuck = stuck;
}

bool HealthWatch::any_meter_gone() const {
  return std::any_of(meters_.begin(), meters_.end(),
                     [](const Meter& meter) { return !meter.bypassed && meter.trust.lost() && !meter.disagrees; });
}

bool HealthWatch::any_meter_lost() const {
  return std::any_of(meters_.begin(), meters_.end(),
                     [](const Meter& meter) { return meter.trust.lost() && !meter.bypassed; });
}

std::string HealthWatch::cause(bool of_light) const {
  const Alarm* first = nullptr;
  for (const Alarm& alarm : alarms_) {
    if (!alarm.severe) continue;
    if (!first) first = &alarm;
    const Role role = known(alarm.device).role;
    if ((role == Role::luxmeter || role == Role::meter_bus) != of_light) return alarm.text;
  }
  return first ? first->text : "";
}

HealthWatch::Known HealthWatch::known(const std::string& device) const {
  if (const auto found = known_.find(device); found != known_.end()) return found->second;
  for (auto colon = device.find(": "); colon != std::string::npos; colon = device.find(": ", colon + 1)) {
    const auto found = known_.find(device.substr(0, colon));
    if (found == known_.end()) continue;
    const Role role = found->second.role;
    if (role == Role::light_bus || role == Role::axes_bus || role == Role::meter_bus)
      return {Role::bus_part, found->second.index};
  }
  return {};
}

Alarm HealthWatch::alarm_of(const Health& health, const Known& known) const {
  Alarm alarm{true, health.device, {}, health.since};
  const std::string detail = health.detail.empty() ? "no cause given" : health.detail;
  switch (known.role) {
    case Role::light_bus:
      alarm.text = fmt::format(
          "bus \"{}\" is gone ({}): its {} fixtures cannot be controlled and do what they do without data; check its "
          "cable, its power and its address",
          health.device, detail, fixtures_on_bus_[known.index]);
      break;
    case Role::axes_bus:
      alarm.text = fmt::format(
          "bus \"{}\" is gone ({}): its {} heads cannot be turned and look where they stopped; check its cable, its "
          "termination, its power and its bit rate",
          health.device, detail, heads_on_bus_[known.index]);
      break;
    case Role::axis:
      alarm.text = fmt::format(
          "{} cannot be turned ({}): its beam is not where it shall be; check its power, its node number and that "
          "nothing blocks it",
          health.device, detail);
      break;
    case Role::meter_bus:
      alarm.text = fmt::format(
          "bus \"{}\" is gone ({}): its luxmeters are not heard; check its cable, its power and "
          "its address",
          health.device, detail);
      break;
    case Role::bus_part:
      alarm.text = fmt::format(
          "\"{}\" is gone ({}): fixtures that hang on it cannot be controlled and do what they do without data; check "
          "its power and its cable",
          health.device, detail);
      break;
    case Role::fixture:
      alarm.text = fmt::format(
          "the dimmer of fixture \"{}\" does not answer ({}): it cannot be controlled; check its "
          "power and its address",
          health.device, detail);
      break;
    case Role::luxmeter:
      alarm.text =
          fmt::format("luxmeter \"{}\" does not answer ({}); check its power and its address", health.device, detail);
      break;
    case Role::unknown:
      alarm.text = fmt::format("device \"{}\" has failed ({}); check its power and its address", health.device, detail);
      break;
  }
  return alarm;
}

/// A dimmer that obeys but reports a fault: a lamp has burnt out, or it is too hot.
void HealthWatch::warn_of(const Health& health) {
  const auto found = known_.find(health.device);
  if (found == known_.end() || found->second.role != Role::fixture) return;
  lamp_failing_[found->second.index] = true;
  alarms_.push_back(
      {false, health.device,
       fmt::format("fixture \"{}\" {}: its light may not be what is asked; look at its lamp and its dimmer",
                   health.device, health.detail),
       health.since});
}

/// Joins alarms of devices behind one Modbus unit that fail for the same reason: the unit itself has failed.
void HealthWatch::join_units() {
  struct Unit {
    std::vector<const Health*> fixtures, meters;
    Time since{};
  };
  std::map<std::tuple<std::size_t, int, std::string>, Unit> units;
  for (const Health& health : report_) {
    const auto found = known_.find(health.device);
    const bool told = std::any_of(alarms_.begin(), alarms_.end(),
                                  [&](const Alarm& alarm) { return alarm.severe && alarm.device == health.device; });
    if (health.life != Life::faulted || found == known_.end() || !told) continue;
    const auto [role, index] = found->second;
    const bool is_meter = role == Role::luxmeter;
    if (!is_meter && !(role == Role::fixture && unit_of_fixture_[index])) continue;
    Unit& unit = units[{is_meter ? meters_[index].bus : bus_of_fixture_[index],
                        is_meter ? meters_[index].unit : *unit_of_fixture_[index], health.detail}];
    if (unit.fixtures.empty() && unit.meters.empty()) unit.since = health.since;
    unit.since = std::min(unit.since, health.since);
    (is_meter ? unit.meters : unit.fixtures).push_back(&health);
  }
  const auto list = [](const std::vector<const Health*>& devices) {
    std::string text;
    for (const Health* device : devices) text += fmt::format("{}\"{}\"", text.empty() ? "" : ", ", device->device);
    return text;
  };
  for (const auto& entry : units) {  // clang's lambdas in C++20 capture no structured bindings
    const auto& [bus, number, detail] = entry.first;
    const Unit& unit = entry.second;
    if (unit.fixtures.size() + unit.meters.size() < 2) continue;
    const auto of_unit = [&](const Alarm& alarm) {
      const auto same = [&](const Health* device) { return device->device == alarm.device; };
      return alarm.severe && (std::any_of(unit.fixtures.begin(), unit.fixtures.end(), same) ||
                              std::any_of(unit.meters.begin(), unit.meters.end(), same));
    };
    const auto first = std::find_if(alarms_.begin(), alarms_.end(), of_unit);
    if (first == alarms_.end()) continue;  // all are bypassed
    std::string text = fmt::format("unit {} of bus \"{}\" does not answer ({}): ", number,
                                   bus < bus_names_.size() ? bus_names_[bus] : std::string(), detail);
    if (!unit.fixtures.empty())
      text +=
          fmt::format("fixture{} {} cannot be controlled", unit.fixtures.size() > 1 ? "s" : "", list(unit.fixtures));
    if (!unit.meters.empty())
      text +=
          fmt::format("{}luxmeter{} {} not heard", unit.fixtures.empty() ? "" : ", ", unit.meters.size() > 1 ? "s" : "",
                      list(unit.meters) + (unit.meters.size() > 1 ? " are" : " is"));
    *first = {true, first->device, text + "; check its power and its address", unit.since};
    alarms_.erase(std::remove_if(std::next(first), alarms_.end(), of_unit), alarms_.end());
  }
}

void HealthWatch::step_meter(Time now, std::size_t luxmeter, bool faulted, Duration patience) {
  Meter& meter = meters_[luxmeter];
  const Health* own = report_of_meter_[luxmeter];
  const std::uint64_t asked = own == nullptr ? 0 : own->sent;
  const bool heard = meter.heard != meter.heard_before;
  if (heard) meter.asked_before = asked;
  meter.heard_before = meter.heard;
  const Duration silence = now - meter.heard - meter.unseen;
  const bool silent = silence > (asked > 0 && asked == meter.asked_before ? kUnaskedFor : kSilentAfter);
  const bool implausible = !meter.implausible.empty();
  const Counted* counted = counted_of_meter_[luxmeter];
  const bool missed = counted != nullptr && counted->missed;
  // Silence and implausible readings have already lasted long enough when they are noticed.
  meter.trust.step(now, faulted || silent || implausible, missed, heard, silent || implausible ? Duration{} : patience);
  if (faulted || silent || implausible) meter.disagrees = implausible && !faulted && !silent && !meter.stuck;
  if (faulted || meter.bypassed) return;  // the device or its bus has its own alarm
  if (!silent && !implausible) {
    if (meter.trust.lost()) alarms_.push_back(alarm_of_doubted(meter.name, meter.trust));
    return;
  }
  std::string text;
  if (silent && meter.was_garbled && now - meter.garbled < kSilentAfter) {
    text = fmt::format(
        "luxmeter \"{}\" sends no usable number; check its registers and word order in the rig file, or exchange it",
        meter.name);
  } else if (silent) {
    text = fmt::format("luxmeter \"{}\" is not heard; check its power, its cable and its address", meter.name);
  } else {
    text = fmt::format(
        "luxmeter \"{}\" cannot be believed ({}); check that nothing covers it and that it stands where the rig file "
        "says; if it is right as it is, apply the plan again to measure afresh",
        meter.name, meter.implausible);
  }
  alarms_.push_back({true, meter.name, std::move(text), silent ? meter.trust.lost_since() : meter.implausible_since});
}

Alarm HealthWatch::alarm_of_doubted(const std::string& device, const Trust& trust) {
  return {true, device,
          fmt::format("\"{}\" answers again, but has failed {} times in ten minutes: it is done without until it has "
                      "answered well for {:g} s; check its cable, its power and what else is on its line",
                      device, trust.falls(), to_seconds(trust.row())),
          trust.lost_since()};
}

void HealthWatch::set_bypassed(const std::vector<std::optional<Time>>& lamps,
                               const std::vector<std::optional<Time>>& meters) {
  for (std::size_t f = 0; f < lamps.size(); ++f) lamp_bypassed_[f] = lamps[f].has_value();
  for (std::size_t i = 0; i < meters.size(); ++i) meters_[i].bypassed = meters[i].has_value();
}

/// Every fixture of the bus is bypassed.
bool HealthWatch::all_bypassed_on(std::size_t bus) const {
  for (std::size_t f = 0; f < lamp_bypassed_.size(); ++f)
    if ((bus_of_fixture_[f] == bus || motion_bus_of_fixture_[f] == bus) && !lamp_bypassed_[f]) return false;
  return true;
}

/// Updates which devices are lost, from present and earlier reports.
void HealthWatch::step_trusts(Time now, const Patience& patience) {
  look_up();
  for (auto& entry : counted_) {
    entry.second.missed = entry.second.faulted = false;
    entry.second.answered = true;
  }
  for (std::size_t k = 0; k < report_.size(); ++k) {
    const Health& health = report_[k];
    Counted& device = *counted_of_report_[k];
    const Role role = device.known.role;
    const bool single = role == Role::fixture || role == Role::axis || role == Role::luxmeter;
    device.faulted = health.life == Life::faulted;
    device.missed = single && health.errors > device.errors;  // a bus counts the errors of all its devices
    device.answered = !single || health.received == 0 || health.received > device.received;
    device.errors = health.errors;
    device.received = health.received;
  }
  for (auto entry = counted_.begin(); entry != counted_.end();) {
    Counted& device = entry->second;
    const Role role = device.known.role;
    if (role == Role::luxmeter) {  // step_meter does this
      ++entry;
      continue;
    }
    const bool turns = role == Role::axis || role == Role::axes_bus;
    device.trust.step(now, device.faulted, device.missed, device.answered, turns ? Duration{} : patience.lamps);
    const bool forgotten = (role == Role::unknown || role == Role::bus_part) && !device.faulted && !device.trust.lost();
    if (forgotten) looked_up_ = false;
    entry = forgotten ? counted_.erase(entry) : std::next(entry);
  }
}

bool HealthWatch::any_faulted() const {
  return std::any_of(report_.begin(), report_.end(), [](const Health& health) { return health.life == Life::faulted; });
}

void HealthWatch::step(Time now, const Patience& patience) {
  if (!started_) {
    started_ = true;
    for (Meter& meter : meters_) meter.heard = std::max(meter.heard, now);
    stepped_ = now;
  }
  const Duration late = std::max(Duration{}, now - stepped_ - kLongestStep);
  stepped_ = now;
  for (Meter& meter : meters_) meter.unseen = meter.heard == meter.heard_before ? meter.unseen + late : Duration{};
  std::vector<Alarm> before = std::exchange(alarms_, {});
  light_lost_ = false;
  all_lost_ = false;
  lamp_lost_.assign(bus_of_fixture_.size(), false);
  lamp_silent_.assign(bus_of_fixture_.size(), false);
  lamp_failing_.assign(bus_of_fixture_.size(), false);
  motion_lost_.assign(bus_of_fixture_.size(), false);
  step_trusts(now, patience);
  std::vector<bool> meter_faulted(meters_.size(), false);
  std::vector<bool> bus_faulted(fixtures_on_bus_.size(), false), bus_lost(fixtures_on_bus_.size(), false);
  std::vector<bool> bus_silent(fixtures_on_bus_.size(), false);
  for (const Health& health : report_) {
    if (health.life == Life::active && !health.detail.empty()) warn_of(health);
    if (health.life != Life::faulted) continue;
    const Known device = known(health.device);
    if (device.role == Role::luxmeter) meter_faulted[device.index] = true;
    alarms_.push_back(alarm_of(health, device));
  }
  for (const auto& entry : counted_) {
    const std::string& name = entry.first;
    const Counted& device = entry.second;
    const auto [role, index] = device.known;
    if (role == Role::luxmeter) continue;
    const bool bus = role == Role::light_bus || role == Role::axes_bus || role == Role::meter_bus;
    if (bus) bus_faulted[index] = device.faulted;
    if ((bus || role == Role::bus_part) && device.faulted) bus_silent[index] = true;
    if (role == Role::fixture) lamp_silent_[index] = device.faulted;
    if (!device.trust.lost()) continue;
    // It is not known which fixtures hang on a part of a bus, so it counts as the bus.
    if (bus || role == Role::bus_part) bus_lost[index] = true;
    const bool of_one = role == Role::fixture || role == Role::axis;
    const bool of_bus = role == Role::light_bus || role == Role::axes_bus || role == Role::bus_part;
    if (of_one ? !lamp_bypassed_[index] : of_bus ? !all_bypassed_on(index) : role == Role::unknown) light_lost_ = true;
    if (role == Role::unknown) all_lost_ = true;
    if (role == Role::fixture) lamp_lost_[index] = true;
    if (role == Role::axis) motion_lost_[index] = true;
    if (!device.faulted) alarms_.push_back(alarm_of_doubted(name, device.trust));
  }
  for (std::size_t f = 0; f < bus_of_fixture_.size(); ++f) {
    const auto among = [](const std::vector<bool>& buses, std::size_t bus) { return bus < buses.size() && buses[bus]; };
    if (among(bus_lost, bus_of_fixture_[f])) lamp_lost_[f] = true;
    if (lamp_lost_[f] || among(bus_silent, bus_of_fixture_[f])) lamp_silent_[f] = true;
    if (among(bus_lost, motion_bus_of_fixture_[f])) motion_lost_[f] = true;
  }
  std::size_t in_use = 0, in_use_lost = 0;
  for (std::size_t f = 0; f < lamp_lost_.size(); ++f) {
    in_use += !lamp_bypassed_[f];
    in_use_lost += !lamp_bypassed_[f] && lamp_lost_[f];
  }
  if (in_use > 0 && in_use == in_use_lost) all_lost_ = true;
  // Devices on a dead bus are lost with it; one alarm is enough.
  std::erase_if(alarms_, [&](const Alarm& alarm) {
    const auto [role, index] = known(alarm.device);
    if (role == Role::bus_part) return bool{bus_faulted[index]};
    if (role != Role::luxmeter && role != Role::fixture && role != Role::axis) return false;
    if (role == Role::luxmeter ? meters_[index].bypassed : lamp_bypassed_[index]) return true;
    const std::size_t bus = role == Role::luxmeter ? meters_[index].bus
                            : role == Role::axis   ? motion_bus_of_fixture_[index]
                                                   : bus_of_fixture_[index];
    return bus < bus_faulted.size() && (bus_faulted[bus] || bus_lost[bus]);
  });
  join_units();
  for (std::size_t i = 0; i < meters_.size(); ++i) {
    const bool bus = meters_[i].bus < bus_faulted.size() && bus_faulted[meters_[i].bus];
    step_meter(now, i, meter_faulted[i] || bus, patience.meters);
  }
  const auto equal = [](const Alarm& a, const Alarm& b) {
    return a.severe == b.severe && a.since == b.since && a.device == b.device && a.text == b.text;
  };
  if (std::equal(alarms_.begin(), alarms_.end(), worked_out_.begin(), worked_out_.end(), equal)) {
    alarms_ = std::move(before);
    return;
  }
  worked_out_ = alarms_;
  for (Alarm& alarm : alarms_) {
    const auto said =
        std::find_if(before.begin(), before.end(), [&](const Alarm& b) { return is_same_alarm(alarm, b); });
    if (said != before.end()) alarm.text = said->text;
  }
}

}  // namespace luxrig
