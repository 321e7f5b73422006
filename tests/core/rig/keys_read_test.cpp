// Every key of the schema is really read: a change of its value changes the Rig. Leaving it out equals writing the
// default that the reference states.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "core/rig/rig_file.h"
#include "core/rig/schema.h"
#include "tests/core/rig/kitchen_sink.h"
#include "tests/core/rig/listed_problems.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

using kitchen_sink::Line;

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

/// All of a Rig except places, as text.
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
        text_of(l.watts), l.zoom_beam_rad ? l.zoom_beam_rad->first : 0, l.zoom_beam_rad ? l.zoom_beam_rad->second : 0,
        l.intensity->flux_lm(), l.intensity->intensity_cd(Vec3(0.1, 0, -1).normalized()),
        static_cast<int>(l.shape.kind), text_of(l.shape.size_m), text_of(l.colour_rgb), l.emitters.size(),
        text_of(l.emitter_of));
  }
  for (const auto& b : rig.buses) {
    add(b.name, b.driver, text_of(b.safe_level), b.options.size());
  }
  for (const auto& f : rig.fixtures) {
    add(f.name, f.luminaire, text_of(f.world_from_mount.translation_m),
        text_of(Vec3(f.world_from_mount.rotation.col(0))), text_of(Vec3(f.world_from_mount.rotation.col(1))),
        text_of(f.aim_world_m), f.joints.pan_rad, f.joints.tilt_rad, f.roll_rad, f.moves, f.range.pan_min_rad,
        f.range.pan_max_rad, f.range.tilt_min_rad, f.range.tilt_max_rad, f.pan_speed_rad_s, f.tilt_speed_rad_s,
        f.zoom_speed_rad_s, f.bus, static_cast<int>(f.dimmer_curve), f.switched, f.max_level, text_of(f.safe_level),
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
        text_of(p.max_lx), text_of(p.goal_tolerance));
  }
  for (const SurfaceGoalSpec& g : rig.surface_goals)
    add(g.name, g.strokes_file.string(), text_of(g.max_lx), g.weight, text_of(g.goal_rgb), text_of(g.uniformity),
        text_of(g.goal_tolerance), g.patch_m, g.min_spacing_m, g.max_spacing_m);
  for (const auto& t : rig.tasks) {
    const PlacementSpec& p = t.placement;
    add(t.name, static_cast<int>(t.kind), p.luminaire, text_of(p.lights), p.max_lights, p.error_wanted, p.improvement,
        static_cast<int>(p.method), p.aimed, p.indirect, static_cast<int>(p.fixtures), text_of(p.seconds),
        p.energy_front, p.bound, text_of(t.max_watts));
    const AimSpec& a = t.aim;
    const HighlightSpec& h = t.highlight;
    const DirectionsSpec& d = t.directions;
    for (const ReliefSpec& r : {a.relief, h.relief, d.relief})
      add(r.object, text_of(r.scale_m), r.interest, text_of(r.max_lx), text_of(r.camera), r.seen, r.relative,
          r.coverage_weight, static_cast<int>(r.role), text_of(r.ratio), static_cast<int>(r.set_up), r.weights.fine,
          r.weights.form, r.weights.lit, r.weights.edge, r.weights.even, r.weights.shadows, r.weights.max_clipped,
          r.light_rgb ? text_of(*r.light_rgb) : "");
    for (const std::size_t head : a.heads) add("head", head);
    for (const std::size_t eye : a.eyes) add("eye", eye);
    add(text_of(a.key), a.min_key_to_fill, text_of(a.max_key_to_fill), text_of(a.max_eye_lx), a.energy_weight,
        a.base_weight, a.travel_weight, a.base_lx, h.luminaire, text_of(h.lights), h.max_lights, text_of(d.lights),
        d.max_lights, d.distance_m);
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
  add(c.fade_s, static_cast<int>(c.fade_curve), c.correction_fade_s, c.settle_s, c.rounds, c.tolerance,
      c.goal_tolerance, c.gain_min, c.gain_max, c.fault_dips);
  if (rig.daylight) {
    const Daylight& d = *rig.daylight;
    add(static_cast<int>(d.sky), d.general_type, d.horizontal_lx, d.sun_normal_lx, text_of(d.towards_sun_world));
  }
  add(rig.safe.level, rig.safe.hold_s, rig.safe.fade_s, static_cast<int>(rig.safe.scope), rig.safe.on_meter_loss,
      rig.daemon.http_port, rig.daemon.listen, rig.daemon.accounts_file.string(),
      rig.daemon.tls_certificate_file.string(), rig.daemon.tls_key_file.string(), rig.daemon.behind_proxy,
      rig.daemon.park_at_end, rig.startup.stage_s, text_of(rig.startup.max_watts_per_s), rig.startup.after_loss);
  return out;
}

