#include "core/plan/plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace luxrig {
namespace {

using OrderedJson = nlohmann::ordered_json;

void put(OrderedJson& object, const char* key, double value) {
  if (std::isfinite(value)) object[key] = value;
}

void put(OrderedJson& object, const char* key, const std::optional<double>& value) {
  if (value) put(object, key, *value);
}

void put(OrderedJson& object, const char* key, const Vec3& value) {
  if (value.allFinite()) object[key] = {value.x(), value.y(), value.z()};
}

void put(OrderedJson& object, const char* key, const std::optional<Chromaticity>& xy) {
  if (xy && xy->allFinite()) object[key] = {xy->x(), xy->y()};
}

/// In twelve digits: the same again when it is read and written.
double written_deg(double rad) {
  const double deg = deg_from_rad(rad);
  if (std::abs(deg) < 1e-12) return 0;
  return std::isfinite(deg) ? std::stod(fmt::format("{:.12g}", deg)) : deg;
}

OrderedJson json_of(const PlannedLight& light) {
  OrderedJson json = {{"name", light.name}, {"luminaire", light.luminaire}};
  put(json, "position", light.position_world_m);
  if (light.aim_world_m) put(json, "aim", *light.aim_world_m);
  if (light.joints) {
    put(json, "pan_deg", written_deg(light.joints->pan_rad));
    put(json, "tilt_deg", written_deg(light.joints->tilt_rad));
    if (light.joints->beam_rad != 0) put(json, "beam_angle_deg", written_deg(light.joints->beam_rad));
  }
  put(json, "level", light.level);
  put(json, "solved_level", light.solved_level);
  put(json, "lumens", light.lumens);
  put(json, "watts", light.watts);
  return json;
}

OrderedJson json_of(const PlannedPower& power) {
  OrderedJson json = OrderedJson::object();
  put(json, "max_watts", power.max_watts);
  put(json, "watts", power.watts);
  put(json, "normalised_error", power.normalised_error);
  return json;
}

OrderedJson json_of(const PlannedTask& task) {
  OrderedJson json = {{"name", task.name}, {"kind", task.kind}};
  put(json, "normalised_error", task.normalised_error);
  put(json, "lower_bound", task.lower_bound);
  put(json, "lower_bound_of_number", task.lower_bound_of_number);
  if (!task.switches_proven) json["switches_proven"] = false;
  if (task.relief) {
    put(json, "coverage", task.relief->coverage);
    put(json, "local_contrast", task.relief->local_contrast_lx);
    put(json, "relative_contrast", task.relief->relative_contrast);
    put(json, "before_coverage", task.relief->before_coverage);
    put(json, "before_relative_contrast", task.relief->before_relative_contrast);
    put(json, "before_local_contrast", task.relief->before_local_contrast_lx);
    put(json, "object_lux", task.relief->object_lux);
    put(json, "key_to_fill", task.relief->key_to_fill);
    put(json, "seen", task.relief->seen);
    put(json, "before_seen", task.relief->before_seen);
    put(json, "lit_share", task.relief->lit_share);
    put(json, "clipped_share", task.relief->clipped_share);
  }
  json["iterations"] = task.iterations;
  put(json, "seconds", task.seconds);
  put(json, "watts", task.watts);
  json["lights"] = OrderedJson::array();
  for (const PlannedLight& light : task.lights) json["lights"].push_back(json_of(light));
  for (const PlannedLight& light : task.fixtures) json["fixtures"].push_back(json_of(light));
  for (const PlannedNumber& number : task.numbers) {
    OrderedJson tried = {{"lights", number.lights}};
    put(tried, "normalised_error", number.normalised_error);
    put(tried, "local_contrast", number.local_contrast_lx);
    put(tried, "relative_contrast", number.relative_contrast);
    json["numbers"].push_back(std::move(tried));
  }
  for (const PlannedDirection& direction : task.directions) {
    OrderedJson held;
    put(held, "direction", direction.towards_world);
    put(held, "azimuth_deg", written_deg(direction.azimuth_rad));
    put(held, "elevation_deg", written_deg(direction.elevation_rad));
    put(held, "position", direction.position_world_m);
    json["directions"].push_back(std::move(held));
  }
  for (const PlannedPower& power : task.front) json["front"].push_back(json_of(power));
  return json;
}

OrderedJson json_of(const PlannedPoint& point) {
  OrderedJson json = {{"name", point.name}};
  put(json, "position", point.position_world_m);
  put(json, "normal", point.normal_world);
  put(json, "lux", point.lux);
  put(json, "direct_lux", point.direct_lux);
  put(json, "standard_error_lux", point.standard_error_lux);
  put(json, "opening_lux", point.opening_lux);
  put(json, "daylight_lux", point.daylight_lux);
  put(json, "goal_lux", point.goal_lux);
  put(json, "xy", point.xy);
  put(json, "goal_xy", point.goal_xy);
  put(json, "weight", point.weight);
  put(json, "max_lux", point.max_lux);
  put(json, "goal_tolerance", point.goal_tolerance);
  if (!point.why.empty()) json["why"] = point.why;
  if (point.verdict) {
    json["verdict"] = name_of(*point.verdict);
    json["met"] = *point.verdict == Verdict::met;
    if (!point.reason.empty()) json["reason"] = point.reason;
  }
  return json;
}

OrderedJson json_of(const PlannedLimit& limit) {
  OrderedJson json = {{"point", limit.point}};
  put(json, "max_lux", limit.max_lux);
  put(json, "lux", limit.lux);
  json["met"] = limit.met;
  return json;
}

}  // namespace

std::string what_differs(const RigVersion& one, const RigVersion& other) {
  std::vector<const char*> parts;
  if (one.goals != other.goals) parts.push_back("goals");
  if (one.limits != other.limits) parts.push_back("limits");
  if (one.light != other.light) parts.push_back("scene, photometry or places");
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string to_json(const Plan& plan) {
  OrderedJson json = {{"luxrig_plan", 1}, {"rig", plan.rig}};
  if (plan.made_for)
    json["made_for"] = {{"goals", fmt::format("{:016x}", plan.made_for->goals)},
                        {"limits", fmt::format("{:016x}", plan.made_for->limits)},
                        {"light", fmt::format("{:016x}", plan.made_for->light)}};
  for (const char* key : {"tasks", "points", "limits"}) json[key] = OrderedJson::array();
  for (const PlannedTask& task : plan.tasks) json["tasks"].push_back(json_of(task));
  for (const PlannedPoint& point : plan.points) json["points"].push_back(json_of(point));
  for (const PlannedLimit& limit : plan.limits) json["limits"].push_back(json_of(limit));
  put(json, "seconds", plan.seconds);
  json["seed"] = plan.seed;
  // Names come from files. One that is not UTF-8 must not make the writer throw.
  return json.dump(1, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

}  // namespace luxrig
