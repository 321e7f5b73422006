#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>

#include "core/output/keep_out.h"
#include "core/photometry/beam.h"
#include "core/rig/null_bus.h"
#include "core/rig/personality/personality.h"
#include "core/rig/register_map/register_map.h"
#include "core/tasks/rig_notes/rig_notes.h"
#include "drivers/registry.h"
#include "drivers/when_data_stops.h"
#include "tools/command_line/installed.h"
#include "tools/luxrig/addresses.h"
#include "tools/luxrig/commands.h"
#include "tools/luxrig/open_session.h"
#include "tools/terminal/command.h"
#include "tools/terminal/table.h"

namespace luxrig {
namespace {

struct CheckArguments {
  std::filesystem::path rig;
  bool json = false;
  bool outputs = false;  ///< also show how each output behaves when data stops
};

/// In the planes C0 and C90; once if they are alike.
std::string angles_text(const PlaneAngles& angles) {
  const std::string c0 = fmt::format("{:.1f}°", deg_from_rad(angles.c0_rad));
  const std::string c90 = fmt::format("{:.1f}°", deg_from_rad(angles.c90_rad));
  return c0 == c90 ? c0 : c0 + " x " + c90;
}

std::string daylight_text(const Daylight& daylight) {
  using Kind = Daylight::SkyKind;
  std::string text;
  switch (daylight.sky) {
    case Kind::none:
      text = "no sky";
      break;
    case Kind::uniform:
      text = "uniform sky";
      break;
    case Kind::overcast:
      text = "overcast sky";
      break;
    case Kind::clear:
      text = "clear sky";
      break;
    case Kind::general:
      text = fmt::format("general sky of type {}", daylight.general_type);
      break;
  }
  if (daylight.sky != Kind::none) text += fmt::format(" of {:.0f} lx", daylight.horizontal_lx);
  if (!(daylight.sun_normal_lx > 0)) return text + ", no sun";
  const Vec3& sun = daylight.towards_sun_world;
  return text + fmt::format(", sun of {:.0f} lx, {:.1f}° high, towards x {:.2f}, y {:.2f}", daylight.sun_normal_lx,
                            deg_from_rad(std::asin(std::clamp(sun.z(), -1.0, 1.0))), sun.x(), sun.y());
}

std::string mounting_text(const MountingSpec& mounting) {
  std::string text;
  for (const auto& surface : mounting.surfaces) text += fmt::format("{}{}", text.empty() ? "" : ", ", surface.text);
  text = text.empty() ? "in the air"
                      : fmt::format("{:g} to {:g} m off {}", mounting.offset_min_m, mounting.offset_max_m, text);
  return text + (mounting.box_world_m ? " within box_m" : "");
}

std::string relief_text(const Rig& rig, const ReliefSpec& relief) {
  std::string text = fmt::format("the relief of {}", rig.scene.objects[relief.object].name);
  if (relief.scale_m) text += fmt::format(" at {:g} mm", 1000 * *relief.scale_m);
  if (relief.max_lx) text += fmt::format(", at most {:g} lx on it", *relief.max_lx);
  return text;
}

std::string lights_text(const std::optional<int>& lights, int most, const std::string& luminaire) {
  return fmt::format(
      "{} of {}", lights ? fmt::format("{}", *lights) : fmt::format("as few as will do, at most {},", most), luminaire);
}

/// What a task will do; empty if its kind says it all.
std::string task_text(const Rig& rig, const Task& task) {
  switch (task.kind) {
    case TaskKind::emittance:
      return "";
    case TaskKind::placement: {
      const PlacementSpec& p = task.placement;
      return lights_text(p.lights, p.max_lights, rig.luminaires[p.luminaire].name) + ", " + mounting_text(rig.mounting);
    }
    case TaskKind::aim: {
      std::string heads;
      for (const std::size_t head : task.aim.heads)
        heads += fmt::format("{}{}", heads.empty() ? "" : ", ", rig.fixtures[head].name);
      return fmt::format("{}, with {}", relief_text(rig, task.aim.relief), heads);
    }
    case TaskKind::highlight: {
      const HighlightSpec& h = task.highlight;
      return fmt::format("{}, by {}, {}", relief_text(rig, h.relief),
                         lights_text(h.lights, h.max_lights, rig.luminaires[h.luminaire].name),
                         mounting_text(rig.mounting));
    }
    case TaskKind::directions: {
      const DirectionsSpec& d = task.directions;
      return fmt::format("{}, by {}, held {:g} m from it", relief_text(rig, d.relief),
                         lights_text(d.lights, d.max_lights, "lamps in hand"), d.distance_m);
    }
  }
  return "";
}

/// How each fixture with a maker's file was understood. One fixture of a housing stands for all of it, and fixtures
/// with the same setting share a line.
void print_personalities(const Rig& rig) {
  constexpr std::size_t kMaxNamed = 4;
  std::vector<std::pair<std::string, std::vector<std::string>>> told;  // text, and the fixtures that it is true for
  for (std::size_t i = 0; i < rig.fixtures.size(); ++i) {
    const Fixture& fixture = rig.fixtures[i];
    if (!fixture.mode || fixture.housing.value_or(i) != i) continue;
    const FixtureMode& use = *fixture.mode;
    const PersonalityMode& mode = use.personality->modes[use.mode];
    std::string text = fmt::format("{} {}, mode {}, {} slots ({})\n", use.personality->manufacturer,
                                   use.personality->name, mode.name, mode.footprint(), use.file.string());
    for (const std::string& line : use.told) text += "    " + line + "\n";
    const std::string name =
        use.emitter.empty() ? fixture.name : fixture.name.substr(0, fixture.name.size() - use.emitter.size() - 1);
    const auto known = std::find_if(told.begin(), told.end(), [&](const auto& entry) { return entry.first == text; });
    if (known == told.end()) {
      told.push_back({text, {name}});
    } else {
      known->second.push_back(name);
    }
  }
  for (const auto& [text, names] : told) {
    const bool all = names.size() <= kMaxNamed;
    const auto named = std::span(names).first(all ? names.size() : kMaxNamed - 1);
    fmt::print("  personality of {}{}: {}\n", fmt::join(named, ", "),
               all ? "" : fmt::format(" and {} more", names.size() - named.size()), text);
  }
}

/// The products behind Modbus units: how their levels behave without Luxrig, and what is not stated.
void print_register_maps(const Rig& rig) {
  std::vector<std::pair<std::shared_ptr<const RegisterMap>, std::vector<std::string>>> products;
  const auto add = [&](const std::shared_ptr<const RegisterMap>& map, const std::string& device) {
    if (!map) return;
    const auto known =
        std::find_if(products.begin(), products.end(), [&](const auto& entry) { return entry.first == map; });
    if (known == products.end()) {
      products.push_back({map, {device}});
    } else {
      known->second.push_back(device);
    }
  };
  for (const Fixture& fixture : rig.fixtures) {
    if (const auto* patch = std::get_if<ModbusPatch>(&fixture.patch)) add(patch->map, fixture.name);
  }
  for (const Luxmeter& meter : rig.luxmeters) add(meter.patch.map, meter.name);
  for (const auto& [map, devices] : products) {
    fmt::print("  product of {}: {} ({})\n", fmt::join(devices, ", "), map->name, map->source);
    if (!map->with_role(RegisterRole::level).empty()) {
      fmt::print("    when data stops it {}\n", told_when_data_stops(*map));
    }
    for (const std::string& text : map->assumed) fmt::print("    assumed: {}\n", text);
  }
}

/// How each output behaves without Luxrig.
void print_outputs(const Rig& rig) {
  fmt::print("\nwhen data stops (Luxrig dies and no guardian stands in for it, or a cable is cut):\n\n");
  Table table({"fixture", "bus", "its lamp", "says who"});
  for (const OutputWithoutData& output : outputs_without_data(rig)) {
    const Fixture& fixture = rig.fixtures[output.fixture];
    table.row({fixture.name, rig.buses[fixture.bus].name, told(output.lamp), output.lamp.by});
    if (output.axes) table.row({"", rig.buses[fixture.axes->bus].name, told(*output.axes), output.axes->by});
  }
  fmt::print(
      "{}\nWith a guardian (luxrigd, not with --no-guardian): held for {:g} s, then the safe look over {:g} s, for as "
      "long as the guardian lives.\n",
      table.text(), rig.safe.hold_s, rig.safe.fade_s);
  fmt::print("\nwhat comes back when something fails:\n\n");
  for (std::size_t b = 0; b < rig.buses.size(); ++b) {
    const std::string_view comes_back = what_comes_back(rig.buses[b]);
    const bool lights =
        std::any_of(rig.fixtures.begin(), rig.fixtures.end(), [&](const Fixture& fixture) { return fixture.bus == b; });
    if (lights) fmt::print("  {} ({}): {}\n", rig.buses[b].name, rig.buses[b].driver, comes_back);
  }
}

nlohmann::json outputs_json(const Rig& rig) {
  nlohmann::json all = nlohmann::json::array();
  for (const OutputWithoutData& output : outputs_without_data(rig)) {
    nlohmann::json one = {{"fixture", rig.fixtures[output.fixture].name},
                          {"without_data", name_of(output.lamp.does)},
                          {"comes_back", what_comes_back(rig.buses[rig.fixtures[output.fixture].bus])},
                          {"by", output.lamp.by}};
    if (output.lamp.after_s) one["after_s"] = *output.lamp.after_s;
    if (output.axes)
      one["axes"] = {{"released", output.axes->released}, {"after_s", output.axes->after_s}, {"by", output.axes->by}};
    all.push_back(std::move(one));
  }
  return all;
}

nlohmann::json problem_json(const Problem& p) {
  return {{"file", p.file}, {"line", p.line}, {"column", p.column}, {"what", p.what}, {"mend", p.mend}};
}

/// Everything legal but worth a look: in the file, where heads look, how the rig fits its scene.
std::vector<Problem> all_notes(const Session& session) {
  const Rig& rig = session.rig;
  std::vector<Problem> notes = rig.notes;
  const KeepOutZones zones(rig);
  for (const std::size_t head : zones.heads()) {
    const Fixture& fixture = rig.fixtures[head];
    if (const auto zone = zones.met(head, fixture.joints))
      notes.push_back({rig.file.string(), fixture.in_file.line, fixture.in_file.column,
                       fmt::format("{} looks into keep-out zone \"{}\" as it hangs", fixture.name, zones.name(*zone)),
                       "it stays dark until it is turned"});
  }
  for (Problem& note : null_buses_in_use(rig)) notes.push_back(std::move(note));
  for (Problem& note : notes_on(rig, session.scene, *session.rays)) notes.push_back(std::move(note));
  return notes;
}

/// A material of the scene by its name. Under a picture it comes in several shades.
struct MaterialSummary {
  std::string name;
  double mean = 0, least = 1, most = 0, area_m2 = 0;
  bool assumed = false;
};

/// In the order of the scene, means by area.
std::vector<MaterialSummary> materials_by_name(const Scene& scene) {
  std::vector<double> area_m2(scene.materials.size());
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const auto& [a, b, c] = scene.triangles[i];
    const Vec3f& corner = scene.vertices_m[a];
    area_m2[scene.material_of_triangle[i]] +=
        (scene.vertices_m[b] - corner).cross(scene.vertices_m[c] - corner).norm() / 2;
  }
  std::vector<MaterialSummary> out;
  std::map<std::string, std::size_t> places;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& m = scene.materials[i];
    const auto [at, is_new] = places.try_emplace(m.name, out.size());
    if (is_new) out.emplace_back().name = m.name;
    MaterialSummary& sum = out[at->second];
    const double reflectance = m.luminous_reflectance();
    sum.mean += reflectance * area_m2[i];
    sum.area_m2 += area_m2[i];
    sum.least = std::min(sum.least, reflectance);
    sum.most = std::max(sum.most, reflectance);
    sum.assumed = sum.assumed || !m.coloured;
  }
  for (MaterialSummary& sum : out) sum.mean = sum.area_m2 > 0 ? sum.mean / sum.area_m2 : sum.most;
  return out;
}

