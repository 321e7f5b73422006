#include "tools/luxrigd/api/status_schema.h"

#include "tools/luxrig/calibrate/hand_answer.h"

namespace luxrig {
namespace {

using namespace schema;

using Keys = std::vector<Key>;

/// How times are told, as StatusParts does.
enum class Told { as_ages, as_instants };

/// A time: seconds ago, or seconds after the daemon's start.
Key time(Told told, const char* age_key, const char* instant_key) {
  return told == Told::as_ages ? Key{age_key, number("seconds ago")} : Key{instant_key, number("s after the start")};
}
Key maybe_time(Told told, const char* age_key, const char* instant_key) {
  Key key = time(told, age_key, instant_key);
  key.needed = false;
  return key;
}
/// The end of something.
Key end_time(Told told) {
  return told == Told::as_ages ? Key{"remaining_s", at_least(0, "seconds from now")}
                               : Key{"until_at_s", number("s after the start")};
}

/// What a fixture is; what it is in GET /api/rig; how it is now. So for points and luxmeters.
Keys fixture_fixed() {
  return {{"name", text()},
          {"bus", text()},
          {"address", text("on its bus, as a technician writes it")},
          {"luminaire", text()},
          {"position", vector("m, world")},
          maybe("moves", yes())};
}
Keys fixture_in_rig() {
  return both(fixture_fixed(), {{"max_level", between(0, 1)},
                                {"mount_axes", said(list(vector(), 3), "x, y and z of its base as hung, in the world")},
                                maybe("switched", yes()),
                                maybe("parks", yes()),
                                maybe("pan_range_deg", vector("from, to", 2)),
                                maybe("tilt_range_deg", vector("from, to", 2))});
}
Keys fixture_now() {
  return {{"pan_deg", number()},
          {"tilt_deg", number()},
          maybe("beam_angle_deg", number("of a fixture that zooms")),
          maybe("aim", vector("m, world")),
          maybe("level", between(0, 1, "share of the rated flux that goes out now")),
          maybe("drive", between(0, 1, "on the wire")),
          maybe("target_level", between(0, 1, "where the fade ends")),
          maybe("level_known", Schema{{"const", false}}),
          maybe("identified", yes()),
          maybe("aimed_by_hand", yes()),
          maybe("parked", yes()),
          maybe("dipped", yes()),
          maybe("kept_dark", yes()),
          maybe("waits_for", text("what lights it again")),
          maybe("gain", number("true output over rated output, as estimated")),
          maybe("gain_standard_error", at_least(0))};
}

Keys point_fixed() {
  return {{"name", text()},
          {"position", vector("m, world")},
          {"normal", vector()},
          maybe("max_lux", at_least(0)),
          maybe("goal_tolerance", at_least(0))};
}
Keys point_in_rig() {
  return both(point_fixed(), {{"weight", number()}, maybe("goal_lux", at_least(0, "of the rig file"))});
}
Keys point_now(Told told) {
  return {{"met", yes_or_no("verdict == met")},
          {"why", text("what binds; empty if nothing does")},
          maybe("lux", number("with uncertainty_lux around it: a 95 % interval")),
          maybe("uncertainty_lux", at_least(0)),
          maybe("verdict", one_of_texts({"met", "missed", "unknown"})),
          maybe("reason", text()),
          maybe("limit", one_of_texts({"kept", "exceeded", "unknown"})),
          maybe("limit_reason", text()),
          maybe("goal_lux", at_least(0, "of the plan in force")),
          maybe("predicted_lux", number()),
          maybe("standard_error_lux", at_least(0, "of predicted_lux")),
          maybe("measured_lux", number()),
          maybe_time(told, "measured_age_s", "measured_at_s"),
          maybe("error", number("fraction of the goal, signed"))};
}

Keys luxmeter_fixed() {
  return {{"name", text()},
          {"bus", text()},
          {"address", text()},
          {"position", vector("m, world")},
          {"tolerance", at_least(0, "relative")},
          maybe("point", text("where it measures"))};
}
Keys luxmeter_now(Told told) {
  return {{"life", ref("Life")},
          maybe("lux", number("the last that was believed")),
          maybe_time(told, "age_s", "at_s"),
          maybe("shown_lux", number("its last reading, believed or not")),
          maybe_time(told, "shown_age_s", "shown_at_s")};
}

Keys device(Told told) {
  return {{"name", text()},
          {"life", ref("Life")},
          {"detail", text()},
          {"sent", count()},
          {"received", count()},
          {"errors", count()},
          maybe_time(told, "since_s", "since_at_s"),
          maybe_time(told, "last_ok_s", "last_ok_at_s"),
          maybe("driver", text("of a bus")),
          maybe("address", text("of a bus"))};
}

Schema override(Told told) {
  Key end = end_time(told);
  end.needed = false;
  return answer({{"kind", one_of_texts({"level", "goal"})},
                 {"name", text()},
                 time(told, "age_s", "at_s"),
                 maybe("level", between(0, 1)),
                 maybe("goal_lux", at_least(0)),
                 end,
                 maybe("of_plan", yes()),
                 maybe("why", text("what keeps it from being so"))});
}

Schema desk(Told told) {
  return answer({{"name", text()},
                 {"mode", one_of_texts({"merge", "takeover", "standby"})},
                 {"phase", one_of_texts({"listening", "own", "waiting", "following"})},
                 time(told, "since_s", "since_at_s"),
                 {"source", text()},
                 {"heard", yes_or_no()},
                 {"silent", yes_or_no()}});
}

Schema asked(Told told) {
  return answer({{"id", text()},
                 {"text", text()},
                 {"position", vector("m, world")},
                 {"normal", vector("the way the luxmeter looks")},
                 {"step", count(1)},
                 {"steps", count(1)},
                 {"readings", count()},
                 end_time(told),
                 maybe("fixture", text("which is lit; absent: every lamp is dark")),
                 maybe("level", between(0, 1)),
                 maybe("known_to", at_least(0)),
                 maybe("known_to_worst", at_least(0)),
                 maybe("answer", ref("HandAnswer"))});
}

Keys rest_of_status(Told told) {
  const Schema goals =
      answer({{"met", count()}, {"missed", count()}, {"unknown", count()}, {"tolerance", at_least(0)}});
  const Schema uniformity = answer({{"surface_goal", text()},
                                    {"uniformity", between(0, 1, "lowest over mean illuminance at its points")},
                                    {"low", between(0, 1, "of its interval")},
                                    {"high", between(0, 1)},
                                    {"wanted", between(0, 1)},
                                    {"verdict", one_of_texts({"met", "missed", "unknown"})}});
  const Schema limits = answer({{"kept", count()}, {"exceeded", count()}, {"unknown", count()}});
  const Schema output = answer({{"rate_hz", at_least(0)},
                                {"frames", count()},
                                {"p50_us", number()},
                                {"p99_us", number()},
                                {"max_us", number()},
                                {"realtime", yes_or_no()}});
  const Schema alarm =
      answer({{"severe", yes_or_no()}, {"device", text()}, {"text", text()}, time(told, "since_s", "since_at_s")});
  const Schema bypassed = answer({{"kind", one_of_texts({"luxmeter", "fixture"})},
                                  {"name", text()},
                                  time(told, "age_s", "at_s"),
                                  {"risk", text()}});
  return {{"rig", text()},
          {"version", text("of Luxrig")},
          {"phase", one_of_texts({"idle", "moving", "fading", "settling", "measuring", "correcting", "holding",
                                  "frozen", "safe_fading", "safe"})},
          {"detail", text()},
          time(told, "phase_s", "phase_at_s"),
          {"simulated", yes_or_no()},
          {"blackout", yes_or_no()},
          {"plan_waits", yes_or_no("a plan was taken and is not in force yet")},
          {"round", count()},
          {"rounds", count()},
          {"converged", yes_or_no()},
          maybe("may_be_measured", yes()),
          maybe("sim_control", answer({{"host", text()}, {"port", count(0, 65535)}})),
          maybe("calibrated", text("time of the calibration in use")),
          maybe("question", asked(told)),
          {"goals", goals},
          maybe("uniformities", list(uniformity)),
          {"limits", limits},
          {"alarms", list(alarm)},
          {"overrides", list(override(told))},
          {"bypassed", list(bypassed)},
          {"desks", list(desk(told))},
          {"output", output}};
}

Schema status() {
  const Told told = Told::as_ages;
  return answer(both(rest_of_status(told), {{"time_s", at_least(0, "since the start")},
                                            {"fixtures", list(answer(both(fixture_fixed(), fixture_now())))},
                                            {"points", list(answer(both(point_fixed(), point_now(told))))},
                                            {"luxmeters", list(answer(both(luxmeter_fixed(), luxmeter_now(told))))},
                                            {"devices", list(answer(device(told)))}}));
}

Schema changes() {
  const Told told = Told::as_instants;
  Keys changed = rest_of_status(told);
  for (Key& key : changed) {
    if (!key.needed) key.of = or_null(key.of);  // null: it is gone
    key.needed = false;
  }
  const auto items = [](const Keys& now, const char* what) {
    return said(list(answer(both({{"index", count(0)}}, now))), what);
  };
  return answer({{"version", text("of this answer: the next `since`")},
                 {"whole", yes_or_no("all of it, as `since` was none that the daemon knows")},
                 {"time_s", number("since the daemon's start")},
                 maybe("rig_etag", text("of GET /api/rig, which has what these are")),
                 {"changed", answer(changed)},
                 maybe("fixtures", items(fixture_now(), "index: in the list of GET /api/rig")),
                 maybe("points", items(point_now(told), "index: in the list of GET /api/rig")),
                 maybe("luxmeters", items(luxmeter_now(told), "index: in the list of GET /api/rig")),
                 maybe("devices", items(device(told), "index: in the list of GET /api/status"))});
}

Keys room() {
  const Schema plan = answer({{"url", text()}, {"min", vector("m", 2)}, {"max", vector("m", 2)}});
  return {{"name", text()},
          {"bounds", answer({{"min", vector("m")}, {"max", vector("m")}})},
          maybe("plan", said(plan, "the room from above; image x is world x, up is world +y"))};
}

Keys job() {
  return {{"id", text()},
          {"kind", one_of_texts({"solve"})},
          {"state", one_of_texts({"waits", "runs", "done", "failed", "cancelled", "lost"})},
          {"has_plan", yes_or_no()},
          maybe("stage", text("what it works on")),
          maybe("doing", text("how far that is, or its best result so far, for a person")),
          maybe("can_be_taken", yes()),
          maybe("why", text("it failed or is lost, or its plan is not on disk"))};
}

Schema rig() {
  const Schema bus = answer({{"name", text()}, {"driver", text()}, maybe("address", text())});
  const Schema luminaire = answer({{"name", text()},
                                   {"lumens", at_least(0, "at full level")},
                                   {"colour_rgb", vector("linear Rec. 709 with a luminance of 1")},
                                   maybe("watts", at_least(0)),
                                   maybe("beam_angle_deg", number()),
                                   maybe("field_angle_deg", number())});
  const Schema camera = answer({{"name", text()},
                                {"position", vector("m, world")},
                                {"aim", vector("m, world")},
                                {"vertical_fov_deg", number()},
                                {"width_px", count(1)},
                                {"height_px", count(1)}});
  return answer(both(room(), {{"buses", list(bus)},
                              {"luminaires", list(luminaire)},
                              {"fixtures", list(answer(fixture_in_rig()))},
                              {"points", list(answer(point_in_rig()))},
                              {"luxmeters", list(answer(both(luxmeter_fixed(), {{"normal", vector()}})))},
                              {"cameras", list(camera)},
                              {"materials", list(answer({{"name", text()}, {"reflectance_rgb", vector()}}))},
                              {"triangles", count()},
                              maybe("scene", text("where its geometry is"))}));
}

}  // namespace

Schema status_schemas() {
  const Schema reading = answer({{"what", one_of_texts({"reading"})}, {"lux", between(0, kMostLux)}});
  const Schema other = answer({{"what", one_of_texts({"skip", "other_place", "end"})}});
  return {{"Status", status()},
          {"StatusChanges", changes()},
          {"HandAnswer", any_of({reading, other})},
          {"Life", one_of_texts({"configured", "active", "faulted"})},
          {"Rig", rig()},
          {"Room", answer(room())},
          {"Job", answer(job())},
          {"Change", answer({{"at", text("UTC")},
                             {"who", text()},
                             {"role", one_of_texts({"look", "operate", "configure"})},
                             {"from", text("address; socket: a command on this computer")},
                             {"did", text("method and path")},
                             maybe("asked", {{"type", "object"}}),
                             maybe("asked_bytes", count(0, std::numeric_limits<double>::infinity(),
                                                        "of a body that is too long for the log")),
                             maybe("changed", said({{"type", "object"}, {"additionalProperties", {{"type", "array"}}}},
                                                   "what: [old, new]")),
                             maybe("left_out_before", count(0, std::numeric_limits<double>::infinity(),
                                                            "changes that the file does not have"))})},
          {"JobWithPlan", answer(both(job(), {maybe("plan", ref("Plan"))}))},
          {"Universe",
           answer({{"bus", text()}, {"universe", count()}, {"silent", yes_or_no()}, {"slots", list(count(0, 255))}})}};
}

}  // namespace luxrig
