// Tasks that bring out the relief of an object: aim, highlight, directions.
#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <numeric>

#include "core/photometry/light_colour.h"
#include "core/rig/housing.h"
#include "core/rig/reading/rig_reader.h"
#include "core/text/nearest.h"

namespace luxrig {

std::vector<std::size_t> RigReader::read_patterns(Section& s, std::string_view key,
                                                  const std::vector<std::string_view>& names, std::string_view what) {
  std::vector<std::pair<std::string, FilePosition>> patterns;
  s.read_texts(key, patterns);
  std::vector<std::size_t> found;
  for (const auto& [pattern, in_file] : patterns) {
    const std::size_t before = found.size();
    for (std::size_t i = 0; i < names.size(); ++i)
      if (fnmatch(pattern.c_str(), std::string(names[i]).c_str(), 0) == 0) found.push_back(i);
    if (found.size() == before)
      problems.add(in_file, fmt::format("{} {} fits no {}", key, in_quotes(pattern), what),
                   mend_for_unknown(pattern, names, fmt::format("add a [[{}]] of that name", what)));
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

void RigReader::read_relief(Section& s, ReliefSpec& relief) {
  if (!s.has("object")) s.require("object", "the mesh whose relief shall read");
  if (const auto object = objects.read_reference(s, "object")) {
    relief.object = *object;
    if (*object < rig.scene.objects.size() && rig.scene.objects[*object].transmittance)
      problems.add(s.place_of("object"),
                   fmt::format("scene object {} is of glass: light finds no relief on it",
                               in_quotes(rig.scene.objects[*object].name)),
                   "name an object without transmittance");
    else if (*object < rig.scene.objects.size() && !rig.scene.objects[*object].mesh)
      problems.add(
          s.place_of("object"),
          fmt::format("scene object {} is a box: it has no relief", in_quotes(rig.scene.objects[*object].name)),
          "name an object that is a mesh file");
  }
  relief.camera = cameras.read_reference(s, "seen_by");
  double scale_mm = 0;
  if (s.read("scale_mm", scale_mm)) relief.scale_m = scale_mm / 1000;
  s.read("interest", relief.interest);
  s.read("max_object_lx", relief.max_lx);
  if (relief.max_lx && !(*relief.max_lx > 0))
    problems.add(s.place_of("max_object_lx"), "max_object_lx of 0 leaves nothing to light", "give it some lux");
  s.read("coverage_weight", relief.coverage_weight);
  s.read_choice("objective", relief.seen);
  s.read("fine_weight", relief.weights.fine);
  s.read("form_weight", relief.weights.form);
  s.read("lit_weight", relief.weights.lit);
  s.read("edge_weight", relief.weights.edge);
  s.read("even_weight", relief.weights.even);
  s.read("shadow_weight", relief.weights.shadows);
  s.read("max_clipped", relief.weights.max_clipped);
  read_role(s, relief);
}

void RigReader::read_role(Section& s, ReliefSpec& relief) {
  s.read_choice("role", relief.role);
  s.read("ratio", relief.ratio);
  if (relief.role == LightRole::any)
    s.refuse("ratio", "ratio has no effect without a role that has one",
             "add role = \"key\", \"fill\", \"rim\" or \"background\"");
  s.read_choice("set_up", relief.set_up);
  const bool needs_camera = relief.role == LightRole::rim || relief.role == LightRole::background;
  if (needs_camera && !s.has("seen_by"))
    s.refuse("role", fmt::format("role \"{}\" has no meaning without a camera", name_of(relief.role)),
             "add seen_by = \"…\"");
  if (relief.set_up != SetUp::none && !s.has("seen_by"))
    s.refuse("set_up", "set_up has no meaning without a camera", "add seen_by = \"…\"");
  if (relief.set_up != SetUp::none && relief.role != LightRole::any && relief.role != LightRole::key)
    s.refuse("set_up", fmt::format("set_up is the key light's, and the role is \"{}\"", name_of(relief.role)),
             "remove it, or role");
}

void RigReader::read_highlight(Section& s, HighlightSpec& highlight) {
  read_placed(s, TaskKind::highlight, highlight.luminaire, highlight.lights, highlight.max_lights);
  read_relief(s, highlight.relief);
  refuse_roles_unseen(s, highlight.relief);
  refuse_other_numbers(s, highlight.relief, highlight.lights);
}

void RigReader::refuse_roles_unseen(Section& s, const ReliefSpec& relief) {
  if (relief.seen) return;
  for (const char* key : {"role", "set_up", "fine_weight", "form_weight", "lit_weight", "edge_weight", "even_weight",
                          "shadow_weight", "max_clipped"})
    s.refuse(key, fmt::format("{} has no effect with objective = \"thesis\"", key), "add objective = \"seen\"");
}

void RigReader::refuse_other_numbers(Section& s, const ReliefSpec& relief, const std::optional<int>& lights) {
  if (relief.set_up == SetUp::none) return;
  const int of_set_up = relief.set_up == SetUp::copy ? 2 : 1;
  if (lights && *lights != of_set_up)
    s.refuse(
        "lights",
        fmt::format("set_up \"{}\" is of {} light{}", name_of(relief.set_up), of_set_up, of_set_up == 1 ? "" : "s"),
        fmt::format("write lights = {}, or remove it", of_set_up));
  s.refuse(
      "max_lights",
      fmt::format("max_lights has no effect with set_up: it is of {} light{}", of_set_up, of_set_up == 1 ? "" : "s"),
      "remove it");
}

void RigReader::read_directions(Section& s, DirectionsSpec& directions) {
  read_number_of_lights(s, directions.lights, directions.max_lights);
  read_relief(s, directions.relief);
  refuse_other_numbers(s, directions.relief, directions.lights);
  s.read("distance_m", directions.distance_m);
}

void RigReader::read_aim_task(Section& s, AimSpec& aim) {
  read_relief(s, aim.relief);
  s.read_choice("contrast", aim.relief.relative);
  refuse_roles_unseen(s, aim.relief);
  if (aim.relief.role != LightRole::any || aim.relief.set_up != SetUp::none)
    s.refuse("key", "key has no effect with role or set_up: they say what this task's lights are",
             "remove it, and write a task for each role");
  if (aim.relief.seen)
    s.refuse("contrast", "contrast has no effect with objective = \"seen\"", "remove it, or objective");
  std::vector<std::string_view> fixture_names, point_names;
  std::vector<std::string> head_names;
  NameIndex heads("fixture");
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    head_names.push_back(housing_name(rig, f));
    if (!heads.find(head_names[f])) heads.add(head_names[f], f, rig.fixtures[f].in_file, problems);
  }
  fixture_names.assign(head_names.begin(), head_names.end());
  for (const Point& point : rig.points) point_names.push_back(point.name);
  if (s.has("heads")) {
    aim.heads = read_patterns(s, "heads", fixture_names, "fixture");
  } else {
    for (std::size_t f = 0; f < rig.fixtures.size(); ++f)
      if (rig.fixtures[f].moves) aim.heads.push_back(f);
    if (aim.heads.empty() && problems.empty())
      problems.add(s.in_file(), "there is nothing to aim: no fixture has pan and tilt",
                   "give a fixture pan and tilt slots, or name the heads that shall at least be dimmed");
  }
  for (std::size_t& head : aim.heads) head = rig.fixtures[head].housing.value_or(head);
  aim.heads.erase(std::unique(aim.heads.begin(), aim.heads.end()), aim.heads.end());
  for (const std::size_t head : aim.heads)
    if (rig.fixtures[head].switched)
      problems.add(s.has("heads") ? s.place_of("heads") : s.in_file(),
                   fmt::format("fixture {} is on or off, and an aim sets levels", in_quotes(rig.fixtures[head].name)),
                   "name the other heads as heads = […], or put its lamp on a dimmer");
  double cct_k = 0;
  if (s.read("cct_k", cct_k)) aim.relief.light_rgb = rgb_of_cct(cct_k);
  if (std::none_of(aim.heads.begin(), aim.heads.end(), [&](std::size_t head) { return rig.fixtures[head].housing; }))
    s.refuse("cct_k", "cct_k has no effect: no head of this task has emitters to mix light of",
             "remove it, or name heads that have some");
  if ((aim.key = heads.read_reference(s, "key")) &&
      std::find(aim.heads.begin(), aim.heads.end(), *aim.key) == aim.heads.end())
    problems.add(s.place_of("key"), "the key light is none of the heads", "name one of them");
  s.read("min_key_to_fill", aim.min_key_to_fill);
  s.read("max_key_to_fill", aim.max_key_to_fill);
  if (!s.has("key"))
    for (const char* key : {"min_key_to_fill", "max_key_to_fill"})
      s.refuse(key, fmt::format("{} has no effect without a key light", key), "add key = …");
  if (aim.max_key_to_fill && *aim.max_key_to_fill < aim.min_key_to_fill)
    problems.add(
        s.place_of("max_key_to_fill"),
        fmt::format("max_key_to_fill {:g} is below min_key_to_fill {:g}", *aim.max_key_to_fill, aim.min_key_to_fill),
        "raise it, or lower that");
  aim.eyes = read_patterns(s, "eyes", point_names, "point");
  s.read("max_eye_lx", aim.max_eye_lx);
  if (aim.max_eye_lx && aim.eyes.empty() && rig.cameras.empty())
    s.refuse("max_eye_lx", "max_eye_lx has no effect: there are no eyes and no camera", "add eyes = [\"…\"]");
  if (!s.has("max_eye_lx")) s.refuse("eyes", "eyes have no effect without a limit", "add max_eye_lx");
  s.read("base_lx", aim.base_lx);
  s.read("base_weight", aim.base_weight);
  s.read("energy_weight", aim.energy_weight);
  s.read("travel_weight", aim.travel_weight);
}

}  // namespace luxrig