std::string reflectance_source(const MaterialSummary& material) {
  if (material.assumed) return "assumed: default_reflectance";
  if (material.most - material.least > 0.005) return fmt::format("{:.2f} to {:.2f}", material.least, material.most);
  return "";
}

std::string place_text(const Vec3& p) {
  // Centimetres, without negative zero.
  const Vec3 cm = (100 * p).array().round() + 0.0;
  return fmt::format("{:.2f} {:.2f} {:.2f}", cm.x() / 100, cm.y() / 100, cm.z() / 100);
}

int run_check(const CheckArguments& arguments) {
  const auto session = open_session(arguments.rig);
  if (!session) {
    if (arguments.json) {
      nlohmann::json out = {{"ok", false}, {"problems", nlohmann::json::array()}};
      for (const Problem& p : session.error()) out["problems"].push_back(problem_json(p));
      fmt::print("{}\n", out.dump(1));
      return kExitBadInput;
    }
    return report(session.error());
  }
  const Rig& rig = session->rig;
  tell_calibration(rig);
  const Scene& scene = session->scene;
  const std::vector<Problem> notes = all_notes(*session);
  if (arguments.json) {
    nlohmann::json out = {{"ok", true},
                          {"rig", rig.name},
                          {"triangles", scene.triangles.size()},
                          {"luminaires", rig.luminaires.size()},
                          {"fixtures", rig.fixtures.size()},
                          {"buses", rig.buses.size()},
                          {"luxmeters", rig.luxmeters.size()},
                          {"cameras", rig.cameras.size()},
                          {"points", rig.points.size()},
                          {"warnings", scene.warnings},
                          {"notes", nlohmann::json::array()}};
    for (const Problem& note : notes) out["notes"].push_back(problem_json(note));
    if (arguments.outputs) out["outputs"] = outputs_json(rig);
    fmt::print("{}\n", out.dump(1));
    return kExitOk;
  }
  const auto bounds = session->rays->bounds_world_m();
  fmt::print("{}: {}\n", rig.file.string(), rig.name);
  if (scene.triangles.empty()) {
    fmt::print("  scene      empty: light meets nothing\n");
  } else {
    const Vec3 size = bounds.sizes();
    fmt::print("  scene      {} triangles, {} materials, {:.2f} x {:.2f} x {:.2f} m\n", scene.triangles.size(),
               materials_by_name(scene).size(), size.x(), size.y(), size.z());
  }
  if (const Cleaning& c = scene.cleaning; c.total() > 0) {
    fmt::print("  cleaned    {} vertices not finite, {} triangles with a bad index, {} without area\n",
               c.non_finite_vertices, c.bad_indices, c.degenerate_triangles);
  }
  for (const std::string& warning : scene.warnings) fmt::print("  warning    {}\n", warning);
  for (const Problem& note : notes) fmt::print("  note       {}\n", note.text());
  if (rig.daylight) fmt::print("  daylight   {}\n", daylight_text(*rig.daylight));
  fmt::print("  counts     {} luminaires, {} fixtures, {} buses, {} luxmeters, {} cameras, {} points, {} tasks\n",
             rig.luminaires.size(), rig.fixtures.size(), rig.buses.size(), rig.luxmeters.size(), rig.cameras.size(),
             rig.points.size(), rig.tasks.size());
  for (const Task& task : rig.tasks)
    if (const std::string text = task_text(rig, task); !text.empty())
      fmt::print("  {:<10} {}: {}\n", name_of(task.kind), task.name, text);
  fmt::print("\n");
  Table materials({"material", ">luminous reflectance", "of"});
  for (const MaterialSummary& m : materials_by_name(scene))
    materials.row({m.name, fmt::format("{:.2f}", m.mean), reflectance_source(m)});
  for (const SceneObject& object : rig.scene.objects)
    if (object.transmittance)
      materials.row({object.name, fmt::format("glass, lets {:.2f} through", *object.transmittance), ""});
  if (!scene.materials.empty()) fmt::print("{}\n", materials.text());
  Table luminaires({"luminaire", ">lumens", ">peak cd", ">beam", ">field", ">watts"});
  for (const Luminaire& l : rig.luminaires) {
    luminaires.row({l.name, fmt::format("{:.0f}", l.lumens), fmt::format("{:.0f}", l.intensity->max_intensity_cd()),
                    angles_text(beam_angles(*l.intensity)), angles_text(field_angles(*l.intensity)),
                    l.watts ? fmt::format("{:.0f}", *l.watts) : "-"});
  }
  fmt::print("{}\n", luminaires.text());
  Table fixtures({"fixture", "luminaire", "position m", ">pan", ">tilt", ">zoom", "bus", "address"});
  for (const Fixture& f : rig.fixtures) {
    fixtures.row({f.name, rig.luminaires[f.luminaire].name, place_text(f.world_from_mount.translation_m),
                  fmt::format("{:.1f}°", deg_from_rad(f.joints.pan_rad)),
                  fmt::format("{:.1f}°", deg_from_rad(f.joints.tilt_rad)),
                  f.range.zooms() ? fmt::format("{:.1f}°", deg_from_rad(f.joints.beam_rad)) : "-",
                  rig.buses[f.bus].name + " (" + rig.buses[f.bus].driver + ")",
                  fixture_address(rig, f) + (f.switched ? ", on or off" : "")});
  }
  fmt::print("{}\n", fixtures.text());
  print_personalities(rig);
  print_register_maps(rig);
  Table points({"point", "position m", ">goal lx", ">max lx", "luxmeter"});
  for (std::size_t i = 0; i < rig.points.size(); ++i) {
    const Point& p = rig.points[i];
    std::string meter;
    for (const Luxmeter& m : rig.luxmeters) {
      if (m.point == i) meter = m.name;
    }
    points.row({p.name, place_text(p.position_world_m), p.goal_lx ? fmt::format("{:g}", *p.goal_lx) : "-",
                p.max_lx ? fmt::format("{:g}", *p.max_lx) : "-", meter});
  }
  fmt::print("{}\n", points.text());
  if (notes.empty()) {
    fmt::print("{}: no problems found\n", rig.name);
  } else {
    fmt::print("{}: {}, but {} above {} a look\n", rig.name,
               null_buses_in_use(rig).empty() ? "nothing keeps it from running" : "it can be planned and not yet run",
               notes.size() == 1 ? "the note" : fmt::format("the {} notes", notes.size()),
               notes.size() == 1 ? "is worth" : "are worth");
  }
  if (arguments.outputs) print_outputs(rig);
  return kExitOk;
}

Action declare_check(CLI::App& command) {
  const auto check = std::make_shared<CheckArguments>();
  add_rig_option(command, check->rig);
  command.add_flag("--json", check->json, "print JSON");
  command.add_flag("--outputs", check->outputs, "also say what each output does when data stops");
  return [check] { return run_check(*check); };
}

}  // namespace

const Command kCheckCommand{"check", command_group::kSet, "validate a rig and print what was understood",
                            declare_check};

}  // namespace luxrig