/// Content for the example of a key of type file, and for a second file beside it.
std::string content_of(const std::filesystem::path& file, bool second) {
  const std::string kind = file.extension().string();
  if (kind == ".obj") return "v 0 0 0\n";
  if (kind == ".csv") return fmt::format("name,x_m,y_m,z_m\n{},1,2,3\n", file.stem().string());
  if (kind == ".ies")
    return fmt::format("IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 1 1 2 .1 .1 0\n1 1 10\n0 45 90\n0\n100 {} 0\n",
                       second ? 20 : 50);
  if (kind == ".json")
    return fmt::format(R"({{"$schema": "https://github.com/open-fixture-library/master/schemas/fixture.json",
        "name": "x", "availableChannels": {{
          "Dimmer": {{"capability": {{"type": "Intensity"}}}},
          "Mode": {{"capabilities": [{{"dmxRange": [0, 239], "type": "NoFunction"}},
                                    {{"dmxRange": [240, 255], "type": "Intensity"}}], "defaultValue": {}}}}},
        "modes": [{{"name": "short", "channels": ["Dimmer", "Mode"]}},
                  {{"name": "long", "channels": ["Mode", "Dimmer"]}}]}})",
                       second ? 8 : 7);
  return fmt::format(R"([device]
name = "x"
source = "y"
[[register]]
name = "out"
what = "level"
address = {}
count = 2
range = [0, 255]
[[register]]
name = "low"
what = "illuminance"
address = {}
[[register]]
name = "high"
what = "illuminance"
address = 40
)",
                     second ? 10 : 0, second ? 30 : 20);
}

class KeysRead : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    std::filesystem::copy_file(test::source_folder() / "tests/data/luminaires/two_heads.gldf",
                               folder_ / "two_heads.gldf", std::filesystem::copy_options::overwrite_existing);
    for (const KeySpec& key : keys()) {
      if (key.type != ValueType::file) continue;
      for (const std::string& quoted : {std::string(key.example), kitchen_sink::other_than_example(key)}) {
        const std::filesystem::path file = quoted.substr(1, quoted.size() - 2);
        std::ofstream(folder_ / file) << content_of(file, quoted != key.example);
      }
    }
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// The sink with some lines replaced, as a dump; or its problems.
  std::string read(const std::vector<Line>& lines) {
    std::string text;
    for (const Line& line : lines) text += line.text + "\n";
    const Checked<Rig> rig = parse_rig(text, "sink.toml", folder_, PaintedPoints::left_out);
    if (rig) return dump(*rig);
    return "REFUSED " + test::listed(rig.error());
  }

  /// A changed name or reference must do more than raise a dangling reference.
  static void rename(std::vector<Line>& lines, const Line& renamed) {
    const std::string old = renamed.text.substr(renamed.text.find(" = ") + 3);
    for (Line& line : lines) {
      if (line.key != "name" && line.text.ends_with(" = " + old)) line.text = line.key + " = " + renamed.other;
    }
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("luxrig_keys_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(KeysRead, ChangingAnyKeyChangesTheRig) {
  std::set<std::pair<std::string, std::string>> changed;
  for (const char* daylight : {kitchen_sink::kSunByAngles, kitchen_sink::kSunByPlace}) {
    const auto sink = kitchen_sink::lines(std::string(kitchen_sink::kRig) + daylight, SectionSpec::File::rig);
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

TEST_F(KeysRead, OmittingAKeyEqualsWritingItsDefault) {
  std::set<std::pair<std::string, std::string>> tried;
  for (const char* daylight : {kitchen_sink::kSunByAngles, kitchen_sink::kSunByPlace}) {
    const auto sink = kitchen_sink::lines(std::string(kitchen_sink::kRig) + daylight, SectionSpec::File::rig);
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
          if (written.starts_with("REFUSED")) continue;  // a default may not fit the rest here; it must fit somewhere
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
