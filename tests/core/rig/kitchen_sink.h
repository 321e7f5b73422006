#pragma once
/// A file with every key of the schema, and a second value for each. Both values come from the schema's examples. This
/// file adds the facts that a row of the schema cannot hold: valid combinations of keys, and the names they refer to.

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/check.h"
#include "core/rig/schema.h"

namespace luxrig::kitchen_sink {

// An outline. Its lines hold parts separated by "; ". A bare key has its example as value; `rest` stands for every key
// of the section that no entry here names. After #> stands the second value, with further parts it needs after " & ". A
// bare key has a second value anyway, unless an earlier entry has one. Sections that are absent here have one entry
// with all their keys.
inline constexpr const char* kRig = R"(
[[scene.object]]
name; file; rest
[[scene.object]]
name = "cup"; file
[[scene.object]]
name = "case"; box_m = [1, 1, 1]; transmittance
[[scene.object]]
name = "plinth"; box_m
[[luminaire]]
name = "measured"; model = "ies"; file; near_field; lumens; watts; cct_k
[[luminaire]]
name = "pendant"; model = "ies"; file = "two_heads.gldf"; file_variant #> "v15"; file_emitter #> "up"
[[luminaire]]
name; model = "spot"; beam_angle_deg; field_angle_deg; lumens; watts; rest
[[luminaire]]
name = "zoom"; model = "spot"; beam_angle_deg; field_angle_deg; zoom_deg; lumens; watts
[[luminaire]]
name = "bulb"; model = "isotropic" #> "spot" & beam_angle_deg = 20 & field_angle_deg = 40; lumens; colour
[[luminaire]]
name = "downlight"; model = "cosine"; exponent; lumens
[[luminaire]]
name = "panel"; model = "rectangle"; length_m; width_m; lumens
[[luminaire]]
name = "tube"; model = "cylinder"; diameter_m; length_m; lumens
[[luminaire]]
name = "daylight"; model = "isotropic"; lumens; xy
[[luminaire]]
name = "par"; model = "isotropic"
[[luminaire.emitters]]
name; lumens; watts; cct_k; rest
[[luminaire.emitters]]
name = "red"; lumens; watts; colour
[[luminaire.emitters]]
name = "blue"; lumens; watts; xy
[[luminaire]]
name = "tunable"; model = "isotropic"
[[luminaire.emitters]]
name = "warm white"; lumens; watts
[[luminaire.emitters]]
name = "cool white"; lumens; watts
[daemon]
listen #> "::1"; rest
[[bus]]
name; driver; rest; priority = 100
[[bus]]
name = "field"; driver = "modbus_tcp"
[[bus]]
name = "can"; driver = "canopen"
[[fixture]]
name; luminaire #> "measured"; position_m; mount_deg; pan_deg; tilt_deg; roll_deg; bus = "field" #> "dmx"
unit; register; full_scale; dimmer_curve; max_level; safe_level
[[fixture]]
name = "head-1"; luminaire; position_m; aim #> "floor"; bus; universe; address; slots #> ["tilt", "pan", "dimmer"]; rest
[[fixture]]
name = "head-2"; luminaire; position_m; aim_m; bus; address = 1; slots = ["dimmer", "unused"] #> ["dimmer"]
[[fixture]]
name = "zoomer"; luminaire = "zoom"; position_m; bus; address = 90; zoom_inverted; zoom_speed_deg_s
slots = ["pan", "tilt", "zoom", "zoom-fine", "dimmer"] #> ["pan", "tilt", "zoom", "unused", "dimmer"]
[[fixture]]
name = "mover"; luminaire; position_m; bus; address = 60; axes_bus #> "field"; pan_node; tilt_node
pan_counts_per_degree; tilt_counts_per_degree; pan_home_deg; tilt_home_deg
pan_acceleration_deg_s2; tilt_acceleration_deg_s2
[[fixture]]
name = "made"; luminaire; position_m; bus; address = 40; personality; mode #> "long"; dimmer #> "Mode"
[[fixture]]
name = "product"; luminaire; position_m; bus = "field"; unit = 7; register_map; channel
[[fixture]]
name = "by-name"; luminaire; position_m; bus = "field"; unit = 8; register_map; output #> "out2"
[[fixture]]
name = "contactor"; luminaire; position_m; bus; address = 100; switched; max_level = 0
[[fixture]]
name = "wash"; luminaire = "tunable"; position_m; bus; address = 200; slots = ["emitter:warm white", "emitter:cool white"]
[[luxmeter]]
name; point #> "floor"; bus #> "dmx"; unit; register; rest
[[luxmeter]]
name = "free"; position_m; normal; bus; unit = 9
[[luxmeter]]
name = "made"; position_m; bus; unit = 10; register_map; reading #> "high"
[[camera]]
name; position_m; aim #> "floor"; rest
[[camera]]
name = "aside"; position_m = [0, 5, 2]; aim_m; source = "v4l2"; device; format; exposure_ms; gain
dark_level; response; full_scale_cd_m2
[[camera]]
name = "folder"; position_m = [0, 5, 2]; aim_m; source = "files"; files; response_file
[[camera]]
name = "webcam"; position_m = [0, 5, 2]; aim_m; source = "none" #> "v4l2"
[[point]]
name; position_m; goal_lx; goal_xy; rest
[[point]]
name = "floor"; position_m = [0.5, 0, 0]
[[point]]
name = "spare"; position_m = [5, 0, 0]; goal_lx; goal_cct_k; goal_tolerance
[[surface_goal]]
name; strokes; goal_xy; rest
[[surface_goal]]
name = "wall"; strokes = "wall.json"; goal_cct_k
[[task]]
name; kind #> "placement" & luminaire = "track spot"; max_watts
[[task]]
name = "some"; kind = "placement"; luminaire #> "measured"; max_lights; rest
[[task]]
name = "four"; kind = "placement"; luminaire; lights
[[task]]
name = "relief"; kind = "aim"; object #> "cup"; scale_mm; interest; seen_by #> "aside"; max_object_lx; contrast
coverage_weight; heads #> ["head-1"]; key #> "head-2"; min_key_to_fill; max_key_to_fill; eyes #> ["table top"]
max_eye_lx; base_lx; base_weight; energy_weight; travel_weight
[[task]]
name = "detail"; kind = "highlight"; luminaire; object; max_lights; objective
[[task]]
name = "held"; kind = "directions"; object; distance_m; seen_by = "front"; set_up
[[task]]
name = "lit"; kind = "highlight"; luminaire; object; objective = "seen"; role = "key"; ratio
fine_weight; form_weight; lit_weight; edge_weight; even_weight; shadow_weight; max_clipped
[[task]]
name = "beside"; kind = "aim"; object; objective = "seen"; role #> "fill"; heads = ["wash"]; cct_k
[[keep_out]]
name; box_m; heads #> ["zoomer"]; rest
[[keep_out]]
name = "mirror"; centre_m; radius_m
)";
// The sun's angles exclude its place and time: one of these two follows the rest.
inline constexpr const char* kSunByAngles = R"([daylight]
sky = "general"; sky_type; horizontal_lx; sun_normal_lx; sun_azimuth_deg; sun_elevation_deg; north_deg
)";
inline constexpr const char* kSunByPlace = R"([daylight]
sky = "clear" #> "overcast"; sun; latitude_deg; longitude_deg; time #> "2026-06-21T12:30:00+02:00"; north_deg
)";

