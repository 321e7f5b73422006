#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/rig/reading/rig_reader.h"

namespace luxrig {
namespace {

/// Keys of some kinds only.
struct KindKeys {
  std::vector<TaskKind> kinds;
  std::vector<const char*> keys;
};
const KindKeys kKeysOfKinds[] = {
    {{TaskKind::placement, TaskKind::highlight}, {"luminaire"}},
    {{TaskKind::placement, TaskKind::highlight, TaskKind::directions}, {"lights", "max_lights"}},
    {{TaskKind::placement},
     {"error_wanted", "improvement", "method", "indirect", "fixtures", "seconds", "aimed", "energy_front", "bound"}},
    {{TaskKind::aim, TaskKind::highlight, TaskKind::directions},
     {"object", "scale_mm", "interest", "seen_by", "set_up"}},
    {{TaskKind::aim, TaskKind::highlight},
     {"max_object_lx", "coverage_weight", "objective", "role", "ratio", "fine_weight", "form_weight", "lit_weight",
      "edge_weight", "even_weight", "shadow_weight", "max_clipped"}},
    {{TaskKind::directions}, {"distance_m"}},
    {{TaskKind::aim},
     {"contrast", "heads", "key", "min_key_to_fill", "max_key_to_fill", "eyes", "max_eye_lx", "cct_k", "base_lx",
      "base_weight", "energy_weight", "travel_weight"}},
};

void refuse_keys_of_other_kinds(Section& s, TaskKind kind) {
  for (const KindKeys& of : kKeysOfKinds) {
    if (std::find(of.kinds.begin(), of.kinds.end(), kind) != of.kinds.end()) continue;
    std::string kinds;
    for (const TaskKind other : of.kinds) kinds += fmt::format("{}\"{}\"", kinds.empty() ? "" : " or ", name_of(other));
    for (const char* key : of.keys)
      s.refuse(key, fmt::format("{} has no effect: only with kind = {}", key, kinds), "remove it, or change the kind");
  }
}

}  // namespace

void RigReader::read_placed(Section& s, TaskKind kind, std::size_t& luminaire, std::optional<int>& lights,
                            int& max_lights) {
  if (const auto index = luminaires.read_reference(s, "luminaire")) luminaire = *index;
  if (!s.has("luminaire")) s.require("luminaire", fmt::format("which kind = \"{}\" needs", name_of(kind)));
  read_number_of_lights(s, lights, max_lights);
}

void RigReader::read_number_of_lights(Section& s, std::optional<int>& lights, int& max_lights) {
  s.read("lights", lights);
  if (s.has("lights")) {
    for (const char* key : {"max_lights", "improvement"})
      s.refuse(key, fmt::format("{} has no effect when the number of lights is given", key), "remove it, or lights");
  }
  s.read("max_lights", max_lights);
}

void RigReader::read_placement(Section& s, PlacementSpec& placement) {
  read_placed(s, TaskKind::placement, placement.luminaire, placement.lights, placement.max_lights);
  s.read("error_wanted", placement.error_wanted);
  s.read("improvement", placement.improvement);
  if (s.read_choice("method", placement.method) && !s.has("lights") && placement.method == PlacementSearch::gpk15)
    s.refuse("method", fmt::format("{} does not choose how many lights", name_of(placement.method)),
             "add lights = N, or choose another method");
  s.read("aimed", placement.aimed);
  s.read("indirect", placement.indirect);
  s.read_choice("fixtures", placement.fixtures);
  s.read("seconds", placement.seconds);
  s.read("energy_front", placement.energy_front);
  s.read("bound", placement.bound);
  if (std::none_of(rig.points.begin(), rig.points.end(), [](const Point& p) { return p.goal_lx && p.weight > 0; })) {
    problems.add(s.in_file(), "there is nothing to place lights for: no point has a goal",
                 "give each [[point]] that matters a goal_lx");
  }
}

void RigReader::need_watts_of(std::size_t luminaire, const FilePosition& in_file, const std::string& what) {
  // After another problem, an entry may stand in for one that is missing.
  if (!problems.empty() && lacks_watts.empty()) return;
  const Luminaire& lamp = rig.luminaires[luminaire];
  if (lamp.watts || !lacks_watts.insert(lamp.emitter_of.value_or(luminaire)).second) return;
  const Luminaire& whole = rig.luminaires[lamp.emitter_of.value_or(luminaire)];
  problems.add(in_file, fmt::format("{} needs the watts of luminaire {}", what, in_quotes(whole.name)),
               fmt::format("add watts to {} (line {}), or remove the limit",
                           whole.emitters.empty() ? "it" : "each of its emitters", whole.in_file.line));
}

void RigReader::need_watts_of_fixtures(const FilePosition& in_file, const std::string& what) {
  for (const Fixture& fixture : rig.fixtures) need_watts_of(fixture.luminaire, in_file, what);
}

void RigReader::read_tasks() {
  NameIndex tasks("task");
  each(root, "task", [&](Section& s) {
    Task task;
    task.in_file = s.in_file();
    if (s.read("name", task.name)) tasks.add(task.name, rig.tasks.size(), s.place_of("name"), problems);
    if (s.read_choice("kind", task.kind)) {
      refuse_keys_of_other_kinds(s, task.kind);
      if (task.kind == TaskKind::placement) read_placement(s, task.placement);
      if (task.kind == TaskKind::aim) read_aim_task(s, task.aim);
      if (task.kind == TaskKind::highlight) read_highlight(s, task.highlight);
      if (task.kind == TaskKind::directions) read_directions(s, task.directions);
    }
    s.read("max_watts", task.max_watts);
    const auto need_watts = [&](const FilePosition& in_file, const std::string& what) {
      if (task.kind == TaskKind::placement) return need_watts_of(task.placement.luminaire, in_file, what);
      if (task.kind == TaskKind::highlight) return need_watts_of(task.highlight.luminaire, in_file, what);
      need_watts_of_fixtures(in_file, what);
    };
    if (task.max_watts) need_watts(s.place_of("max_watts"), "max_watts of this task");
    if (task.placement.energy_front > 0) need_watts(s.place_of("energy_front"), "energy_front");
    if (task.aim.energy_weight > 0) need_watts(s.place_of("energy_weight"), "energy_weight");
    if (rig.limits.max_watts && task.places_lights()) need_watts(rig.limits.in_file, "max_watts of [limits]");
    rig.tasks.push_back(std::move(task));
  });
  if (rig.limits.max_watts) need_watts_of_fixtures(rig.limits.in_file, "max_watts of [limits]");
  if (rig.tasks.empty()) rig.tasks.push_back({"levels", TaskKind::emittance, {}});
}

void RigReader::read_mounting() {
  each(root, "mounting", [&](Section& s) {
    MountingSpec& mounting = rig.mounting;
    mounting.in_file = s.in_file();
    s.read("box_m", mounting.box_world_m);
    std::vector<std::pair<std::string, FilePosition>> patterns;
    const bool surfaces_known = s.read_texts("surfaces", patterns) || !s.has("surfaces");
    for (auto& [text, in_file] : patterns) mounting.surfaces.push_back({std::move(text), in_file});
    std::pair<double, double> offset_m{mounting.offset_min_m, mounting.offset_max_m};
    s.read("offset_m", offset_m);
    mounting.offset_min_m = offset_m.first;
    mounting.offset_max_m = offset_m.second;
    if (surfaces_known && patterns.empty())
      s.refuse("offset_m", "offset_m has no effect without surfaces", "add surfaces = [\"…\"], or remove it");
    s.read("clearance_m", mounting.clearance_m);
    s.read("spacing_m", mounting.spacing_m);
  });
}

}  // namespace luxrig
