// Every key of the schema is really read: changing its value changes the Rig, and leaving it out is the same as
// writing the default that the reference states.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "core/rig/rig_file.h"
#include "core/rig/schema.h"

namespace luxrig {
namespace {

// Each line "key = value  #> other" gives a second value that the key may have in this place; " ; " begins a line that
// the second value needs.
constexpr const char* kKitchenSink = R"(
[rig]
name = "sink"  #> "other"
[scene]
file = "a.obj"  #> "b.obj"
unit = "cm"  #> "ft"
up_axis = "z"  #> "x"
default_reflectance = 0.4  #> [0.1, 0.2, 0.3]
[[scene.reflectance]]
material = "wall*"  #> "floor"
reflectance = 0.6  #> [0.6, 0.6, 0.5]
specular = 0.04  #> 0.05
roughness = 0.2  #> 0.4
[[scene.object]]
name = "vase"  #> "jug"
file = "a.obj"  #> "b.obj"
unit = "mm"  #> "in"
up_axis = "x"  #> "z"
height_m = 0.3  #> 0.4
position_m = [1, 2, 3]  #> [1, 2, 4]
turn_deg = 30  #> -30
reflectance = 0.2  #> 0.3
[[scene.object]]
name = "cup"
file = "a.obj"
[[scene.object]]
name = "bowl"
file = "a.obj"
[[scene.object]]
name = "case"
box_m = [1, 1, 1]
transmittance = 0.9  #> 0.8
[[scene.object]]
name = "plinth"
box_m = [1, 2, 3]  #> [1, 2, 4]
[[luminaire]]
name = "measured"
model = "ies"
file = "a.ies"  #> "b.ies"
near_field = true  #> false
lumens = 500  #> 600
watts = 10  #> 11
cct_k = 3000  #> 4000
[[luminaire]]
name = "spot"
model = "spot"
beam_angle_deg = 20  #> 21
field_angle_deg = 40  #> 41
lumens = 900  #> 901
watts = 12
[[luminaire]]
name = "zoom"
model = "spot"
beam_angle_deg = 20  #> 21
field_angle_deg = 40  #> 41
zoom_deg = [6, 60]  #> [7, 60]
lumens = 900
watts = 9
[[luminaire]]
name = "bulb"  #> "lamp"
model = "isotropic"  #> "spot" ; beam_angle_deg = 20 ; field_angle_deg = 40
lumens = 700
colour = [1, 0.9, 0.8]  #> [1, 0.9, 0.7]
[[luminaire]]
name = "panel"
model = "rectangle"
length_m = 1.2  #> 1.3
width_m = 0.3  #> 0.4
lumens = 900
[[luminaire]]
name = "tube"
model = "cylinder"
diameter_m = 0.04  #> 0.05
length_m = 1.2
lumens = 900
[[luminaire]]
name = "daylight"
model = "isotropic"
lumens = 900
xy = [0.33, 0.34]  #> [0.33, 0.35]
[[luminaire]]
name = "par"
model = "isotropic"
[[luminaire.emitters]]
name = "warm"  #> "amber"
lumens = 100  #> 200
watts = 4  #> 5
cct_k = 2700  #> 3000
[[luminaire.emitters]]
name = "red"
lumens = 50
watts = 5
colour = [1, 0.1, 0]  #> [1, 0.2, 0]
[[luminaire.emitters]]
name = "blue"
lumens = 10
watts = 5
xy = [0.16, 0.07]  #> [0.16, 0.08]
[[bus]]
name = "dmx"  #> "net"
driver = "sacn"  #> "artnet"
priority = 100
[[bus]]
name = "field"
driver = "modbus_tcp"
[[bus]]
name = "can"
driver = "canopen"
[[fixture]]
name = "fixed"  #> "still"
luminaire = "spot"  #> "measured"
position_m = [0, 0, 3]  #> [0, 0.5, 3]
mount_deg = [10, 20, 30]  #> [10, 20, 31]
pan_deg = 5  #> 6
tilt_deg = 7  #> 8
roll_deg = 9  #> 10
bus = "field"  #> "dmx"
unit = 4  #> 5
register = 6  #> 7
full_scale = 255  #> 256
dimmer_curve = "square"  #> "s-curve"
max_level = 0.9  #> 0.8
safe_level = 0.3  #> 0.4
[[fixture]]
name = "head"
luminaire = "spot"
position_m = [1, 0, 3]
aim = "desk"  #> "floor"
bus = "dmx"
universe = 2  #> 3
address = 20  #> 21
slots = ["pan", "tilt", "dimmer"]  #> ["tilt", "pan", "dimmer"]
pan_range_deg = [-180, 180]  #> [-180, 170]
tilt_range_deg = [-100, 100]  #> [-100, 90]
pan_speed_deg_s = 90  #> 91
tilt_speed_deg_s = 80  #> 81
park_pan_deg = 170  #> 160
park_tilt_deg = 80  #> 70
reset_s = 12  #> 13
stage = 2  #> 3
[[fixture]]
name = "zoomer"
luminaire = "zoom"
position_m = [1, 0, 3]
bus = "dmx"
address = 90
slots = ["pan", "tilt", "zoom", "zoom-fine", "dimmer"]  #> ["pan", "tilt", "zoom", "unused", "dimmer"]
zoom_inverted = false  #> true
zoom_speed_deg_s = 20  #> 21
[[fixture]]
name = "mover"
luminaire = "spot"
position_m = [1, 0, 3]
bus = "dmx"
address = 60
axes_bus = "can"  #> "field"
pan_node = 5  #> 7
tilt_node = 6  #> 8
pan_counts_per_degree = 100  #> -100
tilt_counts_per_degree = 200  #> 201
pan_home_deg = -275  #> -276
tilt_home_deg = -140  #> -141
pan_acceleration_deg_s2 = 300  #> 301
tilt_acceleration_deg_s2 = 200  #> 201
[[fixture]]
name = "aimed"
luminaire = "spot"
position_m = [1, 0, 3]
aim_m = [0, 0, 0]  #> [0, 1, 0]
bus = "dmx"
address = 1
slots = ["dimmer", "unused"]  #> ["dimmer"]
[[fixture]]
name = "made"
luminaire = "spot"
position_m = [1, 0, 3]
bus = "dmx"
address = 40
personality = "a.json"  #> "b.json"
mode = "short"  #> "long"
[[fixture]]
name = "product"
luminaire = "spot"
position_m = [1, 0, 3]
bus = "field"
unit = 7
register_map = "a.toml"  #> "b.toml"
channel = 2  #> 1
[[fixture]]
name = "by-name"
luminaire = "spot"
position_m = [1, 0, 3]
bus = "field"
unit = 8
register_map = "a.toml"
output = "out2"  #> "out1"
[[luxmeter]]
name = "meter"  #> "sensor"
point = "desk"  #> "floor"
tolerance = 0.03  #> 0.04
range_lx = 1000  #> 2000
bus = "field"  #> "dmx"
unit = 2  #> 3
register = 5  #> 6
registers = 1  #> 2
register_kind = "input"  #> "holding"
word_order = "low-first"  #> "high-first"
lux_per_count = 0.1  #> 0.2
[[luxmeter]]
name = "free"
position_m = [1, 1, 1]  #> [1, 1, 2]
normal = [1, 0, 0]  #> [0, 1, 0]
bus = "field"
unit = 9
[[luxmeter]]
name = "made"
position_m = [1, 1, 1]
bus = "field"
unit = 10
register_map = "a.toml"  #> "b.toml"
reading = "low"  #> "high"
[[camera]]
name = "front"  #> "side"
position_m = [0, -2, 1]  #> [0, -2, 2]
aim = "desk"  #> "floor"
fov_deg = 30  #> 31
width_px = 640  #> 641
height_px = 480  #> 481
[[camera]]
name = "aside"
position_m = [0, 5, 2]
aim_m = [0, 0, 0]
source = "v4l2"
device = "/dev/video0"  #> "Sony Cam"
format = "Y16"  #> "YUYV"
exposure_ms = 20  #> 21
gain = 3  #> 4
dark_level = 0.02  #> 0.03
response = "srgb"  #> "bt709"
full_scale_cd_m2 = 500  #> 501
[[camera]]
name = "folder"
position_m = [0, 5, 2]
aim_m = [0, 0, 0]
source = "files"
files = "shots"  #> "shots/*.png"
response_file = "a.toml"  #> "b.toml"
[[camera]]
name = "webcam"
position_m = [0, 5, 2]
aim_m = [0, 0, 0]
source = "none"  #> "v4l2"
[[camera]]
name = "top"
position_m = [0, 0, 2]
aim_m = [0, 0, 0]  #> [0, 1, 0]
[[point]]
name = "desk"
position_m = [1, 1, 0.8]  #> [1, 1, 0.9]
normal = [0, 1, 1]  #> [0, 1, 2]
goal_lx = 300  #> 301
goal_xy = [0.4, 0.38]  #> [0.4, 0.39]
weight = 2  #> 3
max_lx = 400  #> 401
[[point]]
name = "floor"
position_m = [0.5, 0, 0]
[[point]]
name = "spare"  #> "third"
position_m = [5, 0, 0]
goal_lx = 100
goal_cct_k = 3000  #> 4000
[points]
file = "a.csv"  #> "b.csv"
[[task]]
name = "look"  #> "other"
kind = "emittance"  #> "placement" ; luminaire = "spot"
max_watts = 100  #> 90
[[task]]
name = "some"
kind = "placement"
luminaire = "spot"  #> "measured"
max_lights = 7  #> 8
error_wanted = 0.02  #> 0.03
improvement = 0.1  #> 0.2
method = "luxrig"  #> "gp16"
aimed = true  #> false
indirect = false  #> true
fixtures = "off"  #> "full"
seconds = 5  #> 6
energy_front = 3  #> 4
bound = true  #> false
[[task]]
name = "four"
kind = "placement"
luminaire = "spot"
lights = 4  #> 5
[[task]]
name = "relief"
kind = "aim"
object = "cup"  #> "bowl"
scale_mm = 4  #> 5
interest = 0.2  #> 0.3
seen_by = "top"  #> "aside"
max_object_lx = 900  #> 800
contrast = "lux"  #> "relative"
coverage_weight = 0.5  #> 0.6
heads = ["head", "aime*"]  #> ["head"]
key = "head"  #> "aimed"
min_key_to_fill = 2  #> 1.5
max_key_to_fill = 8  #> 9
eyes = ["floor"]  #> ["desk"]
max_eye_lx = 30  #> 31
base_lx = 20  #> 21
base_weight = 0.1  #> 0.2
energy_weight = 0.3  #> 0.4
travel_weight = 0.02  #> 0.03
[[task]]
name = "detail"
kind = "highlight"
luminaire = "spot"
object = "cup"
max_lights = 3  #> 4
[mounting]
box_m = [[0, 0, 2], [4, 5, 3]]  #> [[4, 0, 2], [0, 5, 3.5]]
surfaces = ["ceiling*", "plinth"]  #> ["ceiling*", "vase"]
offset_m = [0.1, 0.2]  #> [0.1, 0.3]
clearance_m = 0.3  #> 0.4
spacing_m = 0.25  #> 0.5
[[keep_out]]
name = "stalls"  #> "circle"
box_m = [[0, 0, 0], [4, 5, 1]]  #> [[0, 0, 0], [4, 5, 2]]
heads = ["head", "zoom*"]  #> ["head"]
margin_deg = 3  #> 4
[[keep_out]]
name = "mirror"
centre_m = [1, 2, 3]  #> [1, 2, 4]
radius_m = 0.5  #> 0.6
[limits]
max_level = 0.95  #> 0.9
open_loop_margin = 0.1  #> 0.2
max_watts = 500  #> 400
[control]
fade_s = 4  #> 5
fade_curve = "linear"  #> "s-curve"
correction_fade_s = 2  #> 3
settle_s = 0.7  #> 0.8
rounds = 4  #> 5
tolerance = 0.03  #> 0.04
gain_min = 0.5  #> 0.4
gain_max = 1.3  #> 1.4
[safe]
level = 0.2  #> 0.3
hold_s = 6  #> 7
fade_s = 8  #> 9
on_meter_loss = false  #> true
[startup]
stage_s = 2  #> 3
max_watts_per_s = 500  #> 600
after_loss = true  #> false
[daemon]
http_port = 1234  #> 1235
park_at_end = true  #> false
)";

// The sun's angles and its place and time exclude one another: the second way, in place of the first.
constexpr const char* kSunByAngles = R"([daylight]
sky = "general"
sky_type = 13  #> 14
horizontal_lx = 12000  #> 13000
sun_normal_lx = 70000  #> 71000
sun_azimuth_deg = 150  #> 160
sun_elevation_deg = 40  #> 41
north_deg = 10  #> 11
)";
constexpr const char* kSunByPlace = R"([daylight]
sky = "clear"  #> "overcast"
sun = true  #> false
latitude_deg = 52.5  #> 51
longitude_deg = 13.4  #> 12
time = "2026-06-21T12:00:00+02:00"  #> "2026-06-21T12:30:00+02:00"
north_deg = -90  #> 90
)";