inline constexpr const char* kRegisterMap = R"([device]
when_data_stops #> "dark"; rest
[[register]]
name; address; kind #> "holding"; rest
[[register]]
name = "arm"; address = 100; access #> "write"
[[register]]
name = "other"; address = 200
[[setup]]
register #> "other"; value
)";

struct Line {
  std::string section, key, text, other;  ///< text: the whole line; other: second value, empty if there is none
};

inline std::vector<std::string> split(const std::string& text, const std::string& between) {
  std::vector<std::string> parts;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t end = std::min(text.find(between, from), text.size());
    if (end > from) parts.push_back(text.substr(from, end - from));
    from = end + between.size();
  }
  return parts;
}

/// A value as valid as the example: the next choice, a slightly larger number, a longer text.
inline std::string other_than_example(const KeySpec& spec) {
  std::string value(spec.example);
  const std::vector<std::string_view> choices = choices_of(spec);
  if (!choices.empty()) {
    const auto at = std::find(choices.begin(), choices.end(), value.substr(1, value.size() - 2));
    return "\"" + std::string(choices.end() - at > 1 ? at[1] : choices.front()) + "\"";
  }
  if (spec.type == ValueType::yes_no) return value == "true" ? "false" : "true";
  if (spec.type == ValueType::file) return "\"other-" + value.substr(1);
  if (const auto quote = value.rfind('"'); quote != std::string::npos) return value.insert(quote, " 2");
  const std::size_t end = value.find_last_of("0123456789") + 1;
  const std::size_t begin = value.find_last_not_of("0123456789.-", end - 1) + 1;  // npos + 1 is 0
  const std::string last = value.substr(begin, end - begin);
  const bool whole = last.find('.') == std::string::npos;
  return value.replace(begin, end - begin, whole ? std::to_string(std::stol(last) + 1) : last + "1");
}

