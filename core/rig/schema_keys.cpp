// Every section and key of a rig file and of a register map, in the order of REFERENCE.md.
#include "core/rig/schema.h"

namespace luxrig {
namespace {

using enum ValueType;

constexpr Bounds kAny{};
constexpr Bounds kPosition{-1e6, 1e6};
constexpr Bounds kSize{0, 1e4, true};
constexpr Bounds kReflectance{0, 0.95};
constexpr Bounds kRoughness{0.05, 1};
constexpr Bounds kLuminousSize{0.001, 100};
constexpr Bounds kShare{0, 1};
constexpr Bounds kLux{0, 1e7};
constexpr Bounds kOutdoors{0, 200'000, true};  // the sun above the air gives 127,500 lx
constexpr Bounds kAngle{-3600, 3600};
constexpr Bounds kBearing{-360, 360};
constexpr Bounds kQuarterTurn{-90, 90};
constexpr Bounds kFullCone{0, 180, true, true};
constexpr Bounds kSeconds{0, 3600};
constexpr Bounds kUnitAddress{0, 255};
constexpr Bounds kRegister{0, 65535};
constexpr Bounds kBaudRate{300, 4'000'000};
constexpr Bounds kRawRange{-2147483648.0, 4294967295.0};
constexpr Bounds kRawWhole{-2147483648.0, 2147483647.0};
constexpr Bounds kLights{1, 1000};
constexpr Bounds kChromaticity{0, 1, true, true};
constexpr Bounds kKelvin{1667, 25000};
constexpr Bounds kFlux{0, 1e8, true};
constexpr Bounds kWatts{0, 1e6};
constexpr Bounds kWeight{0, 1000};
constexpr Bounds kPixels{16, 8192};
constexpr Bounds kExposure_ms{0, 10000, true};
constexpr Bounds kGainSteps{0, 1'000'000};
constexpr Bounds kDarkShare{0, 0.5};
constexpr Bounds kFullScale{0, 1e9, true};
constexpr std::string_view kUnits = "m, cm, mm, in, ft";
constexpr std::string_view kAxes = "x, y, z";

constexpr auto kInMap = SectionSpec::File::register_map;
constexpr SectionSpec kSections[] = {
    {"rig", false, 1, false, "What the rig is called."},
    {"scene", false, 1, false, "The room: a mesh, and how much light its surfaces send back. Leave it out for a void."},
    {"scene.reflectance", true, 10000, false,
     "Reflectance by material name. The first rule that matches wins, also over colours in the mesh file."},
    {"scene.object", true, 10000, false, "A thing put into the room: a mesh (`file`) or a box (`box_m`)."},
    {"daylight", false, 1, false,
     "Light from outside, through whatever openings the mesh leaves: a sky of the CIE, and the sun. It cannot be "
     "dimmed."},
    {"luminaire", true, 10000, false, "A kind of light: what it sends where, at rated flux. Fixtures name it."},
    {"luminaire.emitters", true, 64, false,
     "Emitters of a luminaire that are set one by one, as the red, green, blue and white of a stage light: each with "
     "its flux and colour, all with the luminaire's distribution, which then has no `lumens`, `watts` or colour of its "
     "own. `emitters = [{ … }, { … }]` on one line is the same."},
    {"bus", true, 1000, true, "A way to reach devices. Every further key is the driver's own: see Bus options."},
    {"fixture", true, 10000, false,
     "A luminaire as hung and patched: over DMX (`universe`, `address`, and `slots` or `personality`) or over Modbus "
     "(`unit`, and `register_map` with `channel` or `output`, or `register` with `full_scale`). Its pan and tilt may "
     "be "
     "slots, or drives of their own on another bus (`axes_bus`). Say where it looks by `aim`, by `aim_m`, or by "
     "`pan_deg` and `tilt_deg`."},
    {"luxmeter", true, 10000, false, "A light meter on a Modbus bus. It stands at a `point`, or at `position_m`."},
    {"camera", true, 100, false,
     "Takes pictures of the rig. A real one has a `source`; without, only the simulated rig takes its pictures. An "
     "`aim` task keeps light out of all."},
    {"point", true, 100000, false, "A place whose illuminance matters, on the side its normal points to."},
    {"points", false, 1, false, "Further points, from a table."},
    {"task", true, 1000, false, "What to work out. Without one: an `emittance` task called `levels`."},
    {"mounting", false, 1, false,
     "Where a `placement` or `highlight` task may hang lights. Without it: in the air within the scene's bounding box, "
     "0.1 m off "
     "everything. Places behind closed surfaces, from which no light gets to a point with a goal, cost nothing."},
    {"limits", false, 1, false, "What holds for the whole rig."},
    {"control", false, 1, false, "How looks change, and how readings correct them."},
    {"safe", false, 1, false, "What the light does when something fails."},
    {"daemon", false, 1, false, "The program that keeps the rig running."},
    {"device", false, 1, false,
     "In a register map, not in a rig file: a product with Modbus registers, its limits, and what it does when data "
     "stops. Files of some products are in `rigs/register-maps`.",
     kInMap},
    {"register", true, 2000, false,
     "In a register map: a number that the product keeps, in one register or two. Only what a `level` or an "
     "`illuminance` is matters for control; the others say what else is there.",
     kInMap},
    {"setup", true, 100, false,
     "In a register map: what is written to the product before anything else, in this order, whenever it may have "
     "restarted; a watchdog is armed this way.",
     kInMap},
};

constexpr KeySpec kRigKeys[] = {
    {"rig", "name", name, "", kRequired, kAny, "", "name of the rig; plans are only applied to the rig they name"},

    {"scene", "file", file, "", kNone, kAny, "", "mesh of the room: OBJ, PLY, glTF or GLB"},
    {"scene", "unit", text, "", R"("m")", kAny, kUnits, "length unit of the mesh file"},
    {"scene", "up_axis", text, "", R"("y")", kAny, kAxes, "axis of the mesh file that points up (glTF: y)"},
    {"scene", "default_reflectance", colour, "", "0.5", kReflectance, "",
     "diffuse reflectance where neither a rule nor the mesh file gives one"},

    {"scene.reflectance", "material", text, "", kRequired, kAny, "",
     "name of the material; `*` stands for any letters, `?` for one"},
    {"scene.reflectance", "reflectance", colour, "", kRequired, kReflectance, "", "diffuse reflectance"},
    {"scene.reflectance", "specular", number, "", "0", kReflectance, "",
     "gloss: what a coat over it mirrors at normal incidence (varnish, polished floors 0.04; metals more); 0 is matt"},
    {"scene.reflectance", "roughness", number, "", "0.3", kRoughness, "",
     "how much the coat scatters what it mirrors: 0.05 nearly a mirror, 1 nearly matt"},

    {"scene.object", "name", name, "", kRequired, kAny, "", "name of the object"},
    {"scene.object", "file", file, "", kNone, kAny, "", "its mesh; either this or `box_m`"},
    {"scene.object", "unit", text, "", R"("m")", kAny, kUnits, "length unit of the mesh file"},
    {"scene.object", "up_axis", text, "", R"("y")", kAny, kAxes, "axis of the mesh file that points up"},
    {"scene.object", "height_m", number, "m", kNone, kSize, "", "scales the mesh evenly to this height"},
    {"scene.object", "box_m", vector3, "m", kNone, kSize, "", "a box instead of a mesh: width x, depth y, height z"},
    {"scene.object", "position_m", vector3, "m", "[0, 0, 0]", kPosition, "",
     "where the middle of its underside stands"},
    {"scene.object", "turn_deg", number, "°", "0", kAngle, "", "turn about the vertical, counter-clockwise from above"},
    {"scene.object", "reflectance", colour, "", kNone, kReflectance, "",
     "of all of it; left out, the rules and the mesh file's colours apply"},

    {"daylight", "sky", text, "", kRequired, kAny, "uniform, overcast, clear, general",
     "how its brightness is spread: the same everywhere, CIE overcast, CIE clear, or a type of the CIE general sky"},
    {"daylight",
     "sky_type",
     whole_number,
     "",
     kNone,
     {1, 15},
     "",
     "type of ISO 15469 / CIE S 011: 1 to 5 overcast, 6 to 10 partly cloudy, 11 to 15 clear (only with sky `general`, "
     "and required there)"},
    {"daylight", "horizontal_lx", number, "lx", kNone, kOutdoors, "",
     "what the sky alone gives an open horizontal plane; left out, the mean for the sun's elevation"},
    {"daylight", "sun", yes_no, "", "true", kAny, "", "whether the sun itself shines; else only the sky"},
    {"daylight", "sun_normal_lx", number, "lx", kNone, kOutdoors, "",
     "what the sun gives a plane that faces it; left out, the mean for its elevation under a clear or partly cloudy "
     "sky, nothing under an overcast one"},
    {"daylight", "sun_azimuth_deg", number, "°", kNone, kBearing, "",
     "where the sun stands, from north over east; with `sun_elevation_deg`"},
    {"daylight", "sun_elevation_deg", number, "°", kNone, kQuarterTurn, "", "its height above the horizon"},
    {"daylight", "latitude_deg", number, "°", kNone, kQuarterTurn, "",
     "north positive; with `longitude_deg` and `time`, instead of the sun's angles"},
    {"daylight", "longitude_deg", number, "°", kNone, {-180, 180}, "", "east positive"},
    {"daylight", "time", text, "", kNone, kAny, "", "date, time and offset from UTC: `2026-06-21T12:00:00+02:00`"},
    {"daylight", "north_deg", number, "°", "0", kAngle, "",
     "where north lies in the model: turned from +y, counter-clockwise from above (-90: north is +x)"},

    {"luminaire", "name", name, "", kRequired, kAny, "", "what fixtures call it"},
    {"luminaire", "model", text, "", kRequired, kAny, "ies, isotropic, spot, rectangle, disk, sphere, cylinder",
     "a measured distribution, the same all round, a round spot, or an evenly shining surface: a rectangle or disk "
     "that "
     "faces down, a sphere, an upright cylinder"},
    {"luminaire", "file", file, "", kNone, kAny, "",
     "IES LM-63 file, or EULUMDAT when it ends in .ldt (only with model `ies`, and required there)"},
    {"luminaire", "beam_angle_deg", number, "°", kNone, kFullCone, "",
     "full angle to half the peak intensity (only with model `spot`, and required there)"},
    {"luminaire", "field_angle_deg", number, "°", kNone, kFullCone, "",
     "full angle to a tenth of the peak (only with model `spot`, and required there); more than the beam angle"},
    {"luminaire", "zoom_deg", span2, "°", kNone, kFullCone, "",
     "beam angles that its zoom goes through, narrowest first (only with model `spot`): its flux stays, its field "
     "angle "
     "keeps its ratio to the beam angle. `beam_angle_deg` is what it is set to unless a solve finds better; a fixture "
     "without a zoom slot keeps that"},
    {"luminaire", "length_m", number, "m", kNone, kLuminousSize, "",
     "size of a `rectangle` along the lamp's x, or of a `cylinder` along its axis (only there, and required)"},
    {"luminaire", "width_m", number, "m", kNone, kLuminousSize, "",
     "size of a `rectangle` along the lamp's y (only there, and required)"},
    {"luminaire", "diameter_m", number, "m", kNone, kLuminousSize, "",
     "of a `disk`, `sphere` or `cylinder` (only there, and required)"},
    {"luminaire", "near_field", yes_no, "", "false", kAny, "",
     "light comes from the whole luminous opening that the file states; else from its middle, which is right from "
     "five times its size on (only with model `ies`)"},
    {"luminaire", "lumens", number, "lm", kNone, kFlux, "",
     "rated flux; required, but with model `ies` it may be left out and the file's own flux holds"},
    {"luminaire", "watts", number, "W", kNone, kWatts, "", "rated electrical power"},
    {"luminaire", "cct_k", number, "K", kNone, kKelvin, "",
     "colour of its light as that of a black body; left out, white (D65)"},
    {"luminaire",
     "colour",
     colour,
     "",
     kNone,
     {0, 1000},
     "",
     "the same as linear Rec. 709 [red, green, blue] in any scale; instead of `cct_k`"},
    {"luminaire", "xy", chromaticity, "", kNone, kChromaticity, "",
     "the same as a chromaticity of CIE 1931; instead of `cct_k`. A colour outside Rec. 709 is moved to its edge, with "
     "a "
     "note"},

    {"luminaire.emitters", "name", name, "", kRequired, kAny, "",
     "what slots call it: `emitter:NAME`; it is the light `FIXTURE/NAME`"},
    {"luminaire.emitters", "lumens", number, "lm", kRequired, kFlux, "", "rated flux of this emitter alone"},
    {"luminaire.emitters", "watts", number, "W", kNone, kWatts, "", "its rated electrical power"},
    {"luminaire.emitters", "cct_k", number, "K", kNone, kKelvin, "",
     "colour of its light as that of a black body; left out, white (D65)"},
    {"luminaire.emitters",
     "colour",
     colour,
     "",
     kNone,
     {0, 1000},
     "",
     "the same as linear Rec. 709 [red, green, blue] in any scale; instead of `cct_k`"},
    {"luminaire.emitters", "xy", chromaticity, "", kNone, kChromaticity, "",
     "the same as a chromaticity of CIE 1931; instead of `cct_k`"},

    {"bus", "name", name, "", kRequired, kAny, "", "what fixtures and meters call it"},
    {"bus", "driver", text, "", kRequired, kAny, "", "what drives it; see Bus options"},

    {"fixture", "name", name, "", kRequired, kAny, "", "name of the fixture"},
    {"fixture", "luminaire", text, "", kRequired, kAny, "", "name of a `[[luminaire]]`"},
    {"fixture", "position_m", vector3, "m", kRequired, kPosition, "",
     "the pan-tilt pivot, which is where it shines from"},
    {"fixture", "mount_deg", vector3, "°", "[0, 0, 0]", kAngle, "",
     "how the base is turned: yaw about z, then pitch about its x, then roll about its y; 0 = hangs straight"},
    {"fixture", "aim", text, "", kNone, kAny, "", "name of the point it looks at"},
    {"fixture", "aim_m", vector3, "m", kNone, kPosition, "", "place it looks at"},
    {"fixture", "pan_deg", number, "°", "0", kAngle, "", "turn about the base's z, counter-clockwise from above"},
    {"fixture", "tilt_deg", number, "°", "0", kAngle, "", "from straight down (0) towards y of the panned base"},
    {"fixture", "roll_deg", number, "°", "0", kAngle, "", "turn of the lamp about its beam"},
    {"fixture", "bus", text, "", kRequired, kAny, "", "name of a `[[bus]]`"},
    {"fixture",
     "universe",
     whole_number,
     "",
     "1",
     {0, 63999},
     "",
     "DMX universe: sACN 1 to 63999, Art-Net port address 0 to 32767"},
    {"fixture", "address", whole_number, "", kNone, {1, 512}, "", "first DMX slot; required over DMX"},
    {"fixture", "personality", file, "", kNone, kAny, "",
     "its maker's file, GDTF (.gdtf) or Open Fixture Library (.json), which says what each DMX slot carries; instead "
     "of `slots`"},
    {"fixture", "mode", text, "", kNone, kAny, "",
     "DMX mode that the fixture is set to, as its personality calls it; may be left out when there is but one"},
    {"fixture", "slots", texts, "", R"(["dimmer"])", kAny, "",
     "what each DMX slot carries from `address` on: `dimmer`, `dimmer-fine`, `dimmer-ultra`, the same with `pan`, "
     "`tilt` and `zoom`, `unused`, or `constant:N` with N from 0 to 255; one dimmer is needed, pan and tilt come "
     "together, zoom with them, "
     "and a fine slot needs its coarse one, an ultra slot (24 bit) its fine one. With a luminaire that has emitters, "
     "instead of the dimmer: `emitter:NAME`, `emitter:NAME-fine` and `emitter:NAME-ultra`, one for each; hold a master "
     "dimmer open with `constant:255`"},
    {"fixture", "unit", whole_number, "", "1", kUnitAddress, "", "Modbus unit"},
    {"fixture", "register", whole_number, "", kNone, kRegister, "",
     "Modbus holding register of the dimmer, 0-based; required over Modbus"},
    {"fixture", "full_scale", whole_number, "", "1000", {1, 65535}, "", "value of that register at full drive"},
    {"fixture", "register_map", file, "", kNone, kAny, "",
     "its product's registers, a file as in `rigs/register-maps`; instead of `register` and `full_scale`"},
    {"fixture",
     "channel",
     whole_number,
     "",
     kNone,
     {1, 1000},
     "",
     "which of the product's levels it is, counted from 1; may be left out when there is but one"},
    {"fixture", "output", text, "", kNone, kAny, "", "the same by name, as the register map has it"},
    {"fixture", "dimmer_curve", text, "", R"("linear")", kAny, "linear, square, s-curve",
     "how its light follows the drive sent to it, as its maker states"},
    {"fixture", "max_level", number, "", "1", kShare, "", "most of its rated flux that it may ever give"},
    {"fixture", "safe_level", number, "", kNone, kShare, "",
     "its level in the safe look, at most `max_level`; left out, `level` of `[safe]`"},
    {"fixture", "pan_range_deg", span2, "°", "[-270, 270]", kAngle, "",
     "travel of the pan; only with a pan slot or `axes_bus`. With a personality that has a pan it may narrow the "
     "travel "
     "stated there, which else holds"},
    {"fixture", "tilt_range_deg", span2, "°", "[-135, 135]", kAngle, "", "travel of the tilt; the same"},
    {"fixture", "pan_speed_deg_s", number, "°/s", "180", {0, 3600, true}, "", "only with a pan slot or `axes_bus`"},
    {"fixture", "tilt_speed_deg_s", number, "°/s", "120", {0, 3600, true}, "", "only with a tilt slot or `axes_bus`"},
    {"fixture", "zoom_inverted", yes_no, "", "false", kAny, "",
     "its zoom channel at 0 makes the widest beam; only with a zoom slot"},
    {"fixture",
     "zoom_speed_deg_s",
     number,
     "°/s",
     "30",
     {0, 3600, true},
     "",
     "how fast its beam angle changes; only with a zoom slot, or a personality whose zoom is used"},
    {"fixture", "axes_bus", text, "", kNone, kAny, "",
     "name of the `[[bus]]` on which drives of their own (CiA 402) turn pan and tilt; left out, they are slots of its "
     "address, or it does not move"},
    {"fixture",
     "pan_node",
     whole_number,
     "",
     kNone,
     {1, 127},
     "",
     "CANopen node of the drive that turns the pan; required with `axes_bus`"},
    {"fixture", "tilt_node", whole_number, "", kNone, {1, 127}, "", "the same of the tilt"},
    {"fixture",
     "pan_counts_per_degree",
     number,
     "1/°",
     kNone,
     {-1e6, 1e6},
     "",
     "position units of the pan's drive per degree of the joint, gear included; not 0; below 0 when the drive counts "
     "the other way; required with `axes_bus`"},
    {"fixture", "tilt_counts_per_degree", number, "1/°", kNone, {-1e6, 1e6}, "", "the same of the tilt"},
    {"fixture", "pan_home_deg", number, "°", kNone, kAngle, "",
     "pan at the drive's home position, where it counts 0: at a limit switch, the angle of that switch; required with "
     "`axes_bus`"},
    {"fixture", "tilt_home_deg", number, "°", kNone, kAngle, "", "the same of the tilt"},
    {"fixture",
     "pan_acceleration_deg_s2",
     number,
     "°/s²",
     "360",
     {0, 36000, true},
     "",
     "with which the pan speeds up and slows down, at most; only with `axes_bus`"},
    {"fixture", "tilt_acceleration_deg_s2", number, "°/s²", "240", {0, 36000, true}, "", "the same of the tilt"},

    {"luxmeter", "name", name, "", kRequired, kAny, "", "name of the meter"},
    {"luxmeter", "point", text, "", kNone, kAny, "", "the point it stands at; either this or `position_m`"},
    {"luxmeter", "position_m", vector3, "m", kNone, kPosition, "", "where it stands, when at no point"},
    {"luxmeter", "normal", vector3, "", "[0, 0, 1]", kPosition, "",
     "where its sensor looks, of any length but 0; only with `position_m`"},
    {"luxmeter",
     "tolerance",
     number,
     "",
     "0.05",
     {0, 0.5},
     "",
     "share of a reading by which it may be wrong, either way"},
    {"luxmeter", "range_lx", number, "lx", "200000", {0, 1e7, true}, "", "full scale"},
    {"luxmeter", "bus", text, "", kRequired, kAny, "", "name of a `[[bus]]`"},
    {"luxmeter", "unit", whole_number, "", "1", kUnitAddress, "", "Modbus unit"},
    {"luxmeter", "register", whole_number, "", "0", kRegister, "", "first Modbus register, 0-based"},
    {"luxmeter", "registers", whole_number, "", "2", {1, 2}, "", "1: 16 bits, 2: 32 bits, both unsigned"},
    {"luxmeter", "register_kind", text, "", R"("holding")", kAny, "holding, input", "read by function 3 or 4"},
    {"luxmeter", "word_order", text, "", R"("high-first")", kAny, "high-first, low-first", "of two registers"},
    {"luxmeter", "lux_per_count", number, "lx", "0.001", {0, 1e6, true}, "", "what one count is worth"},
    {"luxmeter", "register_map", file, "", kNone, kAny, "",
     "its product's registers, a file as in `rigs/register-maps`; instead of the five keys before this one"},
    {"luxmeter", "reading", text, "", kNone, kAny, "",
     "which of the product's illuminances it is, by name; may be left out when there is but one"},

    {"camera", "name", name, "", kRequired, kAny, "", "name of the camera; its pictures are files of that name"},
    {"camera", "position_m", vector3, "m", kRequired, kPosition, "", "where its lens is"},
    {"camera", "aim", text, "", kNone, kAny, "", "name of the point in the middle of its picture; or `aim_m`"},
    {"camera", "aim_m", vector3, "m", kNone, kPosition, "", "the same as a place"},
    {"camera", "fov_deg", number, "°", "40", {1, 170}, "", "vertical field of view"},
    {"camera", "width_px", whole_number, "", "960", kPixels, "", "of its pictures"},
    {"camera", "height_px", whole_number, "", "640", kPixels, "", "of its pictures"},
    {"camera", "source", text, "", R"("none")", kAny, "none, v4l2, files",
     "where real pictures come from: a Video4Linux device, or `files`"},
    {"camera", "device", text, "", kNone, kAny, "",
     "of `v4l2`: its path, bus, serial number or name, as `luxrig devices` has them; left out, the only one there is"},
    {"camera", "files", text, "", kNone, kAny, "",
     "of `files`: a folder, or a path whose last part is a pattern (`*` and `?`), from the rig file's folder; the "
     "newest "
     "by name is taken: PNG, PGM, PPM, or PFM, which is linear light already"},
    {"camera", "format", text, "", R"("any")", kAny, "any, GREY, Y10, Y12, Y16, YUYV, RGB24, BGR24",
     "of `v4l2`: how samples come; `any` takes that with most bits"},
    {"camera", "exposure_ms", number, "ms", kNone, kExposure_ms, "",
     "of `v4l2`: set, and refused when the camera does not keep it; left out only for a device that cannot be told"},
    {"camera", "gain", whole_number, "", kNone, kGainSteps, "",
     "of `v4l2`, in the device's own steps; left out, the device's default"},
    {"camera", "dark_level", number, "", "0", kDarkShare, "",
     "what a sample is without light, as a share of full scale; `luxrig camera check` measures it"},
    {"camera", "response", text, "", R"("linear")", kAny, "linear, srgb, bt709",
     "how samples grow with light: in proportion, or by a standard's curve"},
    {"camera", "response_file", file, "", kNone, kAny, "",
     "that curve as `luxrig camera check` measured and wrote it; instead of `response` and `dark_level`"},
    {"camera", "full_scale_cd_m2", number, "cd/m²", kNone, kFullScale, "",
     "luminance that fills a sample at this exposure and gain; left out, pictures are in shares of it"},

    {"point", "name", name, "", kRequired, kAny, "", "name of the point"},
    {"point", "position_m", vector3, "m", kRequired, kPosition, "", "where it is"},
    {"point", "normal", vector3, "", "[0, 0, 1]", kPosition, "", "out of the lit side, of any length but 0"},
    {"point",
     "goal_lx",
     number,
     "lx",
     kNone,
     {0, 1e7, true},
     "",
     "wanted illuminance; left out, it is only reported. To keep a place dark, use `max_lx`"},
    {"point", "goal_xy", chromaticity, "", kNone, kChromaticity, "",
     "wanted chromaticity (CIE 1931), beside `goal_lx`; once one goal has a colour, all that count must"},
    {"point", "goal_cct_k", number, "K", kNone, kKelvin, "", "the same as that of a black body; instead of `goal_xy`"},
    {"point", "weight", number, "", "1", {0, 1e6}, "", "how much its goal counts against others"},
    {"point", "max_lx", number, "lx", kNone, kLux, "", "never more than this; it wins over any goal"},

    {"points", "file", file, "", kRequired, kAny, "", "CSV file; see The points file"},

    {"task", "name", name, "", kRequired, kAny, "", "name of the task"},
    {"task", "kind", text, "", kRequired, kAny, "emittance, placement, aim, highlight",
     "`emittance`: the level of every fixture; `placement`: where further lights should hang, and their levels; `aim`: "
     "where heads that hang look and how bright they are, so that an object's relief reads; `highlight`: where further "
     "lights should hang for that"},
    {"task",
     "max_watts",
     number,
     "W",
     kNone,
     {0, 1e9},
     "",
     "most electrical power of the lights that this task sets or places, taken as rated `watts` times level; every "
     "luminaire of theirs must have `watts`"},
    {"task", "luminaire", text, "", kNone, kAny, "",
     "name of the `[[luminaire]]` to place (kind `placement` and `highlight`; required there)"},
    {"task", "lights", whole_number, "", kNone, kLights, "",
     "how many (kind `placement` and `highlight`); left out, as few as will do, or until contrast rises no more"},
    {"task", "max_lights", whole_number, "", kNone, kLights, "",
     "most of them, when `lights` is left out; left out too, 20 (`placement`) or 8 (`highlight`)"},
    {"task", "error_wanted", number, "", "0.001", kShare, "",
     "normalised error at which the search ends: root mean square of what is missing over that of the goals (only with "
     "kind `placement`, as all keys from here to `bound`)"},
    {"task",
     "improvement",
     number,
     "",
     "0.05",
     {0, 1, false, true},
     "",
     "share of the error that one more light must take away to be worth hanging, when `lights` is left out"},
    {"task", "method", text, "", R"("luxrig")", kAny, "luxrig, gpk15, gp16, lin2013, annealing, pursuit",
     "how places are searched. `luxrig`: one light after the other, all refined together, taken out and put back; the "
     "others are published methods to compare with (`gpk15` and `annealing` need `lights`)"},
    {"task", "aimed", yes_no, "", "false", kAny, "",
     "whether lights may look anywhere, which is searched with their places; else they hang straight down"},
    {"task", "indirect", yes_no, "", "true", kAny, "",
     "whether the search counts reflected light, too, which takes longer; predicted lux always do"},
    {"task", "fixtures", text, "", R"("as-set")", kAny, "as-set, off, full",
     "what the rig's own fixtures do meanwhile: what the tasks before this one have set (dark, where none has), dark, "
     "or the most they may give"},
    {"task",
     "seconds",
     number,
     "s",
     kNone,
     {0, 86400, true},
     "",
     "ends the search after this time with the best so far; left out, after a fixed amount of work, so that the result "
     "does not depend on the machine"},
    {"task",
     "energy_front",
     whole_number,
     "",
     "0",
     {0, 100},
     "",
     "so many power limits, falling evenly from what the lights found take, are searched with, too: what each watt "
     "less "
     "costs in error"},
    {"task", "bound", yes_no, "", "false", kAny, "",
     "whether to prove, too, how close as many lights could come at all (seconds to a minute); how close any number "
     "could is always worked out where the goal was not reached"},
    {"task", "object", text, "", kNone, kAny, "",
     "name of the `[[scene.object]]`, a mesh, whose relief shall read (kind `aim` and `highlight`; required there)"},
    {"task",
     "scale_mm",
     number,
     "mm",
     kNone,
     {0, 1e5, true},
     "",
     "size of the relief that counts (kind `aim` and `highlight`): radius of the fits that give its curvature; left "
     "out, from the mesh"},
    {"task",
     "interest",
     number,
     "",
     "0.1",
     {0, 1, true},
     "",
     "share of its surface that counts, the most recessed first (kind `aim` and `highlight`)"},
    {"task", "seen_by", text, "", kNone, kAny, "",
     "name of a `[[camera]]`: only what it sees of the relief counts (kind `aim` and `highlight`); left out, all "
     "sides"},
    {"task", "max_object_lx", number, "lx", kNone, kLux, "",
     "never more than this anywhere on the object (kind `aim` and `highlight`)"},
    {"task", "contrast", text, "", R"("relative")", kAny, "lux, relative",
     "what is made large (only with kind `aim`): the difference in illuminance to what is beside it, in `lux`, "
     "or "
     "`relative` to both, as an eye or a camera sees that adapts; then lights are as bright as limits let them"},
    {"task", "coverage_weight", number, "", "0.25", kWeight, "",
     "what it is worth that every feature has a shadow's edge, beside contrast (kind `aim` and `highlight`)"},
    {"task", "heads", texts, "", kNone, kAny, "",
     "fixtures to aim and dim, by name (`*` and `?`); left out, all that move. One that does not move is only dimmed "
     "(only with kind `aim`, as all keys below)"},
    {"task", "key", text, "", kNone, kAny, "", "the fixture that is the key light"},
    {"task",
     "min_key_to_fill",
     number,
     "",
     "1",
     {0, 1e6},
     "",
     "least of its mean illuminance of the relief over that of all other light; needs `key`"},
    {"task", "max_key_to_fill", number, "", kNone, {0, 1e6, true}, "", "the same, most; needs `key`"},
    {"task", "eyes", texts, "", kNone, kAny, "",
     "points that stand for the eyes of an audience, by name (`*` and `?`): light counts from wherever it comes; "
     "cameras are eyes, too"},
    {"task", "max_eye_lx", number, "lx", kNone, {0, 1e7, true}, "", "most direct light at an eye or a camera"},
    {"task", "base_lx", number, "lx", "0", kLux, "", "illuminance that all of the relief should have"},
    {"task", "base_weight", number, "", "1", kWeight, "", "what that is worth"},
    {"task", "energy_weight", number, "", "0", kWeight, "", "what saving all power would be worth; needs watts"},
    {"task", "travel_weight", number, "", "0.01", kWeight, "", "what a second of movement less is worth"},

    {"mounting", "box_m", box, "m", kNone, kPosition, "",
     "two opposite corners of a box that lights stay in; left out, the scene's bounding box"},
    {"mounting", "surfaces", texts, "", kNone, kAny, "",
     "materials or scene objects that lights hang off, by name; `*` stands for any letters, `?` for one; left "
     "out, anywhere in the air"},
    {"mounting",
     "offset_m",
     span2,
     "m",
     "[0.05, 0.15]",
     {0.001, 1000},
     "",
     "least and largest distance of a light's middle from those surfaces, on both of their sides (only with "
     "`surfaces`)"},
    {"mounting",
     "clearance_m",
     number,
     "m",
     "0.1",
     {0, 1000},
     "",
     "least distance of a light's middle from all (other) surfaces"},
    {"mounting",
     "spacing_m",
     number,
     "m",
     kNone,
     {0.001, 1000},
     "",
     "of the lattice of places that are tried first; lights then move freely. Left out, about 20 000 places in the "
     "air, 5 000 off surfaces; at most 1 000 000"},

    {"limits", "max_level", number, "", "1", kShare, "", "most that any fixture may ever give, of its rated flux"},
    {"limits",
     "open_loop_margin",
     number,
     "",
     "0.25",
     {0, 0.9},
     "",
     "share of each `max_lx` kept free until a meter has confirmed the model there"},
    {"limits",
     "max_watts",
     number,
     "W",
     kNone,
     {0, 1e9},
     "",
     "most electrical power of all fixtures and placed lights together, taken as rated `watts` times level; every "
     "luminaire of theirs must have `watts`"},

    {"control", "fade_s", number, "s", "3", kSeconds, "", "from one look to the next"},
    {"control", "fade_curve", text, "", R"("s-curve")", kAny, "linear, s-curve", "course of a fade"},
    {"control", "correction_fade_s", number, "s", "1", kSeconds, "", "from one correction round to the next"},
    {"control", "settle_s", number, "s", "0.5", kSeconds, "", "wait after a fade before a meter is believed"},
    {"control", "rounds", whole_number, "", "3", {0, 100}, "", "most correction rounds after a change of look"},
    {"control",
     "tolerance",
     number,
     "",
     "0.02",
     {0, 0.5, true},
     "",
     "difference between reading and goal, as a share of the goal, that is left as it is"},
    {"control",
     "gain_min",
     number,
     "",
     "0.6",
     {0, 1, true},
     "",
     "least true output of a fixture, over its rated one, that readings can make the program believe"},
    {"control", "gain_max", number, "", "1.15", {1, 10}, "", "the same, most"},

    {"safe", "level", number, "", "0.1", kShare, "", "of every fixture that has no `safe_level` of its own"},
    {"safe", "hold_s", number, "s", "5", kSeconds, "", "how long the last look is held first"},
    {"safe", "fade_s", number, "s", "3", kSeconds, "", "from there to the safe look"},
    {"safe", "on_meter_loss", yes_no, "", "true", kAny, "",
     "whether a lost meter also leads here; else it only stops the correction"},

    {"daemon", "http_port", whole_number, "", "9620", {1, 65535}, "", "port of the page and the API, on loopback"},

    {"device", "name", name, "", kRequired, kAny, "", "maker and product"},
    {"device", "source", text, "", kRequired, kAny, "", "the public document that the map was made from"},
    {"device", "assumed", texts, "", kNone, kAny, "", "what that document does not say, and what was taken instead"},
    {"device",
     "answer_ms",
     number,
     "ms",
     kNone,
     {1, 5000},
     "",
     "longest time to its answer; left out, `response_timeout_ms` of the bus"},
    {"device",
     "shortest_gap_ms",
     number,
     "ms",
     "0",
     {0, 1000},
     "",
     "how long it must be left alone between two requests, beyond the silence that Modbus itself wants"},
    {"device", "largest_read", whole_number, "", "125", {1, 125}, "", "most registers that one request may read"},
    {"device",
     "largest_write",
     whole_number,
     "",
     "123",
     {1, 123},
     "",
     "most registers that one request may write; 1: it knows function 6 only"},
    {"device", "baud_rates", whole_numbers, "", kNone, kBaudRate, "", "what its line can be set to; left out, any"},
    {"device", "when_data_stops", text, "", R"("hold")", kAny, "hold, dark, watchdog",
     "what its levels do when nobody writes: stay for ever, go out after `stops_after_s` by themselves, or the same "
     "once `[[setup]]` has armed its watchdog"},
    {"device",
     "stops_after_s",
     number,
     "s",
     kNone,
     {0.1, 6553.5},
     "",
     "required with `dark` and `watchdog`; a bus must refresh more than twice as often"},

    {"register", "name", name, "", kRequired, kAny, "", "what it is called; with `count`, a number is put behind it"},
    {"register", "what", text, "", R"("other")", kAny, "other, level, illuminance, temperature, status, setting",
     "what it stands for; a `level` is a share of full output, an `illuminance` is in lux"},
    {"register", "address", whole_number, "", kRequired, kRegister, "",
     "first Modbus register, 0-based (40011 in a manual is holding register 10)"},
    {"register", "kind", text, "", R"("holding")", kAny, "holding, input", "read by function 3 or 4"},
    {"register", "type", text, "", R"("u16")", kAny, "u16, s16, u32, s32, float32", "32 bits take two registers"},
    {"register", "word_order", text, "", R"("high-first")", kAny, "high-first, low-first", "of two registers"},
    {"register", "byte_order", text, "", R"("high-first")", kAny, "high-first, low-first",
     "within each register; Modbus is high-first"},
    {"register",
     "count",
     whole_number,
     "",
     "1",
     {1, 1000},
     "",
     "so many of them, one behind the other: name1, name2 …"},
    {"register", "step", whole_number, "", kNone, {1, 1000}, "", "registers from one to the next; left out, no gap"},
    {"register", "scale", number, "", "1", {0, 1e6, true}, "", "what one count is worth, in `unit`; not of a level"},
    {"register", "unit", text, "", kNone, kAny, "", "of the scaled value; an illuminance is in lx"},
    {"register", "access", text, "", R"("read-write")", kAny, "read-write, read, write",
     "what may be done to it; a level is written, an illuminance read"},
    {"register", "range", span2, "", kNone, kRawRange, "",
     "least and largest value in the register; of a level, required: dark and full"},
    {"register", "power_on", whole_number, "", "0", kRawWhole, "", "its value in the register when power comes"},

    {"setup", "register", text, "", kRequired, kAny, "", "name of a register that can be written"},
    {"setup", "value", whole_number, "", kRequired, kRawWhole, "", "what is written to it, as it stands there"},
};

}  // namespace

std::span<const SectionSpec> sections() { return kSections; }

std::span<const KeySpec> keys() { return kRigKeys; }

}  // namespace luxrig