struct Line {
  std::string section, key, text, other;  ///< text: the whole line without its mark; other: second value
};

std::vector<Line> kitchen_sink(const char* daylight) {
  std::vector<Line> lines;
  std::string section, rest = std::string(kKitchenSink) + daylight;
  while (!rest.empty()) {
    std::string text = rest.substr(0, rest.find('\n'));
    rest.erase(0, text.size() + 1);
    Line line;
    if (const auto mark = text.find("  #> "); mark != std::string::npos) {
      line.other = text.substr(mark + 5);
      for (auto at = line.other.find(" ; "); at != std::string::npos; at = line.other.find(" ; ")) {
        line.other.replace(at, 3, "\n");
      }
      text.resize(mark);
    }
    if (text.starts_with('['))
      section = text.substr(text.find_first_not_of('['), text.find(']') - text.find_first_not_of('['));
    line.section = section;
    line.key = text.substr(0, text.find(" = "));
    line.text = text;
    lines.push_back(line);
  }
  return lines;
}

std::string text_of(const Vec3& v) { return fmt::format("({},{},{})", v.x(), v.y(), v.z()); }
template <class T>
std::string text_of(const std::optional<T>& value) {
  if (!value) return "none";
  if constexpr (std::is_same_v<T, Vec3>) {
    return text_of(*value);
  } else {
    return fmt::format("{}", *value);
  }
}
std::string text_of(const std::optional<MeshFile>& mesh) {
  return mesh ? fmt::format("{} {} {}", mesh->path.string(), mesh->metres_per_unit, static_cast<int>(mesh->up_axis))
              : "none";
}

