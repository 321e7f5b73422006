// Keys for the room: the rig itself, scene, daylight.
#include "core/rig/schema/key_tables.h"

namespace luxrig::schema {
namespace {

using enum ValueType;

constexpr Bounds kReflectance{0, 0.95};
constexpr Bounds kRoughness{0.05, 1};
constexpr Bounds kOutdoors{0, 200'000, true};  // the sun above the atmosphere gives 127,500 lx
constexpr Bounds kBearing{-360, 360};
constexpr Bounds kQuarterTurn{-90, 90};
constexpr std::string_view kUnits = "m, cm, mm, in, ft";
constexpr std::string_view kAxes = "x, y, z";

constexpr KeySpec kRoomKeys[] = {
    {"rig", "name", name, "", kRequired, kAny, "", R"("reading room")",
     "name of the rig; plans are only applied to the rig they name"},

    {"scene", "file", file, "", kNone, kAny, "", R"("room.obj")", "mesh of the room: OBJ, PLY, STL, glTF, GLB or 3DS"},
    {"scene", "unit", text, "", R"("m")", kAny, kUnits, R"("cm")", "length unit of the mesh file"},
    {"scene", "up_axis", text, "", R"("y")", kAny, kAxes, R"("z")", "axis of the mesh file that points up (glTF: y)"},
    {"scene", "default_reflectance", colour, "", "0.5", kReflectance, "", "0.4",
     "diffuse reflectance where neither a rule nor the mesh file gives one"},

    {"scene.reflectance", "material", text, "", kRequired, kAny, "", R"("wall*")",
     "name of the material; `*` stands for any letters, `?` for one"},
    {"scene.reflectance", "reflectance", colour, "", kRequired, kReflectance, "", "0.6", "diffuse reflectance"},
    {"scene.reflectance", "specular", number, "", "0", kReflectance, "", "0.04",
     "gloss: what a coat over it mirrors at normal incidence (varnish, polished floors 0.04; metals more); 0 is matt"},
    {"scene.reflectance", "roughness", number, "", "0.3", kRoughness, "", "0.2",
     "how much the coat scatters what it mirrors: 0.05 nearly a mirror, 1 nearly matt"},

    {"scene.object", "name", name, "", kRequired, kAny, "", R"("vase")", "name of the object"},
    {"scene.object", "file", file, "", kNone, kAny, "", R"("vase.obj")", "its mesh; either this or `box_m`"},
    {"scene.object", "unit", text, "", R"("m")", kAny, kUnits, R"("mm")", "length unit of the mesh file"},
    {"scene.object", "up_axis", text, "", R"("y")", kAny, kAxes, R"("x")", "axis of the mesh file that points up"},
    {"scene.object", "height_m", number, "m", kNone, kSize, "", "0.3", "scales the mesh evenly to this height"},
    {"scene.object", "box_m", vector3, "m", kNone, kSize, "", "[1.6, 0.8, 0.75]",
     "a box instead of a mesh: width x, depth y, height z"},
    {"scene.object", "position_m", vector3, "m", "[0, 0, 0]", kPosition, "", "[1, 2, 3]",
     "where the middle of its underside stands"},
    {"scene.object", "turn_deg", number, "°", "0", kAngle, "", "30",
     "turn about the vertical, counter-clockwise from above"},
    {"scene.object", "reflectance", colour, "", kNone, kReflectance, "", "0.2",
     "of all of it; left out, the rules and the mesh file's colours apply"},
    {"scene.object",
     "transmittance",
     number,
     "",
     kNone,
     {0, 1, true},
     "",
     "0.9",
     "it is of glass, each of its faces a pane that lets so much through head-on (clear float glass 0.9, coated "
     "museum glass 0.98); what panes reflect is lost"},

    {"daylight", "sky", text, "", kRequired, kAny, "uniform, overcast, clear, general", R"("general")",
     "how its brightness is spread: the same everywhere, CIE overcast, CIE clear, or a type of the CIE general sky"},
    {"daylight",
     "sky_type",
     whole_number,
     "",
     kNone,
     {1, 15},
     "",
     "13",
     "type of ISO 15469 / CIE S 011: 1 to 5 overcast, 6 to 10 partly cloudy, 11 to 15 clear (only with sky `general`, "
     "and required there)"},
    {"daylight", "horizontal_lx", number, "lx", kNone, kOutdoors, "", "12000",
     "what the sky alone gives an open horizontal plane; left out, the mean for the sun's elevation"},
    {"daylight", "sun", yes_no, "", "true", kAny, "", "false", "whether the sun itself shines; else only the sky"},
    {"daylight", "sun_normal_lx", number, "lx", kNone, kOutdoors, "", "70000",
     "what the sun gives a plane that faces it; left out, the mean for its elevation under a clear or partly cloudy "
     "sky, nothing under an overcast one"},
    {"daylight", "sun_azimuth_deg", number, "°", kNone, kBearing, "", "150",
     "where the sun stands, from north over east; with `sun_elevation_deg`"},
    {"daylight", "sun_elevation_deg", number, "°", kNone, kQuarterTurn, "", "40", "its height above the horizon"},
    {"daylight", "latitude_deg", number, "°", kNone, kQuarterTurn, "", "52.5",
     "north positive; with `longitude_deg` and `time`, instead of the sun's angles"},
    {"daylight", "longitude_deg", number, "°", kNone, {-180, 180}, "", "13.4", "east positive"},
    {"daylight", "time", text, "", kNone, kAny, "", R"("2026-06-21T12:00:00+02:00")",
     "date, time and offset from UTC: `2026-06-21T12:00:00+02:00`"},
    {"daylight", "north_deg", number, "°", "0", kAngle, "", "-30",
     "where north lies in the model: turned from +y, counter-clockwise from above (-90: north is +x)"},
};

}  // namespace

std::span<const KeySpec> room_keys() { return kRoomKeys; }

}  // namespace luxrig::schema
