// Keys for equipment and how it is reached: luminaires, buses, fixtures, meters, cameras.
#include "core/rig/schema/key_tables.h"

namespace luxrig::schema {
namespace {

using enum ValueType;

constexpr Bounds kLuminousSize{0.001, 100};
constexpr Bounds kFullCone{0.001, 180, false, true};
constexpr Bounds kUnitAddress{0, 255};
constexpr Bounds kFlux{0, 1e8, true};
constexpr Bounds kWatts{0, 1e6};
constexpr Bounds kPixels{16, 8192};
constexpr Bounds kExposure_ms{0, 10000, true};
constexpr Bounds kGainSteps{0, 1'000'000};
constexpr Bounds kDarkShare{0, 0.5};
constexpr Bounds kCosinePower{0, 10000};
constexpr Bounds kFullScale{0, 1e9, true};

constexpr KeySpec kFixtureKeys[] = {
    {"luminaire", "name", name, "", kRequired, kAny, "", R"("track spot")", "what fixtures call it"},
    {"luminaire", "model", text, "", kRequired, kAny, "ies, isotropic, spot, cosine, rectangle, disk, sphere, cylinder",
     R"("spot")",
     "a measured distribution, the same all round, a round spot, one that falls as a power of the cosine off its axis, "
     "or an evenly shining surface: a rectangle or disk that faces down, a sphere, an upright cylinder"},
    {"luminaire", "file", file, "", kNone, kAny, "", R"("track-spot.ies")",
     "photometric file: IES LM-63 (.ies), EULUMDAT (.ldt), IES TM-33 (.xml) or GLDF (.gldf), told apart by content "
     "(only "
     "with model `ies`, and required there)"},
    {"luminaire", "file_variant", text, "", kNone, kAny, "", R"("v10")",
     "id or name of the variant in a GLDF file (only with model `ies`); needed where variants differ in their light"},
    {"luminaire", "file_emitter", text, "", kNone, kAny, "", R"("down")",
     "id or name of the emitter in a GLDF or TM-33 file (only with model `ies`); needed where there are several"},
    {"luminaire", "beam_angle_deg", number, "°", kNone, kFullCone, "", "20",
     "full angle to half the peak intensity (only with model `spot`, and required there unless a fixture's GDTF file "
     "states both angles). Between and beyond the two angles intensity falls as 2^-(γ/b)^p, γ off the axis and b half "
     "the beam angle, with the p that gives both; to nothing from the field angle to twice as far off the axis"},
    {"luminaire", "field_angle_deg", number, "°", kNone, kFullCone, "", "40",
     "full angle to a tenth of the peak (only with model `spot`, and required there, the same); more than the beam "
     "angle"},
    {"luminaire", "zoom_deg", span2, "°", kNone, kFullCone, "", "[6, 60]",
     "beam angles that its zoom goes through, narrowest first (only with model `spot`): its flux stays, its field "
     "angle "
     "keeps its ratio to the beam angle. `beam_angle_deg` is what it is set to unless a solve finds better; a fixture "
     "without a zoom slot keeps that"},
    {"luminaire", "exponent", number, "", kNone, kCosinePower, "", "4",
     "intensity falls as the cosine of the angle off the axis to this power, to nothing at 90° (only with model "
     "`cosine`, and required there): 1 is a Lambertian surface seen from afar, 100 a beam of 13.5°"},
    {"luminaire", "length_m", number, "m", kNone, kLuminousSize, "", "1.2",
     "size of a `rectangle` along the lamp's x, or of a `cylinder` along its axis (only there, and required)"},
    {"luminaire", "width_m", number, "m", kNone, kLuminousSize, "", "0.3",
     "size of a `rectangle` along the lamp's y (only there, and required)"},
    {"luminaire", "diameter_m", number, "m", kNone, kLuminousSize, "", "0.04",
     "of a `disk`, `sphere` or `cylinder` (only there, and required)"},
    {"luminaire", "near_field", yes_no, "", "false", kAny, "", "true",
     "light comes from the whole luminous opening that the file states; else from its middle, which is right from "
     "five times its size on (only with model `ies`)"},
    {"luminaire", "lumens", number, "lm", kNone, kFlux, "", "900",
     "rated flux; required, but with model `ies` it may be left out and the file's own flux holds, and with a fixture "
     "whose GDTF file states one that holds"},
    {"luminaire", "watts", number, "W", kNone, kWatts, "", "12",
     "rated electrical power; left out, what the GDTF file of a fixture states, if any"},
    {"luminaire", "cct_k", number, "K", kNone, kKelvin, "", "3000",
     "colour of its light as that of a black body; left out, what the GDTF file of a fixture states, else white (D65)"},
    {"luminaire",
     "colour",
     colour,
     "",
     kNone,
     {0, 1000},
     "",
     "[1, 0.9, 0.8]",
     "the same as linear Rec. 709 [red, green, blue] in any scale; instead of `cct_k`"},
    {"luminaire", "xy", chromaticity, "", kNone, kChromaticity, "", "[0.33, 0.34]",
     "the same as a chromaticity of CIE 1931; instead of `cct_k`. A colour outside Rec. 709 is moved to its edge, with "
     "a "
     "note"},

    {"luminaire.emitters", "name", name, "", kRequired, kAny, "", R"("warm")",
     "what slots call it: `emitter:NAME`; it is the light `FIXTURE/NAME`"},
    {"luminaire.emitters", "lumens", number, "lm", kRequired, kFlux, "", "100", "rated flux of this emitter alone"},
    {"luminaire.emitters", "watts", number, "W", kNone, kWatts, "", "4", "its rated electrical power"},
    {"luminaire.emitters", "cct_k", number, "K", kNone, kKelvin, "", "2700",
     "colour of its light as that of a black body; left out, white (D65)"},
    {"luminaire.emitters",
     "colour",
     colour,
     "",
     kNone,
     {0, 1000},
     "",
     "[1, 0.1, 0]",
     "the same as linear Rec. 709 [red, green, blue] in any scale; instead of `cct_k`"},
    {"luminaire.emitters", "xy", chromaticity, "", kNone, kChromaticity, "", "[0.16, 0.07]",
     "the same as a chromaticity of CIE 1931; instead of `cct_k`"},

    {"bus", "name", name, "", kRequired, kAny, "", R"("dmx")", "what fixtures and meters call it"},
    {"bus", "driver", text, "", kRequired, kAny, "", R"("sacn")", "what drives it; see Bus options"},
    {"bus", "safe_level", number, "", kNone, kShare, "", "0.4",
     "level in the safe look of its fixtures that have none of their own; left out, `level` of `[safe]`"},

    {"fixture", "name", name, "", kRequired, kAny, "", R"("spot-1")", "name of the fixture"},
    {"fixture", "luminaire", text, "", kRequired, kAny, "", R"("track spot")", "name of a `[[luminaire]]`"},
    {"fixture", "position_m", vector3, "m", kRequired, kPosition, "", "[0, 0, 3]",
     "the pan-tilt pivot, which is where it shines from"},
    {"fixture", "mount_deg", vector3, "°", "[0, 0, 0]", kAngle, "", "[10, 20, 30]",
     "how the base is turned: yaw about z, then pitch about its x, then roll about its y; 0 = hangs straight"},
    {"fixture", "aim", text, "", kNone, kAny, "", R"("table top")", "name of the point it looks at"},
    {"fixture", "aim_m", vector3, "m", kNone, kPosition, "", "[0, 0, 0]", "place it looks at"},
    {"fixture", "pan_deg", number, "°", "0", kAngle, "", "5", "turn about the base's z, counter-clockwise from above"},
    {"fixture", "tilt_deg", number, "°", "0", kAngle, "", "7", "from straight down (0) towards y of the panned base"},
    {"fixture", "roll_deg", number, "°", "0", kAngle, "", "9", "turn of the lamp about its beam"},
    {"fixture", "bus", text, "", kRequired, kAny, "", R"("dmx")", "name of a `[[bus]]`"},
    {"fixture",
     "universe",
     whole_number,
     "",
     "1",
     {0, 63999},
     "",
     "2",
     "DMX universe: sACN 1 to 63999, Art-Net port address 0 to 32767"},
    {"fixture", "address", whole_number, "", kNone, {1, 512}, "", "20", "first DMX slot; required over DMX"},
    {"fixture", "personality", file, "", kNone, kAny, "", R"("head.json")",
     "its maker's file, GDTF (.gdtf) or Open Fixture Library (.json), which says what each DMX slot carries; instead "
     "of `slots`"},
    {"fixture", "mode", text, "", kNone, kAny, "", R"("short")",
     "DMX mode that the fixture is set to, as its personality calls it; may be left out when there is but one"},
    {"fixture", "dimmer", text, "", kNone, kAny, "", R"("Dimmer")",
     "the channel of its personality that dims its light, as the file calls it; only needed where two could be it"},
    {"fixture", "slots", texts, "", R"(["dimmer"])", kAny, "", R"(["pan", "tilt", "dimmer"])",
     "what each DMX slot carries from `address` on: `dimmer`, `dimmer-fine`, `dimmer-ultra`, the same with `pan`, "
     "`tilt` and `zoom`, `unused`, or `constant:N` with N from 0 to 255; one dimmer is needed, pan and tilt come "
     "together, zoom with them or an axes_bus, "
     "and a fine slot needs its coarse one, an ultra slot (24 bit) its fine one. With a luminaire that has emitters, "
     "instead of the dimmer: `emitter:NAME`, `emitter:NAME-fine` and `emitter:NAME-ultra`, one for each; hold a master "
     "dimmer open with `constant:255`"},
    {"fixture", "unit", whole_number, "", "1", kUnitAddress, "", "4", "Modbus unit"},
    {"fixture", "register", whole_number, "", kNone, kRegister, "", "6",
     "Modbus holding register of the dimmer, 0-based; required over Modbus"},
    {"fixture", "full_scale", whole_number, "", "1000", {1, 65535}, "", "255", "value of that register at full drive"},
    {"fixture", "register_map", file, "", kNone, kAny, "", R"("dimmer.toml")",
     "its product's registers, a file as in `rigs/register-maps`; instead of `register` and `full_scale`"},
    {"fixture",
     "channel",
     whole_number,
     "",
     kNone,
     {1, 1000},
     "",
     "1",
     "which of the product's levels it is, counted from 1; may be left out when there is but one"},
    {"fixture", "output", text, "", kNone, kAny, "", R"("out1")", "the same by name, as the register map has it"},
    {"fixture", "dimmer_curve", text, "", R"("linear")", kAny, "linear, square, s-curve", R"("square")",
     "how its light follows the drive sent to it, as its maker states"},
    {"fixture", "switched", yes_no, "", "false", kAny, "", "true",
     "it is on or off and cannot dim (a relay, a contactor, a lamp with a driver of its own); on a coil it always is. "
     "Fades switch it off as they begin and on as they end"},
    {"fixture", "max_level", number, "", "1", kShare, "", "0.9", "most of its rated flux that it may ever give"},
    {"fixture", "safe_level", number, "", kNone, kShare, "", "0.3",
     "its level in the safe look, at most `max_level`; left out, that of its bus, else `level` of `[safe]`"},
    {"fixture", "pan_range_deg", span2, "°", "[-270, 270]", kAngle, "", "[-180, 180]",
     "travel of the pan; only with a pan slot or `axes_bus`. With a personality that has a pan it may narrow the "
     "travel "
     "stated there, which else holds"},
    {"fixture", "tilt_range_deg", span2, "°", "[-135, 135]", kAngle, "", "[-100, 100]", "travel of the tilt; the same"},
    {"fixture",
     "pan_speed_deg_s",
     number,
     "°/s",
     "180",
     {0, 3600, true},
     "",
     "90",
     "only with a pan slot or `axes_bus`"},
    {"fixture",
     "tilt_speed_deg_s",
     number,
     "°/s",
     "120",
     {0, 3600, true},
     "",
     "80",
     "only with a tilt slot or `axes_bus`"},
    {"fixture", "zoom_inverted", yes_no, "", "false", kAny, "", "true",
     "its zoom channel at 0 makes the widest beam; only with a zoom slot"},
    {"fixture",
     "zoom_speed_deg_s",
     number,
     "°/s",
     "30",
     {0, 3600, true},
     "",
     "20",
     "how fast its beam angle changes; only with a zoom slot, or a personality whose zoom is used"},
    {"fixture", "park_pan_deg", number, "°", kNone, kAngle, "", "170",
     "pan at which it rests (luxrig park); left out, 0 where `park_tilt_deg` is given, else it has no place to rest"},
    {"fixture", "park_tilt_deg", number, "°", kNone, kAngle, "", "80", "tilt at which it rests; the same"},
    {"fixture", "reset_s", number, "s", "0", kSeconds, "", "12",
     "how long after power comes a moving head finds its zero: its first light waits for that and for its way"},
    {"fixture", "stage", whole_number, "", "1", {1, 1000}, "", "2", "of power-up (`[startup]`): lower stages first"},
    {"fixture", "axes_bus", text, "", kNone, kAny, "", R"("can")",
     "name of the `[[bus]]` on which drives of their own (CiA 402) turn pan and tilt; left out, they are slots of its "
     "address, or it does not move"},
    {"fixture",
     "pan_node",
     whole_number,
     "",
     kNone,
     {1, 127},
     "",
     "5",
     "CANopen node of the drive that turns the pan; required with `axes_bus`"},
    {"fixture", "tilt_node", whole_number, "", kNone, {1, 127}, "", "7", "the same of the tilt"},
    {"fixture",
     "pan_counts_per_degree",
     number,
     "1/°",
     kNone,
     {-1e6, 1e6},
     "",
     "500",
     "position units of the pan's drive per degree of the joint, gear included; not 0; below 0 when the drive counts "
     "the other way; required with `axes_bus`"},
    {"fixture", "tilt_counts_per_degree", number, "1/°", kNone, {-1e6, 1e6}, "", "-500", "the same of the tilt"},
    {"fixture", "pan_home_deg", number, "°", kNone, kAngle, "", "-275",
     "pan at the drive's home position, where it counts 0: at a limit switch, the angle of that switch; required with "
     "`axes_bus`"},
    {"fixture", "tilt_home_deg", number, "°", kNone, kAngle, "", "140", "the same of the tilt"},
    {"fixture",
     "pan_acceleration_deg_s2",
     number,
     "°/s²",
     "360",
     {0, 36000, true},
     "",
     "300",
     "with which the pan speeds up and slows down, at most; only with `axes_bus`"},
    {"fixture", "tilt_acceleration_deg_s2", number, "°/s²", "240", {0, 36000, true}, "", "200", "the same of the tilt"},

    {"luxmeter", "name", name, "", kRequired, kAny, "", R"("meter-1")", "name of the meter"},
    {"luxmeter", "point", text, "", kNone, kAny, "", R"("table top")",
     "the point it stands at; either this or `position_m`"},
    {"luxmeter", "position_m", vector3, "m", kNone, kPosition, "", "[1, 1, 1]", "where it stands, when at no point"},
    {"luxmeter", "normal", vector3, "", "[0, 0, 1]", kPosition, "", "[1, 0, 0]",
     "where its sensor looks, of any length but 0; only with `position_m`"},
    {"luxmeter",
     "tolerance",
     number,
     "",
     "0.05",
     {0, 0.5},
     "",
     "0.03",
     "share of a reading by which it may be wrong, either way"},
    {"luxmeter", "range_lx", number, "lx", "200000", {0, 1e7, true}, "", "1000", "full scale"},
    {"luxmeter", "bus", text, "", kRequired, kAny, "", R"("field")", "name of a `[[bus]]`"},
    {"luxmeter", "unit", whole_number, "", "1", kUnitAddress, "", "2", "Modbus unit"},
    {"luxmeter", "register", whole_number, "", "0", kRegister, "", "5", "first Modbus register, 0-based"},
    {"luxmeter", "registers", whole_number, "", "2", {1, 2}, "", "1", "1: 16 bits, 2: 32 bits, both unsigned"},
    {"luxmeter", "register_kind", text, "", R"("holding")", kAny, "holding, input", R"("input")",
     "read by function 3 or 4"},
    {"luxmeter", "word_order", text, "", R"("high-first")", kAny, "high-first, low-first", R"("low-first")",
     "of two registers"},
    {"luxmeter", "lux_per_count", number, "lx", "0.001", {0, 1e6, true}, "", "0.1", "what one count is worth"},
    {"luxmeter", "register_map", file, "", kNone, kAny, "", R"("meter.toml")",
     "its product's registers, a file as in `rigs/register-maps`; instead of the five keys before this one"},
    {"luxmeter", "reading", text, "", kNone, kAny, "", R"("low")",
     "which of the product's illuminances it is, by name; may be left out when there is but one"},

    {"camera", "name", name, "", kRequired, kAny, "", R"("front")",
     "name of the camera; its pictures are files of that name"},
    {"camera", "position_m", vector3, "m", kRequired, kPosition, "", "[0, -2, 1]", "where its lens is"},
    {"camera", "aim", text, "", kNone, kAny, "", R"("table top")",
     "name of the point in the middle of its picture; or `aim_m`"},
    {"camera", "aim_m", vector3, "m", kNone, kPosition, "", "[0, 0, 0]", "the same as a place"},
    {"camera", "fov_deg", number, "°", "40", {1, 170}, "", "30", "vertical field of view"},
    {"camera", "width_px", whole_number, "", "960", kPixels, "", "640", "of its pictures"},
    {"camera", "height_px", whole_number, "", "640", kPixels, "", "480", "of its pictures"},
    {"camera", "source", text, "", R"("none")", kAny, "none, v4l2, files", R"("v4l2")",
     "where real pictures come from: a Video4Linux device, or `files`"},
    {"camera", "device", text, "", kNone, kAny, "", R"("/dev/video0")",
     "of `v4l2`: its path, bus, serial number or name, as `luxrig devices` has them; left out, the only one there is"},
    {"camera", "files", text, "", kNone, kAny, "", R"("shots")",
     "of `files`: a folder, or a path whose last part is a pattern (`*` and `?`), from the rig file's folder; the "
     "newest "
     "by name is taken: PNG, PGM, PPM, or PFM, which is linear light already"},
    {"camera", "format", text, "", R"("any")", kAny, "any, GREY, Y10, Y12, Y16, YUYV, RGB24, BGR24", R"("Y16")",
     "of `v4l2`: how samples come; `any` takes that with most bits"},
    {"camera", "exposure_ms", number, "ms", kNone, kExposure_ms, "", "20",
     "of `v4l2`: set, and refused when the camera does not keep it; left out only for a device that cannot be told"},
    {"camera", "gain", whole_number, "", kNone, kGainSteps, "", "3",
     "of `v4l2`, in the device's own steps; left out, the device's default"},
    {"camera", "dark_level", number, "", "0", kDarkShare, "", "0.02",
     "what a sample is without light, as a share of full scale; `luxrig camera check` measures it"},
    {"camera", "response", text, "", R"("linear")", kAny, "linear, srgb, bt709", R"("srgb")",
     "how samples grow with light: in proportion, or by a standard's curve"},
    {"camera", "response_file", file, "", kNone, kAny, "", R"("response.toml")",
     "that curve as `luxrig camera check` measured and wrote it; instead of `response` and `dark_level`"},
    {"camera", "full_scale_cd_m2", number, "cd/m²", kNone, kFullScale, "", "500",
     "luminance that fills a sample at this exposure and gain; left out, pictures are in shares of it"},
};

}  // namespace

std::span<const KeySpec> fixture_keys() { return kFixtureKeys; }

}  // namespace luxrig::schema
