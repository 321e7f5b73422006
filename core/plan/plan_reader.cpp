/// plan_from_json(): reads a plan that a person may have edited, with the place of every mistake.

#include "core/plan/plan.h"
#include "core/text/json_reader.h"

namespace luxrig {
namespace {

using Json = nlohmann::json;

constexpr double kAbsent = JsonReader::kAbsent;

PlannedLight light_of(const JsonReader& reader, const Json& json, const std::string& path) {
  PlannedLight light;
  light.name = reader.text(json, path, "name", true);
  light.luminaire = reader.text(json, path, "luminaire", false);
  light.position_world_m = reader.vector(json, path, "position").value_or(Vec3::Constant(kAbsent));
  light.aim_world_m = reader.vector(json, path, "aim");
  const auto pan_deg = reader.optional_number(json, path, "pan_deg");
  const auto tilt_deg = reader.optional_number(json, path, "tilt_deg");
  const auto beam_deg = reader.optional_number(json, path, "beam_angle_deg");
  if (pan_deg && tilt_deg)
    light.joints = Joints{rad_from_deg(*pan_deg), rad_from_deg(*tilt_deg), rad_from_deg(beam_deg.value_or(0))};
  light.level = reader.number(json, path, "level", true);
  light.solved_level = reader.optional_number(json, path, "solved_level");
  light.lumens = reader.number(json, path, "lumens", false);
  light.watts = reader.optional_number(json, path, "watts");
  return light;
}

PlannedTask task_of(const JsonReader& reader, const Json& json, const std::string& path) {
  PlannedTask task;
  task.name = reader.text(json, path, "name", true);
  task.kind = reader.text(json, path, "kind", false);
  task.normalised_error = reader.number(json, path, "normalised_error", false);
  task.lower_bound = reader.optional_number(json, path, "lower_bound");
  reader.read_yes_no(json, path, "switches_proven", task.switches_proven);
  task.lower_bound_of_number = reader.optional_number(json, path, "lower_bound_of_number");
  if (const auto contrast_lx = reader.optional_number(json, path, "local_contrast")) {
    PlannedRelief relief;
    relief.local_contrast_lx = *contrast_lx;
    relief.coverage = reader.number(json, path, "coverage", false);
    relief.relative_contrast = reader.number(json, path, "relative_contrast", false);
    relief.before_relative_contrast = reader.optional_number(json, path, "before_relative_contrast");
    relief.before_local_contrast_lx = reader.optional_number(json, path, "before_local_contrast");
    relief.before_coverage = reader.optional_number(json, path, "before_coverage");
    relief.object_lux = reader.number(json, path, "object_lux", false);
    relief.key_to_fill = reader.optional_number(json, path, "key_to_fill");
    relief.seen = reader.optional_number(json, path, "seen");
    relief.before_seen = reader.optional_number(json, path, "before_seen");
    relief.lit_share = reader.optional_number(json, path, "lit_share");
    relief.clipped_share = reader.optional_number(json, path, "clipped_share");
    task.relief = relief;
  }
  task.iterations = reader.count<int>(json, path, "iterations");
  task.seconds = reader.number(json, path, "seconds", false);
  reader.each(json, path, "lights", true, [&](const Json& light, const std::string& light_path) {
    task.lights.push_back(light_of(reader, light, light_path));
  });
  reader.each(json, path, "fixtures", false, [&](const Json& light, const std::string& light_path) {
    task.fixtures.push_back(light_of(reader, light, light_path));
  });
  reader.each(json, path, "numbers", false, [&](const Json& number, const std::string& number_path) {
    task.numbers.push_back({reader.count<int>(number, number_path, "lights"),
                            reader.number(number, number_path, "normalised_error", false),
                            reader.optional_number(number, number_path, "local_contrast"),
                            reader.optional_number(number, number_path, "relative_contrast")});
  });
  reader.each(json, path, "directions", false, [&](const Json& held, const std::string& held_path) {
    task.directions.push_back({reader.vector(held, held_path, "direction").value_or(Vec3::Constant(kAbsent)),
                               rad_from_deg(reader.number(held, held_path, "azimuth_deg", false)),
                               rad_from_deg(reader.number(held, held_path, "elevation_deg", false)),
                               reader.vector(held, held_path, "position").value_or(Vec3::Constant(kAbsent))});
  });
  task.watts = reader.optional_number(json, path, "watts");
  reader.each(json, path, "front", false, [&](const Json& power, const std::string& power_path) {
    task.front.push_back({reader.number(power, power_path, "max_watts", false),
                          reader.number(power, power_path, "watts", false),
                          reader.number(power, power_path, "normalised_error", false)});
  });
  return task;
}

PlannedPoint point_of(const JsonReader& reader, const Json& json, const std::string& path) {
  PlannedPoint point;
  point.name = reader.text(json, path, "name", true);
  point.position_world_m = reader.vector(json, path, "position").value_or(Vec3::Constant(kAbsent));
  point.normal_world = reader.vector(json, path, "normal").value_or(Vec3::Constant(kAbsent));
  point.lux = reader.number(json, path, "lux", false);
  point.direct_lux = reader.number(json, path, "direct_lux", false);
  point.standard_error_lux = reader.number(json, path, "standard_error_lux", false);
  point.opening_lux = reader.optional_number(json, path, "opening_lux");
  point.daylight_lux = reader.optional_number(json, path, "daylight_lux");
  point.goal_lux = reader.optional_number(json, path, "goal_lux");
  point.xy = reader.pair(json, path, "xy");
  point.goal_xy = reader.pair(json, path, "goal_xy");
  point.weight = reader.optional_number(json, path, "weight");
  point.max_lux = reader.optional_number(json, path, "max_lux");
  point.goal_tolerance = reader.optional_number(json, path, "goal_tolerance");
  point.why = reader.text(json, path, "why", false);
  point.verdict = verdict_named(reader.text(json, path, "verdict", false));
  point.reason = reader.text(json, path, "reason", false);
  return point;
}

PlannedLimit limit_of(const JsonReader& reader, const Json& json, const std::string& path) {
  PlannedLimit limit;
  limit.point = reader.text(json, path, "point", true);
  limit.max_lux = reader.number(json, path, "max_lux", false);
  limit.lux = reader.number(json, path, "lux", false);
  reader.read_yes_no(json, path, "met", limit.met);
  return limit;
}

}  // namespace

Checked<Plan> plan_from_json(const std::string& text, const std::string& file_name) {
  JsonReader reader(file_name, "a plan", "write the plan anew with luxrig solve");
  const auto document = reader.document(text);
  if (!document) return tl::unexpected(reader.problems(text));
  const Json& json = *document;
  reader.require_version(json, "luxrig_plan", 1);
  Plan plan;
  plan.rig = reader.text(json, "", "rig", true);
  if (const Json* made_for = reader.member(json, "", "made_for", false)) {
    if (made_for->is_object()) {
      plan.made_for = {reader.fingerprint(*made_for, "/made_for", "goals"),
                       reader.fingerprint(*made_for, "/made_for", "limits"),
                       reader.fingerprint(*made_for, "/made_for", "light")};
    } else {
      reader.wrong_type("", "made_for", "an object in braces", *made_for);
    }
  }
  plan.seed = reader.count<std::uint64_t>(json, "", "seed");
  plan.seconds = reader.number(json, "", "seconds", false);
  reader.each(json, "", "tasks", true,
              [&](const Json& task, const std::string& path) { plan.tasks.push_back(task_of(reader, task, path)); });
  reader.each(json, "", "points", false, [&](const Json& point, const std::string& path) {
    plan.points.push_back(point_of(reader, point, path));
  });
  reader.each(json, "", "limits", false, [&](const Json& limit, const std::string& path) {
    plan.limits.push_back(limit_of(reader, limit, path));
  });
  if (!reader.any_problem()) return plan;
  return tl::unexpected(reader.problems(text));
}

}  // namespace luxrig
