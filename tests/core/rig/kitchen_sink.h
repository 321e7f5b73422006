#pragma once
/// A rig file with every key there is, and for each a second value.

#include <string>
#include <vector>

namespace luxrig::kitchen_sink {

// Each line "key = value  #> other" gives a second value that the key may have in this place; " ; " begins a line that
// the second value needs.
inline constexpr const char* kKitchenSink = R"(
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
name = "pendant"
model = "ies"
file = "two_heads.gldf"
file_variant = "v10"  #> "v15"
file_emitter = "down"  #> "up"
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
name = "downlight"
model = "cosine"
exponent = 4  #> 5
lumens = 900
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
safe_level = 0.4  #> 0.5
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
dimmer = "Dimmer"  #> "Mode"
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
[[fixture]]
name = "contactor"
luminaire = "spot"
position_m = [1, 0, 3]
bus = "dmx"
address = 100
switched = true  #> false
max_level = 0
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
goal_tolerance = 0.06  #> 0.07
gain_min = 0.5  #> 0.4
gain_max = 1.3  #> 1.4
[safe]
level = 0.2  #> 0.3
hold_s = 6  #> 7
fade_s = 8  #> 9
scope = "all"  #> "rest-stays"
on_meter_loss = true  #> false
[startup]
stage_s = 2  #> 3
max_watts_per_s = 500  #> 600
after_loss = true  #> false
[daemon]
http_port = 1234  #> 1235
park_at_end = true  #> false
)";

// The sun's angles and its place and time exclude one another: one of the two follows the rest.
inline constexpr const char* kSunByAngles = R"([daylight]
sky = "general"
sky_type = 13  #> 14
horizontal_lx = 12000  #> 13000
sun_normal_lx = 70000  #> 71000
sun_azimuth_deg = 150  #> 160
sun_elevation_deg = 40  #> 41
north_deg = 10  #> 11
)";
inline constexpr const char* kSunByPlace = R"([daylight]
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

inline std::vector<Line> lines(const char* daylight) {
  std::vector<Line> found;
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
    found.push_back(line);
  }
  return found;
}

}  // namespace luxrig::kitchen_sink
