// Keys for driving the rig: keep-outs, limits, control, failure, startup, daemon.
#include "core/rig/schema/key_tables.h"

namespace luxrig::schema {
namespace {

using enum ValueType;

constexpr KeySpec kControlKeys[] = {
    {"keep_out", "name", name, "", kRequired, kAny, "", R"("audience")", "what it is called in messages"},
    {"keep_out", "box_m", box, "m", kNone, kPosition, "", "[[0, 0, 0], [4, 5, 1]]",
     "two opposite corners; either this or `centre_m`"},
    {"keep_out", "centre_m", vector3, "m", kNone, kPosition, "", "[1, 2, 3]", "middle of a sphere, with `radius_m`"},
    {"keep_out", "radius_m", number, "m", kNone, kSize, "", "0.5", "of that sphere"},
    {"keep_out", "heads", texts, "", kNone, kAny, "", R"(["head-*"])",
     "heads that it holds for, by name; `*` stands for any letters, `?` for one; left out, all that move"},
    {"keep_out",
     "margin_deg",
     number,
     "°",
     "2",
     {0, 90},
     "",
     "3",
     "how far the edge of a beam stays away from it: for what a head is off its aim, and light past the field angle"},

    {"limits", "max_level", number, "", "1", kShare, "", "0.95",
     "most that any fixture may ever give, of its rated flux"},
    {"limits",
     "open_loop_margin",
     number,
     "",
     "0.25",
     {0, 0.9},
     "",
     "0.1",
     "share of each `max_lx` kept free until a meter has confirmed the model there"},
    {"limits",
     "max_watts",
     number,
     "W",
     kNone,
     {0, 1e9},
     "",
     "500",
     "most electrical power of all fixtures and placed lights together, taken as rated `watts` times level; every "
     "luminaire of theirs must have `watts`"},

    {"control", "fade_s", number, "s", "3", kSeconds, "", "4", "from one look to the next"},
    {"control", "fade_curve", text, "", R"("s-curve")", kAny, "linear, s-curve", R"("linear")", "course of a fade"},
    {"control", "correction_fade_s", number, "s", "1", kSeconds, "", "2", "from one correction round to the next"},
    {"control", "settle_s", number, "s", "0.5", kSeconds, "", "0.7", "wait after a fade before a meter is believed"},
    {"control", "rounds", whole_number, "", "3", {0, 100}, "", "4", "most correction rounds after a change of look"},
    {"control",
     "tolerance",
     number,
     "",
     "0.02",
     {0, 0.5, true},
     "",
     "0.03",
     "difference between reading and goal, as a share of the goal, that is left as it is"},
    {"control",
     "goal_tolerance",
     number,
     "",
     "0.1",
     {0, 0.5, true},
     "",
     "0.06",
     "how far, as a share of the goal, the true illuminance may be off, either way, for the goal to count as met"},
    {"control",
     "gain_min",
     number,
     "",
     "0.6",
     {0, 1, true},
     "",
     "0.5",
     "least true output of a fixture, over its rated one, that readings can make the program believe"},
    {"control", "gain_max", number, "", "1.15", {1, 10}, "", "1.3", "the same, most"},

    {"control", "fault_dips", yes_no, "", "true", kAny, "", "false",
     "whether a held show may dim one lamp by a fifth, at most by half, for some 8 s, when readings change and several "
     "faults explain that; false where no light may change unasked, as in mid-shot. Alarms then name several causes"},

    {"safe", "level", number, "", "0.1", kShare, "", "0.2",
     "of every fixture that has no `safe_level` of its own, nor its bus one"},
    {"safe", "hold_s", number, "s", "5", kSeconds, "", "6", "how long the last look is held first"},
    {"safe", "fade_s", number, "s", "3", kSeconds, "", "8", "from there to the safe look"},
    {"safe", "scope", text, "", R"("rest-stays")", kAny, "rest-stays, all", R"("all")",
     "what a lost bus or dimmer sends to the safe look: the fixtures that hang on it, or all"},
    {"safe", "on_meter_loss", yes_no, "", "false", kAny, "", "true",
     "whether a lost luxmeter sends all light to the safe look; else only its own readings are done without"},

    {"startup", "stage_s", number, "s", "0", kSeconds, "", "2",
     "from the beginning of one `stage` of fixtures to that of the next; each comes on over `fade_s` of `[control]`"},
    {"startup",
     "max_watts_per_s",
     number,
     "W/s",
     kNone,
     {10, 1e9},
     "",
     "500",
     "most electrical power added in a second: fixtures come on one after the other, by stage, then as they stand in "
     "this file; every luminaire of theirs must have `watts`"},
    {"startup", "after_loss", yes_no, "", "false", kAny, "", "true",
     "whether a device that was lost and is back starts so, too, as it does where losses are power cuts. It is dark "
     "first, then, even if it had held its light"},

    {"daemon", "http_port", whole_number, "", "9620", {1, 65535}, "", "1234", "port of the page and the API"},
    {"daemon", "listen", text, "", R"("127.0.0.1")", kAny, "", R"("0.0.0.0")",
     "address of this computer at which the page is served, in digits; any but loopback needs `accounts`, "
     "`tls_certificate` and `tls_key`; 0.0.0.0 or :: is all of them"},
    {"daemon", "accounts", text, "", kNone, kAny, "", R"("accounts.json")",
     "file of people and scripts who may use the daemon, and in which role; `luxrig accounts` writes it, mode 600"},
    {"daemon", "tls_certificate", text, "", kNone, kAny, "", R"("page.pem")",
     "PEM file: the certificate of the names by which the page is reached, then those that lead to its issuer"},
    {"daemon", "tls_key", text, "", kNone, kAny, "", R"("page-key.pem")",
     "PEM file: its key, which others may not read"},
    {"daemon", "behind_proxy", yes_no, "", "false", kAny, "", "true",
     "whether a reverse proxy on this computer serves the page to others: its X-Forwarded-For and X-Forwarded-Proto "
     "are "
     "believed; needs `accounts`"},
    {"daemon", "park_at_end", yes_no, "", "false", kAny, "", "true",
     "whether heads go dark and to where they rest before the daemon ends in order"},
};

}  // namespace

std::span<const KeySpec> control_keys() { return kControlKeys; }

}  // namespace luxrig::schema