/// Everything in a Rig but places, as text.
std::string dump(const Rig& rig) {
  std::string out;
  const auto add = [&](const auto&... values) { ((out += fmt::format("{} ", values)), ...), out += '\n'; };
  add(rig.name, text_of(rig.scene.mesh), text_of(rig.scene.default_reflectance_rgb));
  for (const auto& r : rig.scene.reflectances) {
    add(r.material_pattern, text_of(r.reflectance_rgb), r.specular, r.roughness);
  }
  for (const auto& o : rig.scene.objects) {
    add(o.name, text_of(o.mesh), text_of(o.box_m), text_of(o.position_world_m), o.turn_rad, text_of(o.height_m),
        text_of(o.reflectance_rgb), text_of(o.transmittance));
  }
  for (const auto& l : rig.luminaires) {
    add(l.name, static_cast<int>(l.model), l.ies_path.string(), l.beam_angle_rad, l.field_angle_rad, l.lumens,
        text_of(l.watts), l.zoom_beam_rad ? l.zoom_beam_rad->first : 0, l.intensity->flux_lm(),
        l.intensity->intensity_cd(Vec3(0.1, 0, -1).normalized()), static_cast<int>(l.shape.kind),
        text_of(l.shape.size_m), text_of(l.colour_rgb), l.emitters.size(), text_of(l.emitter_of));
  }
  for (const auto& b : rig.buses) {
    add(b.name, b.driver, b.options.size());
  }
  for (const auto& f : rig.fixtures) {
    add(f.name, f.luminaire, text_of(f.world_from_mount.translation_m),
        text_of(Vec3(f.world_from_mount.rotation.col(0))), text_of(Vec3(f.world_from_mount.rotation.col(1))),
        text_of(f.aim_world_m), f.joints.pan_rad, f.joints.tilt_rad, f.roll_rad, f.moves, f.range.pan_min_rad,
        f.range.pan_max_rad, f.range.tilt_min_rad, f.range.tilt_max_rad, f.pan_speed_rad_s, f.tilt_speed_rad_s,
        f.zoom_speed_rad_s, f.bus, static_cast<int>(f.dimmer_curve), f.max_level, text_of(f.safe_level),
        f.park ? f.park->pan_rad : -99, f.park ? f.park->tilt_rad : -99, f.stage, f.reset_s);
    if (f.axes) {
      add("axes", f.axes->bus);
      for (const AxisPatch& a : {f.axes->pan, f.axes->tilt})
        add(a.node, a.counts_per_degree, a.home_rad, a.acceleration_rad_s2);
    }
    if (const auto* dmx = std::get_if<DmxPatch>(&f.patch)) {
      add("dmx", dmx->universe, dmx->address);
      for (const DmxSlot& slot : dmx->slots) add(static_cast<int>(slot.use), slot.constant_dmx, slot.travel.at_start);
    } else {
      const auto& modbus = std::get<ModbusPatch>(f.patch);
      add("modbus", modbus.unit, modbus.holding_register, modbus.full_scale_raw, modbus.map != nullptr);
    }
  }
  for (const auto& m : rig.luxmeters) {
    add(m.name, text_of(m.position_world_m), text_of(m.normal_world), text_of(m.point), m.tolerance, m.range_lx, m.bus,
        m.patch.unit, m.patch.input_registers, m.patch.first_register, m.patch.registers, m.patch.low_word_first,
        m.patch.lux_per_count);
  }
  for (const auto& p : rig.points) {
    add(p.name, text_of(p.position_world_m), text_of(p.normal_world), text_of(p.goal_lx), text_of(p.goal_rgb), p.weight,
        text_of(p.max_lx));
  }
  for (const auto& t : rig.tasks) {
    const PlacementSpec& p = t.placement;
    add(t.name, static_cast<int>(t.kind), p.luminaire, text_of(p.lights), p.max_lights, p.error_wanted, p.improvement,
        static_cast<int>(p.method), p.aimed, p.indirect, static_cast<int>(p.fixtures), text_of(p.seconds),
        p.energy_front, p.bound, text_of(t.max_watts));
    const AimSpec& a = t.aim;
    const HighlightSpec& h = t.highlight;
    for (const ReliefSpec& r : {a.relief, h.relief})
      add(r.object, text_of(r.scale_m), r.interest, text_of(r.max_lx), text_of(r.camera), r.relative,
          r.coverage_weight);
    for (const std::size_t head : a.heads) add("head", head);
    for (const std::size_t eye : a.eyes) add("eye", eye);
    add(text_of(a.key), a.min_key_to_fill, text_of(a.max_key_to_fill), text_of(a.max_eye_lx), a.energy_weight,
        a.base_weight, a.travel_weight, a.base_lx, h.luminaire, text_of(h.lights), h.max_lights);
  }
  for (const PictureCamera& c : rig.cameras)
    add(c.name, text_of(c.position_world_m), text_of(c.aim_world_m), c.vertical_fov_rad, c.width_px, c.height_px,
        static_cast<int>(c.taking.source), c.taking.device, c.taking.files.string(), static_cast<int>(c.taking.format),
        text_of(c.taking.exposure_s), text_of(c.taking.gain), c.taking.dark_share, static_cast<int>(c.taking.curve),
        c.taking.curve_file.string(), text_of(c.taking.full_scale_cd_m2));
  const MountingSpec& mounting = rig.mounting;
  if (mounting.box_world_m) add(text_of(Vec3(mounting.box_world_m->min())), text_of(Vec3(mounting.box_world_m->max())));
  for (const auto& surface : mounting.surfaces) add(surface.text);
  add(mounting.offset_min_m, mounting.offset_max_m, mounting.clearance_m, text_of(mounting.spacing_m));
  for (const KeepOut& zone : rig.keep_outs) {
    add(zone.name, text_of(zone.centre_world_m), zone.radius_m, zone.margin_rad);
    if (zone.box_world_m) add(text_of(Vec3(zone.box_world_m->min())), text_of(Vec3(zone.box_world_m->max())));
    for (const std::size_t head : zone.heads) add("kept out", head);
  }
  add(rig.limits.max_level, rig.limits.open_loop_margin, text_of(rig.limits.max_watts));
  const ControlSpec& c = rig.control;
  add(c.fade_s, static_cast<int>(c.fade_curve), c.correction_fade_s, c.settle_s, c.rounds, c.tolerance, c.gain_min,
      c.gain_max);
  if (rig.daylight) {
    const Daylight& d = *rig.daylight;
    add(static_cast<int>(d.sky), d.general_type, d.horizontal_lx, d.sun_normal_lx, text_of(d.towards_sun_world));
  }
  add(rig.safe.level, rig.safe.hold_s, rig.safe.fade_s, rig.safe.on_meter_loss, rig.daemon.http_port,
      rig.daemon.park_at_end, rig.startup.stage_s, text_of(rig.startup.max_watts_per_s), rig.startup.after_loss);
  return out;
}

