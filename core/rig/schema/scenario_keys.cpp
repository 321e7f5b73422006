// Keys of scenarios: what happens in a tested show, and what is expected of it.
#include "core/rig/schema/key_tables.h"

namespace luxrig::schema {
namespace {

using enum ValueType;

constexpr Bounds kShowTime{0, 1e6};  // eleven days

constexpr KeySpec kScenarioKeys[] = {
    {"scenario", "name", text, "", kRequired, kAny, "", R"("the dimmer dies in minute two")", "what is tested"},
    {"scenario", "length_s", number, "s", kRequired, {0, 1e6, true}, "", "240", "how long the show runs"},
    {"scenario", "seeds", text, "", R"("1")", kAny, "", R"("1..20")",
     "seeds of the simulated truth, each a run of its own: `\"7\"`, `\"1..20\"` or `\"1, 5, 9..12\"`"},
    {"scenario", "deviations", text, "", R"("mild")", kAny, "", R"("none,output_min=0.7,output_max=1")",
     "how far the truth differs from the rig file: `mild`, `real`, `bad`, `none`, or one with changes, as `luxrig-sim "
     "--deviations` takes them"},
    {"scenario", "start", text, "", R"("solved")", kAny, "solved, dark", R"("dark")",
     "solved: the rig's tasks are solved, and the plan is applied at 0 s; dark: nothing is applied until an event "
     "does"},

    {"event", "name", name, "", kNone, kAny, "", R"("it dies")", "by which `after` refers to it"},
    {"event", "at_s", number, "s", kNone, kShowTime, "", "60", "when it happens, from the beginning of the show"},
    {"event", "after", text, "", kNone, kAny, "", R"("it dies")", "name of an earlier event that it follows"},
    {"event", "after_s", number, "s", "0", kShowTime, "", "5", "how long after that event, or after `when` holds"},
    {"event", "when", text, "", kNone, kAny, "", R"("phase holding")",
     "a condition; it happens once, when that first holds"},
    {"event", "fault", text, "", kNone, kAny, "", R"("silent")",
     "a fault of the simulator (`luxrig-sim --help` lists them) for the devices in `on`"},
    {"event", "do", text, "", kNone, kAny,
     "apply, blackout, lift_blackout, level, goal, release, park, bypass, end_bypass, desk, cover, shade, daylight, "
     "clock_step, replay, stop, kill, power_cut, kill_guardian",
     R"("level")",
     "apply: the solved plan or `plan`. level, goal: by hand, `value`. release, park, bypass: all, or those in `on`. "
     "desk: a lighting desk sends `value` (and aims) for fixtures on a bus with `input`, until it is lost. cover: a "
     "meter sees `value` of its light. shade: a point and its meter get `value` of the lamps' light. "
     "daylight: "
     "`value` times that of the rig file. clock_step: the wall clock jumps by `value` seconds (not with "
     "`--real-time`). replay: desks send what they sent in `recording`, and luxmeters that it has readings of show "
     "those. stop: the daemon ends in order; kill: it dies; power_cut: it and all devices lose power; kill_guardian: "
     "the process that has the light after it dies (with `--real-time`)"},
    {"event", "on", texts, "", kNone, kAny, "", R"(["dimmer"])",
     "devices, fixtures or points, by name; `*` stands for any letters, `?` for one"},
    {"event", "value", number, "", kNone, {-1e6, 1e6}, "", "0.5", "of the fault or action"},
    {"event",
     "for_s",
     number,
     "s",
     kNone,
     {0, 1e6, true},
     "",
     "30",
     "how long it lasts; left out, to the end. A daemon that ends is started again after it, by default 0.5 s"},
    {"event", "pan_deg", number, "°", kNone, kAngle, "", "30", "desk: where it turns heads"},
    {"event", "tilt_deg", number, "°", kNone, kAngle, "", "45", "desk: where it turns heads"},
    {"event", "plan", file, "", kNone, kAny, "", R"("evening.json")", "to apply"},
    {"event", "recording", file, "", kNone, kAny, "", R"("evening.pcap")",
     "to replay, until `for_s` or its end: a file by `luxrig record`, Wireshark, tcpdump or ola_recorder"},
    {"event", "refused", yes_no, "", "false", kAny, "", "true", "the daemon has to refuse this command"},

    {"expect", "always", text, "", kNone, kAny, "", R"("lux drawing-* <= 50")", "a condition that holds all the time"},
    {"expect", "never", text, "", kNone, kAny, "", R"("level spot-1 > 0.9")",
     "a condition that does not hold at any time, for any of the names it has"},
    {"expect", "reached", text, "", kNone, kAny, "", R"("phase safe")", "a condition that holds at some time"},
    {"expect", "at_end", text, "", kNone, kAny, "", R"("missed == 0")", "a condition that holds when the time is over"},
    {"expect", "after", text, "", kNone, kAny, "", R"("it dies")", "the time begins with this event"},
    {"expect", "from_s", number, "s", "0", kShowTime, "", "10",
     "the time begins so long after that, or after the start"},
    {"expect",
     "within_s",
     number,
     "s",
     kNone,
     {0, 1e6, true},
     "",
     "8",
     "how long the time is; left out, to the end of the show"},
    {"expect", "why", text, "", kNone, kAny, "", R"("paper fades above 50 lx")", "said when it fails"},
};

}  // namespace

std::span<const KeySpec> scenario_keys() { return kScenarioKeys; }

}  // namespace luxrig::schema
