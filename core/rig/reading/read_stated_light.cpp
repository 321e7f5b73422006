#include <fmt/format.h>

#include <cmath>

#include "core/photometry/light_colour.h"
#include "core/rig/personality/personality_file.h"
#include "core/rig/reading/rig_reader.h"
#include "core/rig/reading/stated_light.h"

namespace luxrig {
namespace {

/// Empty if absent or not text; that is reported when the fixture is read.
std::string text_member(const NodeTable& table, std::string_view key) {
  const Member* member = find(table, key);
  const auto* text = member ? std::get_if<std::string>(&member->node.value) : nullptr;
  return text ? *text : std::string();
}

const PersonalityMode* mode_named(const Personality& personality, const std::string& name) {
  if (name.empty()) return personality.modes.size() == 1 ? &personality.modes.front() : nullptr;
  for (const PersonalityMode& mode : personality.modes)
    if (mode.name == name) return &mode;
  return nullptr;
}

bool differ(double a, double b) { return std::abs(a - b) > 1e-3 * std::max(std::abs(a), std::abs(b)); }

}  // namespace

bool states_lumens(const BeamGeometry& light) { return light.lumens > 0 && light.lumens <= 1e8; }
bool states_spot(const BeamGeometry& light) {
  return light.beam_angle_deg > 0 && light.field_angle_deg > light.beam_angle_deg && light.field_angle_deg < 180;
}
bool states_cct(const BeamGeometry& light) { return light.cct_k >= 1667 && light.cct_k <= 25000; }
bool states_watts(const BeamGeometry& light) { return light.power_w > 0 && light.power_w <= 1e6; }

StatedLight RigReader::light_stated_for(const std::string& luminaire) {
  const Member* member = find(root, "fixture");
  const auto* list = member ? std::get_if<NodeList>(&member->node.value) : nullptr;
  if (!list || luminaire.empty()) return {};
  for (const Node& node : *list) {
    const auto* table = std::get_if<NodeTable>(&node.value);
    if (!table || text_member(*table, "luminaire") != luminaire) continue;
    const std::filesystem::path path = folder / text_member(*table, "personality");
    std::error_code error;
    if (path.extension() == ".json" || !std::filesystem::is_regular_file(path, error)) continue;  // OFL states no light
    const std::shared_ptr<const Personality> personality = personality_at(path);
    const PersonalityMode* mode = personality ? mode_named(*personality, text_member(*table, "mode")) : nullptr;
    if (mode) return {light_of_mode(*mode), text_member(*table, "name"), path.filename().string(), false, {}};
  }
  return {};
}

void RigReader::take_stated_light(Section& s, StatedLight& stated, Luminaire& luminaire) {
  if (stated.file.empty()) return;
  const BeamGeometry& light = stated.light;
  std::string taken, kept;
  const auto add = [](std::string& list, const std::string& what) { list += (list.empty() ? "" : ", ") + what; };
  const bool own_emitters = s.has("emitters");
  if (states_lumens(light) && luminaire.model != LuminaireModel::ies && !own_emitters) {
    double own = 0;
    if (!s.has("lumens")) {
      luminaire.lumens = light.lumens;
      add(taken, fmt::format("{:g} lm", light.lumens));
    } else if (s.read("lumens", own) && differ(own, light.lumens)) {
      add(kept, fmt::format("{:g} lm (the rig file: {:g})", light.lumens, own));
    }
  }
  if (luminaire.model == LuminaireModel::spot && states_spot(light)) {
    double beam_rad = 0;
    if (!s.has("beam_angle_deg") && !s.has("field_angle_deg")) {
      luminaire.beam_angle_rad = rad_from_deg(light.beam_angle_deg);
      luminaire.field_angle_rad = rad_from_deg(light.field_angle_deg);
      add(taken, fmt::format("a beam of {:g}° in a field of {:g}°", light.beam_angle_deg, light.field_angle_deg));
    } else if (s.read_deg("beam_angle_deg", beam_rad) && differ(deg_from_rad(beam_rad), light.beam_angle_deg)) {
      add(kept, fmt::format("a beam of {:g}° (the rig file: {:g})", light.beam_angle_deg, deg_from_rad(beam_rad)));
    }
  }
  if (states_cct(light) && !own_emitters && !s.has("cct_k") && !s.has("xy") && !s.has("colour")) {
    luminaire.colour_rgb = rgb_of_cct(light.cct_k);
    add(taken, fmt::format("{:g} K", light.cct_k));
  }
  if (states_watts(light) && !own_emitters && !s.has("watts")) {
    luminaire.watts = light.power_w;
    add(taken, fmt::format("{:g} W", light.power_w));
  }
  stated.used = !taken.empty();
  // The format's defaults, used when a maker fills in nothing (DIN SPEC 15800, table of <Beam>).
  const bool defaults = light.lumens == 10000 && light.beam_angle_deg == 25 && light.field_angle_deg == 25;
  if (!taken.empty())
    stated.told.push_back(fmt::format("its light from its file: {}{}", taken,
                                      defaults ? "; these are the format's own defaults, so check them" : ""));
  if (!kept.empty()) stated.told.push_back(fmt::format("its file states otherwise: {}; the rig file holds", kept));
}

void RigReader::check_stated_light(const Section& s, const Fixture& fixture, const PersonalityMode& mode) {
  const auto at = stated_lights.find(fixture.luminaire);
  if (at == stated_lights.end() || !at->second.used) return;
  const BeamGeometry own = light_of_mode(mode), &taken = at->second.light;
  if (!differ(own.lumens, taken.lumens) && !differ(own.beam_angle_deg, taken.beam_angle_deg) &&
      !differ(own.field_angle_deg, taken.field_angle_deg) && !differ(own.cct_k, taken.cct_k))
    return;
  problems.add(
      s.place_of("luminaire"),
      fmt::format("its file states {:g} lm and a beam of {:g}°, and its luminaire has the {:g} lm and {:g}° "
                  "that the file of {} states",
                  own.lumens, own.beam_angle_deg, taken.lumens, taken.beam_angle_deg, in_quotes(at->second.fixture)),
      "give each its own luminaire, or write lumens, beam_angle_deg and field_angle_deg into this one");
}

}  // namespace luxrig
