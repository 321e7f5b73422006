#include "tools/luxrigd/api/status_schema.h"

#include "tools/luxrig/calibrate/hand_answer.h"

namespace luxrig {
namespace {

using namespace schema;

Schema age(const char* what = "seconds ago") { return at_least(0, what); }

Schema fixture() {
  return answer({{"name", text()},
                 {"bus", text()},
                 {"address", text("on its bus, as a technician writes it")},
                 {"luminaire", text()},
                 {"position", vector("m, world")},
                 {"pan_deg", number()},
                 {"tilt_deg", number()},
                 maybe("beam_angle_deg", number("of a fixture that zooms")),
                 maybe("aim", vector("m, world")),
                 maybe("level", between(0, 1, "share of the rated flux that goes out now")),
                 maybe("drive", between(0, 1, "on the wire")),
                 maybe("target_level", between(0, 1, "where the fade ends")),
                 maybe("level_known", Schema{{"const", false}}),
                 maybe("moves", yes()),
                 maybe("identified", yes()),
                 maybe("aimed_by_hand", yes()),
                 maybe("parked", yes()),
                 maybe("dipped", yes()),
                 maybe("kept_dark", yes()),
                 maybe("waits_for", text("what lights it again")),
                 maybe("gain", number("true output over rated output, as estimated")),
                 maybe("gain_standard_error", at_least(0))});
}

Schema point() {
  return answer({{"name", text()},
                 {"position", vector("m, world")},
                 {"normal", vector()},
                 {"met", yes_or_no("verdict == met")},
                 {"why", text("what binds; empty if nothing does")},
                 maybe("lux", number("with uncertainty_lux around it: a 95 % interval")),
                 maybe("uncertainty_lux", at_least(0)),
                 maybe("verdict", one_of_texts({"met", "missed", "unknown"})),
                 maybe("reason", text()),
                 maybe("limit", one_of_texts({"kept", "exceeded", "unknown"})),
                 maybe("limit_reason", text()),
                 maybe("goal_lux", at_least(0)),
                 maybe("max_lux", at_least(0)),
                 maybe("goal_tolerance", at_least(0)),
                 maybe("predicted_lux", number()),
                 maybe("standard_error_lux", at_least(0, "of predicted_lux")),
                 maybe("measured_lux", number()),
                 maybe("measured_age_s", age()),
                 maybe("error", number("fraction of the goal, signed"))});
}

Schema luxmeter() {
  return answer({{"name", text()},
                 {"bus", text()},
                 {"address", text()},
                 {"position", vector("m, world")},
                 {"tolerance", at_least(0, "relative")},
                 {"life", ref("Life")},
                 maybe("point", text("where it measures")),
                 maybe("lux", number("the last that was believed")),
                 maybe("age_s", age()),
                 maybe("shown_lux", number("its last reading, believed or not")),
                 maybe("shown_age_s", age())});
}

Schema device() {
  return answer({{"name", text()},
                 {"life", ref("Life")},
                 {"detail", text()},
                 {"sent", count()},
                 {"received", count()},
                 {"errors", count()},
                 maybe("since_s", age()),
                 maybe("last_ok_s", age()),
                 maybe("driver", text("of a bus")),
                 maybe("address", text("of a bus"))});
}

Schema override() {
  return answer({{"kind", one_of_texts({"level", "goal"})},
                 {"name", text()},
                 {"age_s", number("seconds ago")},
                 maybe("level", between(0, 1)),
                 maybe("goal_lux", at_least(0)),
                 maybe("remaining_s", at_least(0, "else until it is released")),
                 maybe("of_plan", yes()),
                 maybe("why", text("what keeps it from being so"))});
}

Schema desk() {
  return answer({{"name", text()},
                 {"mode", one_of_texts({"merge", "takeover", "standby"})},
                 {"phase", one_of_texts({"listening", "own", "waiting", "following"})},
                 {"since_s", number("seconds ago")},
                 {"source", text()},
                 {"heard", yes_or_no()},
                 {"silent", yes_or_no()}});
}

Schema asked() {
  return answer({{"id", text()},
                 {"text", text()},
                 {"position", vector("m, world")},
                 {"normal", vector("the way the luxmeter looks")},
                 {"step", count(1)},
                 {"steps", count(1)},
                 {"readings", count()},
                 {"remaining_s", at_least(0)},
                 maybe("fixture", text("which is lit; absent: every lamp is dark")),
                 maybe("level", between(0, 1)),
                 maybe("known_to", at_least(0)),
                 maybe("known_to_worst", at_least(0)),
                 maybe("answer", ref("HandAnswer"))});
}

Schema status() {
  const Schema goals =
      answer({{"met", count()}, {"missed", count()}, {"unknown", count()}, {"tolerance", at_least(0)}});
  const Schema limits = answer({{"kept", count()}, {"exceeded", count()}, {"unknown", count()}});
  const Schema output = answer({{"rate_hz", at_least(0)},
                                {"frames", count()},
                                {"p50_us", number()},
                                {"p99_us", number()},
                                {"max_us", number()},
                                {"realtime", yes_or_no()}});
  const Schema alarm =
      answer({{"severe", yes_or_no()}, {"device", text()}, {"text", text()}, {"since_s", number("seconds ago")}});
  const Schema bypassed = answer({{"kind", one_of_texts({"luxmeter", "fixture"})},
                                  {"name", text()},
                                  {"age_s", number("seconds ago")},
                                  {"risk", text()}});
  return answer({{"rig", text()},
                 {"version", text("of Luxrig")},
                 {"phase", one_of_texts({"idle", "moving", "fading", "settling", "measuring", "correcting", "holding",
                                         "frozen", "safe_fading", "safe"})},
                 {"detail", text()},
                 {"time_s", at_least(0, "since the start")},
                 {"phase_s", number("since the phase began")},
                 {"simulated", yes_or_no()},
                 {"blackout", yes_or_no()},
                 {"plan_waits", yes_or_no("a plan was taken and is not in force yet")},
                 {"round", count()},
                 {"rounds", count()},
                 {"converged", yes_or_no()},
                 maybe("may_be_measured", yes()),
                 maybe("sim_control", answer({{"host", text()}, {"port", count(0, 65535)}})),
                 maybe("calibrated", text("time of the calibration in use")),
                 maybe("question", ref("Question")),
                 {"goals", goals},
                 {"limits", limits},
                 {"fixtures", list(ref("Fixture"))},
                 {"points", list(ref("Point"))},
                 {"luxmeters", list(ref("Luxmeter"))},
                 {"devices", list(ref("Device"))},
                 {"alarms", list(alarm)},
                 {"overrides", list(ref("Override"))},
                 {"bypassed", list(bypassed)},
                 {"desks", list(ref("Desk"))},
                 {"output", output}});
}

}  // namespace

Schema status_schemas() {
  const Schema reading = answer({{"what", one_of_texts({"reading"})}, {"lux", between(0, kMostLux)}});
  const Schema other = answer({{"what", one_of_texts({"skip", "other_place", "end"})}});
  const Schema plan = answer({{"url", text()}, {"min", vector("m", 2)}, {"max", vector("m", 2)}});
  return {{"Status", status()},
          {"Fixture", fixture()},
          {"Point", point()},
          {"Luxmeter", luxmeter()},
          {"Device", device()},
          {"Override", override()},
          {"Desk", desk()},
          {"Question", asked()},
          {"HandAnswer", any_of({reading, other})},
          {"Life", one_of_texts({"configured", "active", "faulted"})},
          {"Room", answer({{"name", text()},
                           {"bounds", answer({{"min", vector("m")}, {"max", vector("m")}})},
                           maybe("plan", said(plan, "the room from above; image x is world x, up is world +y"))})},
          {"Universe",
           answer({{"bus", text()}, {"universe", count()}, {"silent", yes_or_no()}, {"slots", list(count(0, 255))}})}};
}

}  // namespace luxrig