class KeysRead : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    for (const char* name : {"a", "b"}) {
      std::ofstream(folder_ / (std::string(name) + ".obj")) << "v 0 0 0\n";
      std::ofstream(folder_ / (std::string(name) + ".json"))
          << R"({"$schema": "https://github.com/open-fixture-library/master/schemas/fixture.json", "name": "x",
                 "availableChannels": {"Dimmer": {"capability": {"type": "Intensity"}},
                                       "Mode": {"capability": {"type": "NoFunction"}, "defaultValue": )"
          << (*name == 'a' ? 7 : 8) << R"(}}, "modes": [{"name": "short", "channels": ["Dimmer", "Mode"]},
                            {"name": "long", "channels": ["Mode", "Dimmer"]}]})";
      std::ofstream(folder_ / (std::string(name) + ".toml"))
          << "[device]\nname = \"x\"\nsource = \"y\"\n"
          << "[[register]]\nname = \"out\"\nwhat = \"level\"\naddress = " << (*name == 'a' ? 0 : 10)
          << "\ncount = 2\nrange = [0, 255]\n"
          << "[[register]]\nname = \"low\"\nwhat = \"illuminance\"\naddress = " << (*name == 'a' ? 20 : 30) << "\n"
          << "[[register]]\nname = \"high\"\nwhat = \"illuminance\"\naddress = 40\n";
      std::ofstream(folder_ / (std::string(name) + ".csv")) << "name,x_m,y_m,z_m\n" << name << ",1,2,3\n";
      std::ofstream(folder_ / (std::string(name) + ".ies")) << "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 1 1 2 .1 .1 0\n"
                                                               "1 1 10\n0 45 90\n0\n100 "
                                                            << (*name == 'a' ? 50 : 20) << " 0\n";
    }
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// The sink with some of its lines replaced, as a dump; or its problems.
  std::string read(const std::vector<Line>& lines) {
    std::string text;
    for (const Line& line : lines) text += line.text + "\n";
    const Checked<Rig> rig = parse_rig(text, "sink.toml", folder_);
    if (rig) return dump(*rig);
    std::string problems;
    for (const Problem& problem : rig.error()) problems += problem.text() + "\n";
    return "REFUSED " + problems;
  }

  /// Renaming or repointing something must not only be noticed as a dangling reference.
  static void rename(std::vector<Line>& lines, const Line& renamed) {
    const std::string old = renamed.text.substr(renamed.text.find(" = ") + 3);
    for (Line& line : lines) {
      const bool refers = line.key == "bus" || line.key == "luminaire" || line.key == "point" || line.key == "aim";
      if (refers && line.text.ends_with(" = " + old)) line.text = line.key + " = " + renamed.other;
    }
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("luxrig_keys_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(KeysRead, ChangingAnyKeyChangesTheRig) {
  std::set<std::pair<std::string, std::string>> changed;
  for (const char* daylight : {kSunByAngles, kSunByPlace}) {
    const auto sink = kitchen_sink(daylight);
    const std::string before = read(sink);
    ASSERT_FALSE(before.starts_with("REFUSED")) << before;
    for (std::size_t i = 0; i < sink.size(); ++i) {
      if (sink[i].other.empty()) continue;
      auto lines = sink;
      if (sink[i].key == "name") rename(lines, sink[i]);
      lines[i].text = sink[i].key + " = " + sink[i].other;
      const std::string after = read(lines);
      EXPECT_FALSE(after.starts_with("REFUSED")) << lines[i].text << ": " << after;
      EXPECT_NE(after, before) << "[" << sink[i].section << "] " << lines[i].text << " changes nothing";
      changed.emplace(sink[i].section, sink[i].key);
    }
  }
  for (const KeySpec& key : keys()) {
    if (section_spec(key.section).file != SectionSpec::File::rig) continue;
    EXPECT_TRUE(changed.contains({std::string(key.section), std::string(key.key)}))
        << "the kitchen sink does not try [" << key.section << "] " << key.key;
  }
}

TEST_F(KeysRead, LeavingAKeyOutIsWritingItsDefault) {
  std::set<std::pair<std::string, std::string>> tried;
  for (const char* daylight : {kSunByAngles, kSunByPlace}) {
    const auto sink = kitchen_sink(daylight);
    for (std::size_t i = 0; i < sink.size(); ++i) {
      for (const KeySpec& key : keys()) {
        if (key.section != sink[i].section || key.key != sink[i].key) continue;
        auto without = sink, with = sink;
        without[i].text.clear();
        if (key.fallback == kRequired) {
          EXPECT_TRUE(read(without).starts_with("REFUSED")) << sink[i].section << " " << sink[i].key;
        } else if (key.fallback != kNone) {
          with[i].text = sink[i].key + " = " + std::string(key.fallback);
          const std::string written = read(with);
          if (written.starts_with("REFUSED")) continue;  // a default may not suit the rest here; it must somewhere
          EXPECT_EQ(read(without), written) << "[" << sink[i].section << "] " << with[i].text;
        }
        tried.emplace(key.section, key.key);
      }
    }
  }
  for (const KeySpec& key : keys()) {
    if (section_spec(key.section).file != SectionSpec::File::rig) continue;
    EXPECT_TRUE(tried.contains({std::string(key.section), std::string(key.key)})) << key.section << " " << key.key;
  }
}

}  // namespace
}  // namespace luxrig
