// Keep-outs of heads, and how light comes on.
#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "core/rig/housing.h"
#include "core/rig/reading/rig_reader.h"

namespace luxrig {

void RigReader::read_keep_outs() {
  NameIndex names("keep_out");
  std::vector<std::string> head_names;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) head_names.push_back(housing_name(rig, f));
  const std::vector<std::string_view> known(head_names.begin(), head_names.end());
  each(root, "keep_out", [&](Section& s) {
    KeepOut zone;
    zone.in_file = s.in_file();
    if (s.read("name", zone.name)) names.add(zone.name, rig.keep_outs.size(), s.place_of("name"), problems);
    if (s.has("box_m") == s.has("centre_m")) {
      problems.add(s.in_file(),
                   fmt::format("[[keep_out]] has {}", s.has("box_m") ? "both box_m and centre_m" : "no extent"),
                   "give it box_m, or centre_m with radius_m");
    } else if (s.has("box_m")) {
      s.read("box_m", zone.box_world_m);
      s.refuse("radius_m", "radius_m has no effect with box_m", "remove it, or give centre_m instead of box_m");
    } else {
      s.read("centre_m", zone.centre_world_m);
      if (!s.has("radius_m")) s.require("radius_m", "which a sphere needs");
      s.read("radius_m", zone.radius_m);
    }
    s.read_deg("margin_deg", zone.margin_rad);
    if (s.has("heads")) {
      zone.heads = read_patterns(s, "heads", known, "fixture");
    } else {
      for (std::size_t f = 0; f < rig.fixtures.size(); ++f) zone.heads.push_back(f);
    }
    const bool any = !zone.heads.empty();
    std::erase_if(zone.heads, [&](std::size_t f) { return !rig.fixtures[f].moves; });
    if (zone.heads.empty() && problems.empty())
      problems.add(s.place_of("heads"),
                   fmt::format("[[keep_out]] {} holds for no head: {}", in_quotes(zone.name),
                               any ? "what it names does not move" : "the rig has none"),
                   "remove it, or name fixtures with pan and tilt");
    rig.keep_outs.push_back(std::move(zone));
  });
}

void RigReader::read_startup() {
  each(root, "startup", [&](Section& s) {
    rig.startup.in_file = s.in_file();
    s.read("stage_s", rig.startup.stage_s);
    s.read("max_watts_per_s", rig.startup.max_watts_per_s);
    s.read("after_loss", rig.startup.after_loss);
    if (rig.startup.max_watts_per_s) need_watts_of_fixtures(s.place_of("max_watts_per_s"), "max_watts_per_s");
    if (!s.has("stage_s") && !s.has("max_watts_per_s"))
      s.refuse("after_loss", "after_loss has no effect: nothing is staged", "give stage_s or max_watts_per_s");
  });
}

}  // namespace luxrig
