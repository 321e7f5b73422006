#include "tools/luxrigd/api/status_json.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/luxrig/addresses.h"
#include "tools/luxrig/vector_json.h"
#include "tools/luxrigd/api/question_json.h"

namespace luxrig {

void put_verdicts(nlohmann::json& out, const PointStatus& status) {
  if (std::isfinite(status.light.lux) && std::isfinite(status.light.half_width_lx)) {
    out["lux"] = status.light.lux;
    out["uncertainty_lux"] = status.light.half_width_lx;
  }
  if (status.verdict) {
    out["verdict"] = name_of(*status.verdict);
    out["reason"] = status.reason;
  }
  if (status.limit) {
    out["limit"] = name_of(*status.limit);
    out["limit_reason"] = status.limit_reason;
  }
}

void put_counts(nlohmann::json& out, const ShowStatus& show, double goal_tolerance) {
  out["goals"] = {{"met", show.goals.met},
                  {"missed", show.goals.missed},
                  {"unknown", show.goals.unknown},
                  {"tolerance", goal_tolerance}};
  out["limits"] = {{"kept", show.limits_kept}, {"exceeded", show.limits_exceeded}, {"unknown", show.limits_unknown}};
}

namespace {

using nlohmann::json;

/// Sets a number; leaves the key out if it is not finite.
void set(json& object, const char* key, double value) {
  if (std::isfinite(value)) object[key] = value;
}

json fixture_json(const Rig& rig, std::size_t index, const FixtureStatus& status) {
  const Fixture& fixture = rig.fixtures[index];
  json out = {{"name", fixture.name},
              {"bus", rig.buses[fixture.bus].name},
              {"address", fixture_address(rig, fixture)},
              {"luminaire", rig.luminaires[fixture.luminaire].name},
              {"position", array_of(fixture.world_from_mount.translation_m)},
              {"pan_deg", deg_from_rad(status.joints.pan_rad)},
              {"tilt_deg", deg_from_rad(status.joints.tilt_rad)}};
  if (status.aim_world_m) out["aim"] = array_of(*status.aim_world_m);
  set(out, "level", status.level);
  set(out, "drive", status.drive);
  set(out, "target_level", status.target_level);
  if (!status.level_known) out["level_known"] = false;
  if (fixture.moves) out["moves"] = true;
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

json point_json(const Point& point, const PointStatus& status, Time now) {
  json out = {{"name", point.name},
              {"position", array_of(point.position_world_m)},
              {"normal", array_of(point.normal_world)},
              {"met", status.met()},
              {"why", status.why}};
  put_verdicts(out, status);
  if (status.goal_lx) out["goal_lux"] = *status.goal_lx;
  if (point.max_lx) out["max_lux"] = *point.max_lx;
  if (point.goal_tolerance) out["goal_tolerance"] = *point.goal_tolerance;
  set(out, "predicted_lux", status.predicted_lx);
  set(out, "standard_error_lux", status.standard_error_lx);
  if (status.measured_lx) {
    set(out, "measured_lux", *status.measured_lx);
    set(out, "measured_age_s", to_seconds(now - status.measured_at));
  }
  if (status.goal_lx && *status.goal_lx > 0) {
    set(out, "error", status.measured_lx.value_or(status.predicted_lx) / *status.goal_lx - 1);
  }
  return out;
}

json asked_json(const AskedQuestion& asked, Time now) {
  json out = to_json(asked.question);
  set(out, "remaining_s", std::max(0.0, to_seconds(asked.until - now)));
  if (asked.answer) out["answer"] = to_json(*asked.answer);
  return out;
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

json health_json(const Health& health, Time now) {
  json out = {{"name", health.device}, {"life", name_of(health.life)}, {"detail", health.detail},
              {"sent", health.sent},   {"received", health.received},  {"errors", health.errors}};
  if (health.since != Time{}) set(out, "since_s", to_seconds(now - health.since));
  if (health.last_ok != Time{}) set(out, "last_ok_s", to_seconds(now - health.last_ok));
  return out;
}

}  // namespace

std::string status_json(const StatusInput& input) {
  const Rig& rig = input.rig;
  const ShowStatus& show = input.show;
  json out = {{"rig", rig.name},
              {"version", LUXRIG_VERSION},
              {"phase", name_of(show.phase)},
              {"detail", show.detail},
              {"time_s", to_seconds(input.now - input.started)},
              {"phase_s", to_seconds(input.now - show.phase_since)},
              {"simulated", input.simulated},
              {"blackout", show.blackout},
              {"plan_waits", show.plan_waits},
              {"round", show.round},
              {"rounds", rig.control.rounds},
              {"converged", show.converged}};
  if (show.may_be_measured) out["may_be_measured"] = true;
  if (input.sim_control) out["sim_control"] = {{"host", input.sim_control->host}, {"port", input.sim_control->port}};
  if (!rig.calibrated.empty()) out["calibrated"] = rig.calibrated;
  if (input.question) out["question"] = asked_json(*input.question, input.now);
  put_counts(out, show, rig.control.goal_tolerance);
  json& fixtures = out["fixtures"] = json::array();
  for (std::size_t i = 0; i < show.fixtures.size(); ++i) fixtures.push_back(fixture_json(rig, i, show.fixtures[i]));
  json& points = out["points"] = json::array();
  for (std::size_t i = 0; i < show.points.size(); ++i) {
    points.push_back(point_json(rig.points[i], show.points[i], input.now));
  }
  json& meters = out["luxmeters"] = json::array();
  for (std::size_t m = 0; m < rig.luxmeters.size(); ++m) {
    const Luxmeter& meter = rig.luxmeters[m];
    json entry = {{"name", meter.name},
                  {"bus", rig.buses[meter.bus].name},
                  {"address", meter_address(meter)},
                  {"position", array_of(meter.position_world_m)},
                  {"tolerance", meter.tolerance},
                  {"life", meter_life(rig, meter, input.devices)}};
    if (meter.point) entry["point"] = rig.points[*meter.point].name;
    if (m < show.luxmeters.size() && show.luxmeters[m]) {
      set(entry, "lux", show.luxmeters[m]->lux);
      set(entry, "age_s", to_seconds(input.now - show.luxmeters[m]->taken));
    }
    if (m < show.shown.size() && show.shown[m]) {
      set(entry, "shown_lux", show.shown[m]->lux);
      set(entry, "shown_age_s", to_seconds(input.now - show.shown[m]->taken));
    }
    meters.push_back(std::move(entry));
  }
  json& devices = out["devices"] = json::array();
  for (const Health& device : input.devices) {
    json entry = health_json(device, input.now);
    for (const Bus& bus : rig.buses) {
      if (bus.name != device.device) continue;
      entry["driver"] = bus.driver;
      if (const std::string where = bus_address(bus); !where.empty()) entry["address"] = where;
    }
    devices.push_back(std::move(entry));
  }
  json& alarms = out["alarms"] = json::array();
  for (const Alarm& alarm : show.alarms) {
    alarms.push_back({{"severe", alarm.severe},
                      {"device", alarm.device},
                      {"text", alarm.text},
                      {"since_s", to_seconds(input.now - alarm.since)}});
  }
  json& by_hand = out["overrides"] = json::array();
  for (const ByHand& held : show.by_hand) {
    const bool level = held.what == ByHand::What::level;
    json entry = {{"kind", level ? "level" : "goal"},
                  {"name", level ? rig.fixtures[held.index].name : rig.points[held.index].name},
                  {level ? "level" : "goal_lux", held.value},
                  {"age_s", to_seconds(input.now - held.since)}};
    if (held.until) set(entry, "remaining_s", std::max(0.0, to_seconds(*held.until - input.now)));
    if (held.of_plan) entry["of_plan"] = true;
    if (!held.why.empty()) entry["why"] = held.why;
    by_hand.push_back(std::move(entry));
  }
  json& bypassed = out["bypassed"] = json::array();
  for (const Bypassed& one : show.bypassed)
    bypassed.push_back({{"kind", one.luxmeter ? "luxmeter" : "fixture"},
                        {"name", one.luxmeter ? rig.luxmeters[one.index].name : rig.fixtures[one.index].name},
                        {"age_s", to_seconds(input.now - one.since)},
                        {"risk", one.risk}});
  json& desks = out["desks"] = json::array();
  for (const DeskStatus& desk : show.desks) {
    desks.push_back({{"name", desk.name},
                     {"mode", name_of(desk.mode)},
                     {"phase", name_of(desk.phase)},
                     {"since_s", to_seconds(input.now - desk.since)},
                     {"source", desk.source},
                     {"heard", desk.heard},
                     {"silent", desk.silent}});
  }
  out["output"] = {{"rate_hz", input.output.rate_hz}, {"frames", input.output.frames},
                   {"p50_us", input.output.p50_us},   {"p99_us", input.output.p99_us},
                   {"max_us", input.output.max_us},   {"realtime", input.output.realtime}};
  // Names come from files: invalid UTF-8 is replaced and never throws.
  return out.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace luxrig