inline std::vector<Line> lines(const std::string& outline, SectionSpec::File file) {
  std::vector<std::pair<std::string, std::vector<std::string>>> entries;  // section, parts
  std::set<std::pair<std::string, std::string>> named;
  for (const std::string& text : split(outline, "\n")) {
    if (text.starts_with('[')) {
      const std::size_t from = text.find_first_not_of('[');
      entries.push_back({text.substr(from, text.find(']') - from), {}});
      continue;
    }
    for (const std::string& part : split(text, "; ")) {
      named.emplace(entries.back().first, part.substr(0, part.find(' ')));
      entries.back().second.push_back(part);
    }
  }
  for (const SectionSpec& section : sections()) {
    const auto is_it = [&](const auto& entry) { return entry.first == section.name; };
    if (section.file == file && std::none_of(entries.begin(), entries.end(), is_it))
      entries.push_back({std::string(section.name), {"rest"}});
  }

  std::vector<Line> found;
  std::set<std::pair<std::string, std::string>> varied;
  for (const auto& [section, parts] : entries) {
    found.push_back({section, "", heading_of(section_spec(section)), ""});
    const std::span<const KeySpec> keys = keys_of(section);
    std::vector<std::string> all;
    for (const std::string& part : parts) {
      if (part != "rest") {
        all.push_back(part);
        continue;
      }
      for (const KeySpec& spec : keys)
        if (!named.contains(std::pair(section, std::string(spec.key)))) all.emplace_back(spec.key);
    }
    for (const std::string& part : all) {
      const std::vector<std::string> values = split(part, " #> ");
      Line line{section, part.substr(0, part.find(' ')), values[0], values.size() > 1 ? values[1] : ""};
      if (line.text == line.key) {
        const auto spec =
            std::find_if(keys.begin(), keys.end(), [&](const KeySpec& key) { return key.key == line.key; });
        LUXRIG_CHECK(spec != keys.end(), "no key {} in section {}", line.key, section);
        line.text += " = " + std::string(spec->example);
        if (line.other.empty() && !varied.contains({section, line.key})) line.other = other_than_example(*spec);
      }
      if (!line.other.empty()) varied.emplace(section, line.key);
      for (auto at = line.other.find(" & "); at != std::string::npos; at = line.other.find(" & "))
        line.other.replace(at, 3, "\n");
      found.push_back(std::move(line));
    }
  }
  return found;
}

}  // namespace luxrig::kitchen_sink
