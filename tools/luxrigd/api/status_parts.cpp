#include "tools/luxrigd/api/status_parts.h"

#include <algorithm>
#include <cmath>

#include "tools/luxrig/addresses.h"
#include "tools/luxrig/uniformity_json.h"
#include "tools/luxrig/vector_json.h"
#include "tools/luxrigd/api/question_json.h"

namespace luxrig {
namespace {

using nlohmann::json;

/// Sets a number; leaves the key out if it is not finite.
void set(json& object, const char* key, double value) {
  if (std::isfinite(value)) object[key] = value;
}

/// Life of a meter: its own health line, else that of its bus.
std::string meter_life(const Rig& rig, const Luxmeter& meter, const std::vector<Health>& devices) {
  std::string life = name_of(Life::configured);
  for (const Health& device : devices) {
    if (device.device == rig.buses[meter.bus].name) life = name_of(device.life);
  }
  for (const Health& device : devices) {
    if (device.device == meter.name) life = name_of(device.life);
  }
  return life;
}

}  // namespace

json fixed_of(const Rig& rig, const Fixture& fixture) {
  json out = {{"name", fixture.name},
              {"bus", rig.buses[fixture.bus].name},
              {"address", fixture_address(rig, fixture)},
              {"luminaire", rig.luminaires[fixture.luminaire].name},
              {"position", array_of(fixture.world_from_mount.translation_m)}};
  if (fixture.moves) out["moves"] = true;
  return out;
}

json fixed_of(const Rig&, const Point& point) {
  json out = {
      {"name", point.name}, {"position", array_of(point.position_world_m)}, {"normal", array_of(point.normal_world)}};
  if (point.max_lx) out["max_lux"] = *point.max_lx;
  if (point.goal_tolerance) out["goal_tolerance"] = *point.goal_tolerance;
  return out;
}

json fixed_of(const Rig& rig, const Luxmeter& meter) {
  json out = {{"name", meter.name},
              {"bus", rig.buses[meter.bus].name},
              {"address", meter_address(meter)},
              {"position", array_of(meter.position_world_m)},
              {"tolerance", meter.tolerance}};
  if (meter.point) out["point"] = rig.points[*meter.point].name;
  return out;
}

void StatusParts::put_time(json& object, const char* age_key, const char* instant_key, Time at) const {
  if (times_ == Times::ages)
    set(object, age_key, to_seconds(input_.now - at));
  else
    set(object, instant_key, to_seconds(at - input_.started));
}

json StatusParts::fixture(std::size_t index) const {
  const Fixture& fixture = input_.rig.fixtures[index];
  const FixtureStatus& status = input_.show.fixtures[index];
  json out = {{"pan_deg", deg_from_rad(status.joints.pan_rad)}, {"tilt_deg", deg_from_rad(status.joints.tilt_rad)}};
  if (status.aim_world_m) out["aim"] = array_of(*status.aim_world_m);
  set(out, "level", status.level);
  set(out, "drive", status.drive);
  set(out, "target_level", status.target_level);
  if (!status.level_known) out["level_known"] = false;
  if (fixture.range.zooms()) out["beam_angle_deg"] = deg_from_rad(status.joints.beam_rad);
  if (status.identified) out["identified"] = true;
  if (status.aimed_by_hand) out["aimed_by_hand"] = true;
  if (status.parked) out["parked"] = true;
  if (status.dipped) out["dipped"] = true;
  if (status.kept_dark) out["kept_dark"] = true;
  if (!status.waits_for.empty()) out["waits_for"] = status.waits_for;
  set(out, "gain", status.gain);
  set(out, "gain_standard_error", status.gain_standard_error);
  return out;
}

json StatusParts::point(std::size_t index) const {
  const PointStatus& status = input_.show.points[index];
  json out = {{"met", status.met()}, {"why", status.why}};
  put_verdicts(out, status);
  if (status.goal_lx) out["goal_lux"] = *status.goal_lx;
  set(out, "predicted_lux", status.predicted_lx);
  set(out, "standard_error_lux", status.standard_error_lx);
  if (status.measured_lx) {
    set(out, "measured_lux", *status.measured_lx);
    put_time(out, "measured_age_s", "measured_at_s", status.measured_at);
  }
  if (status.goal_lx && *status.goal_lx > 0)
    set(out, "error", status.measured_lx.value_or(status.predicted_lx) / *status.goal_lx - 1);
  return out;
}

json StatusParts::luxmeter(std::size_t index) const {
  const ShowStatus& show = input_.show;
  json out = {{"life", meter_life(input_.rig, input_.rig.luxmeters[index], input_.devices)}};
  if (index < show.luxmeters.size() && show.luxmeters[index]) {
    set(out, "lux", show.luxmeters[index]->lux);
    put_time(out, "age_s", "at_s", show.luxmeters[index]->taken);
  }
  if (index < show.shown.size() && show.shown[index]) {
    set(out, "shown_lux", show.shown[index]->lux);
    put_time(out, "shown_age_s", "shown_at_s", show.shown[index]->taken);
  }
  return out;
}

json StatusParts::device(std::size_t index) const {
  const Health& health = input_.devices[index];
  json out = {{"name", health.device}, {"life", name_of(health.life)}, {"detail", health.detail},
              {"sent", health.sent},   {"received", health.received},  {"errors", health.errors}};
  if (health.since != Time{}) put_time(out, "since_s", "since_at_s", health.since);
  if (health.last_ok != Time{}) put_time(out, "last_ok_s", "last_ok_at_s", health.last_ok);
  for (const Bus& bus : input_.rig.buses) {
    if (bus.name != health.device) continue;
    out["driver"] = bus.driver;
    if (const std::string where = bus_address(bus); !where.empty()) out["address"] = where;
  }
  return out;
}

json StatusParts::asked(const AskedQuestion& question) const {
  json out = to_json(question.question);
  if (times_ == Times::ages)
    set(out, "remaining_s", std::max(0.0, to_seconds(question.until - input_.now)));
  else
    put_time(out, "", "until_at_s", question.until);
  if (question.answer) out["answer"] = to_json(*question.answer);
  return out;
}

json StatusParts::alarms() const {
  json out = json::array();
  for (const Alarm& alarm : input_.show.alarms) {
    out.push_back({{"severe", alarm.severe}, {"device", alarm.device}, {"text", alarm.text}});
    put_time(out.back(), "since_s", "since_at_s", alarm.since);
  }
  return out;
}

json StatusParts::overrides() const {
  const Rig& rig = input_.rig;
  json out = json::array();
  for (const ByHand& held : input_.show.by_hand) {
    const bool level = held.what == ByHand::What::level;
    json entry = {{"kind", level ? "level" : "goal"},
                  {"name", level ? rig.fixtures[held.index].name : rig.points[held.index].name},
                  {level ? "level" : "goal_lux", held.value}};
    put_time(entry, "age_s", "at_s", held.since);
    if (held.until && times_ == Times::ages)
      set(entry, "remaining_s", std::max(0.0, to_seconds(*held.until - input_.now)));
    else if (held.until)
      put_time(entry, "", "until_at_s", *held.until);
    if (held.of_plan) entry["of_plan"] = true;
    if (!held.why.empty()) entry["why"] = held.why;
    out.push_back(std::move(entry));
  }
  return out;
}

json StatusParts::bypassed() const {
  const Rig& rig = input_.rig;
  json out = json::array();
  for (const Bypassed& one : input_.show.bypassed) {
    out.push_back({{"kind", one.luxmeter ? "luxmeter" : "fixture"},
                   {"name", one.luxmeter ? rig.luxmeters[one.index].name : rig.fixtures[one.index].name},
                   {"risk", one.risk}});
    put_time(out.back(), "age_s", "at_s", one.since);
  }
  return out;
}

json StatusParts::desks() const {
  json out = json::array();
  for (const DeskStatus& desk : input_.show.desks) {
    out.push_back({{"name", desk.name},
                   {"mode", name_of(desk.mode)},
                   {"phase", name_of(desk.phase)},
                   {"source", desk.source},
                   {"heard", desk.heard},
                   {"silent", desk.silent}});
    put_time(out.back(), "since_s", "since_at_s", desk.since);
  }
  return out;
}

json StatusParts::rest() const {
  const Rig& rig = input_.rig;
  const ShowStatus& show = input_.show;
  json out = {{"rig", rig.name},
              {"version", LUXRIG_VERSION},
              {"phase", name_of(show.phase)},
              {"detail", show.detail},
              {"simulated", input_.simulated},
              {"blackout", show.blackout},
              {"plan_waits", show.plan_waits},
              {"round", show.round},
              {"rounds", rig.control.rounds},
              {"converged", show.converged}};
  put_time(out, "phase_s", "phase_at_s", show.phase_since);
  if (show.may_be_measured) out["may_be_measured"] = true;
  if (input_.sim_control) out["sim_control"] = {{"host", input_.sim_control->host}, {"port", input_.sim_control->port}};
  if (!rig.calibrated.empty()) out["calibrated"] = rig.calibrated;
  if (input_.question) out["question"] = asked(*input_.question);
  put_counts(out, show, rig.control.goal_tolerance);
  std::vector<LuxEstimate> light;
  for (const PointStatus& point : show.points) light.push_back(point.light);
  if (light.size() == rig.points.size())
    if (const auto even = uniformities(rig, light); !even.empty()) out["uniformities"] = uniformities_json(even);
  out["alarms"] = alarms();
  out["overrides"] = overrides();
  out["bypassed"] = bypassed();
  out["desks"] = desks();
  out["output"] = {{"rate_hz", input_.output.rate_hz}, {"frames", input_.output.frames},
                   {"p50_us", input_.output.p50_us},   {"p99_us", input_.output.p99_us},
                   {"max_us", input_.output.max_us},   {"realtime", input_.output.realtime}};
  return out;
}

}  // namespace luxrig
