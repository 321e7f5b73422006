// Keys of register maps.
#include "core/rig/schema/key_tables.h"

namespace luxrig::schema {
namespace {

using enum ValueType;

constexpr Bounds kBaudRate{300, 4'000'000};
constexpr Bounds kRawRange{-2147483648.0, 4294967295.0};
constexpr Bounds kRawWhole{-2147483648.0, 2147483647.0};

constexpr KeySpec kRegisterMapKeys[] = {
    {"device", "name", name, "", kRequired, kAny, "", R"("Example dimmer")", "maker and product"},
    {"device", "source", text, "", kRequired, kAny, "", R"("https://example.org/dimmer.pdf, revision 3")",
     "the public document that the map was made from"},
    {"device", "assumed", texts, "", kNone, kAny, "", R"(["answer_ms: measured, not stated"])",
     "what that document does not say, and what was taken instead"},
    {"device",
     "answer_ms",
     number,
     "ms",
     kNone,
     {1, 5000},
     "",
     "50",
     "longest time to its answer; left out, `response_timeout_ms` of the bus"},
    {"device",
     "shortest_gap_ms",
     number,
     "ms",
     "0",
     {0, 1000},
     "",
     "5",
     "how long it must be left alone between two requests, beyond the silence that Modbus itself wants"},
    {"device",
     "largest_read",
     whole_number,
     "",
     "125",
     {1, 125},
     "",
     "8",
     "most registers or bits that one request may read"},
    {"device",
     "largest_write",
     whole_number,
     "",
     "123",
     {1, 123},
     "",
     "8",
     "most registers or coils that one request may write; 1: it knows functions 5 and 6 only"},
    {"device", "baud_rates", whole_numbers, "", kNone, kBaudRate, "", "[9600, 19200]",
     "what its line can be set to; left out, any"},
    {"device", "when_data_stops", text, "", R"("hold")", kAny, "hold, dark, watchdog", R"("watchdog")",
     "what its levels do when nobody writes: stay for ever, go out after `stops_after_s` by themselves, or the same "
     "once `[[setup]]` has armed its watchdog"},
    {"device",
     "stops_after_s",
     number,
     "s",
     kNone,
     {0.1, 6553.5},
     "",
     "3",
     "required with `dark` and `watchdog`; a bus must refresh more than twice as often"},

    {"register", "name", name, "", kRequired, kAny, "", R"("time")",
     "what it is called; with `count`, a number is put behind it"},
    {"register", "what", text, "", R"("other")", kAny,
     "other, level, illuminance, temperature, status, setting, failure", R"("status")",
     "what it stands for; a `level` is a share of full output (of a coil: on or off), an `illuminance` is in lux, a "
     "`failure` a bit that is 1 while something is wrong; with `count`, of the level of the same number, else of all"},
    {"register", "address", whole_number, "", kRequired, kRegister, "", "5",
     "first Modbus register or bit, 0-based (40011 in a manual is holding register 10, 00001 coil 0, 10001 discrete "
     "input 0)"},
    {"register", "kind", text, "", R"("holding")", kAny, "holding, input, coil, discrete", R"("input")",
     "which of a unit's four tables: functions 3, 6 and 16; 4; of one bit, 1, 5 and 15; of one bit, 2"},
    {"register", "type", text, "", R"("u16")", kAny, "u16, s16, u32, s32, float32", R"("u32")",
     "32 bits take two registers"},
    {"register", "word_order", text, "", R"("high-first")", kAny, "high-first, low-first", R"("low-first")",
     "of two registers"},
    {"register", "byte_order", text, "", R"("high-first")", kAny, "high-first, low-first", R"("low-first")",
     "within each register; Modbus is high-first"},
    {"register",
     "count",
     whole_number,
     "",
     "1",
     {1, 1000},
     "",
     "2",
     "so many of them, one behind the other: name1, name2 …"},
    {"register",
     "step",
     whole_number,
     "",
     kNone,
     {1, 1000},
     "",
     "3",
     "registers from one to the next; left out, no gap"},
    {"register",
     "scale",
     number,
     "",
     "1",
     {0, 1e6, true},
     "",
     "0.5",
     "what one count is worth, in `unit`; not of a level"},
    {"register", "unit", text, "", kNone, kAny, "", R"("s")", "of the scaled value; an illuminance is in lx"},
    {"register", "access", text, "", R"("read-write")", kAny, "read-write, read, write", R"("read-write")",
     "what may be done to it; a level is written, an illuminance read"},
    {"register", "range", span2, "", kNone, kRawRange, "", "[1, 90]",
     "least and largest value in the register; of a level, required: dark and full"},
    {"register", "power_on", whole_number, "", "0", kRawWhole, "", "7", "its value in the register when power comes"},

    {"setup", "register", text, "", kRequired, kAny, "", R"("arm")", "name of a register that can be written"},
    {"setup", "value", whole_number, "", kRequired, kRawWhole, "", "1", "what is written to it, as it stands there"},
};

}  // namespace

std::span<const KeySpec> register_map_keys() { return kRegisterMapKeys; }

}  // namespace luxrig::schema
