#include "core/rig/mvr/mvr_rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/rig/mvr/free_addresses.h"
#include "core/rig/mvr/mvr_scenery.h"
#include "core/rig/personality/gdtf/gdtf_file.h"
#include "core/rig/reading/mode_slots.h"
#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr double kFallbackBeam_deg = 25, kFallbackField_deg = 40, kFallbackLumens = 1000;
constexpr double kNearestFocus_m = 0.01;
constexpr int kLastUniverse = 50'000;  // above it, sACN's 63 999 might leave too few for unpatched fixtures

/// As TOML. Names are already plain text here.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') out += '\\';
    out += letter;
  }
  return out + '"';
}

/// For a comment on one line: plain text has no line ends.
std::string cut(const std::string& text, std::size_t max_characters) {
  std::string out = text.substr(0, 4 * max_characters);  // a character has at most four bytes
  while (!out.empty() && !is_plain_text(out)) out.pop_back();
  while (length_in_characters(out) > max_characters) {
    out.pop_back();
    while (!out.empty() && !is_plain_text(out)) out.pop_back();
  }
  return out;
}

class UniqueNames {
 public:
  std::string of(const std::string& wanted, const char* otherwise) {
    const std::string base = cut(wanted.empty() ? otherwise : wanted, kLongestName - 6);
    int& count = counts_[base];
    std::string name = base;
    while (!taken_.insert(name).second) name = fmt::format("{} {}", base, ++count + 1);
    return name;
  }

 private:
  std::set<std::string> taken_;
  std::map<std::string, int> counts_;  // keeps the cost linear if ten thousand share one name
};

std::string file_name_of(const std::string& gdtf_file) {
  std::string name;
  for (const char letter : gdtf_file) {
    const bool plain = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
                       (letter >= '0' && letter <= '9') || letter == '@' || letter == '-' || letter == '.';
    name += plain ? letter : '_';
  }
  if (name.ends_with(".gdtf")) name.resize(name.size() - 5);
  name = name.substr(0, 80);
  const auto first = name.find_first_not_of('.');
  return (first == std::string::npos ? "fixture" : name.substr(first)) + ".gdtf";
}

/// A kind of fixture: a GDTF file in one mode.
struct FixtureKind {
  std::string luminaire;
  std::string personality_file;  // empty = none can be used
  std::string mode;
  std::string trouble;  // why none can be used
  int footprint = 1;
  Pose base_from_lamp;
  std::optional<ModeSlots> slots;
};

class RigWriter {
 public:
  explicit RigWriter(const MvrFile& mvr) : mvr_(mvr) {}

  ImportedRig write(const std::string& rig_name) {
    text_ += "# Made by `luxrig import` from an MVR file. Lines with FILL IN need a person.\n";
    for (const std::string& note : mvr_.scene.notes) remark(note);
    text_ += fmt::format("[rig]\nname = {}\n\n", quoted(cut(rig_name.empty() ? "imported" : rig_name, kLongestName)));
    write_scene();
    text_ += "# FILL IN: [[point]] entries with goals in lux, and a [[luxmeter]] where one stands.\n\n";
    for (const MvrFixture& fixture : mvr_.scene.fixtures) kind_of(fixture);
    text_ +=
        "# FILL IN: MVR does not say how DMX gets to the fixtures. sACN; Art-Net is driver = \"artnet\".\n"
        "[[bus]]\nname = \"dmx\"\ndriver = \"sacn\"\n\n";
    reserve_addresses();
    for (std::size_t i = 0; i < mvr_.scene.fixtures.size(); ++i) write_fixture(i);
    if (unpatched_ > 0) {
      out_.remarks.push_back(fmt::format(
          "FILL IN: {} of {} fixtures are not patched in the MVR file; universe and address of each are made up.",
          unpatched_, mvr_.scene.fixtures.size()));
    }
    out_.rig_toml = std::move(text_);
    out_.fixtures = mvr_.scene.fixtures.size();
    out_.luminaires = kinds_.size();
    return std::move(out_);
  }

 private:
  void write_scene() {
    MvrScenery scenery = scenery_of_mvr(mvr_);
    for (const std::string& note : scenery.notes) remark(note);
    out_.models = scenery.models;
    if (scenery.obj.empty()) {
      text_ +=
          "# FILL IN: the room, as [scene] with a mesh, or as [[scene.object]] entries; without it light meets "
          "nothing.\n";
      return;
    }
    text_ += fmt::format(
        "# What is no fixture in the MVR file: {} models, as one mesh. `luxrig check` tells what each material "
        "reflects;\n"
        "# FILL IN: [[scene.reflectance]] entries where that is not so, and the room, where the file lacks it.\n"
        "[scene]\nfile = \"scene.obj\"\nunit = \"m\"\nup_axis = \"z\"\n\n",
        scenery.models);
    out_.files.push_back({"scene.obj", std::move(scenery.obj)});
    out_.files.push_back({"scene.mtl", std::move(scenery.mtl)});
  }

  void remark(const std::string& what) {
    text_ += "# " + what + "\n";
    if (out_.remarks.size() < 200) out_.remarks.push_back(what);
  }

  const FixtureKind& kind_of(const MvrFixture& fixture) {
    const auto [at, is_new] = kinds_.try_emplace({fixture.gdtf_file, fixture.gdtf_mode});
    if (is_new) make_kind(fixture, at->second);
    return at->second;
  }

  void make_kind(const MvrFixture& fixture, FixtureKind& kind) {
    const Personality* personality = personality_of(fixture.gdtf_file, kind);
    const PersonalityMode* mode = nullptr;
    if (personality != nullptr) {
      for (const PersonalityMode& m : personality->modes)
        if (m.name == fixture.gdtf_mode) mode = &m;
      if (mode == nullptr) kind.trouble = fmt::format("it has no mode {}", in_quotes(fixture.gdtf_mode));
    }
    kind.luminaire = luminaires_.of(personality != nullptr ? personality->name : fixture.gdtf_file, "luminaire");
    BeamGeometry beam = mode != nullptr ? light_of_mode(*mode) : BeamGeometry{};
    write_luminaire(kind, mode, beam);
    if (mode == nullptr) return;
    ProblemList problems("");
    ModeWanted wanted;
    wanted.owner = SlotOwner{kind.luminaire, {}};
    wanted.beam_deg = beam.beam_angle_deg;
    kind.slots = slots_of_mode(*personality, *mode, wanted, problems);
    if (!kind.slots) {
      const std::vector<Problem> found = problems.take();
      kind.trouble = found.empty() ? "its mode cannot be used" : found.front().what;
      return;
    }
    kind.mode = mode->name;
    kind.footprint = mode->footprint();
    kind.base_from_lamp = mode->base_from_lamp;
    kind.personality_file = file_of(fixture.gdtf_file);
  }

  /// Read once; null and `trouble` if it cannot be read.
  const Personality* personality_of(const std::string& gdtf_file, FixtureKind& kind) {
    const auto bytes = mvr_.gdtf_files.find(gdtf_file);
    if (bytes == mvr_.gdtf_files.end()) {
      kind.trouble = gdtf_file.empty() ? "it names no GDTF file" : "its GDTF file is not in the archive";
      return nullptr;
    }
    const auto [at, is_new] = personalities_.try_emplace(gdtf_file);
    if (is_new) at->second = read_gdtf(bytes->second, gdtf_file);
    if (!at->second) {
      kind.trouble = at->second.error().front().text();
      return nullptr;
    }
    return &*at->second;
  }

  std::string file_of(const std::string& gdtf_file) {
    const auto known = file_names_.find(gdtf_file);
    if (known != file_names_.end()) return known->second;
    std::string name = file_name_of(gdtf_file);
    for (int i = 2; std::any_of(out_.files.begin(), out_.files.end(), [&](const auto& f) { return f.name == name; });
         ++i)
      name = fmt::format("{}-{}", i, file_name_of(gdtf_file));
    out_.files.push_back({name, mvr_.gdtf_files.at(gdtf_file)});
    file_names_[gdtf_file] = name;
    return name;
  }

  void write_luminaire(const FixtureKind& kind, const PersonalityMode* mode, BeamGeometry& beam) {
    text_ += fmt::format("[[luminaire]]\nname = {}\nmodel = \"spot\"\n", quoted(kind.luminaire));
    std::string missing;
    const auto lacks = [&](const char* what) { missing += fmt::format("{}{}", missing.empty() ? "" : ", ", what); };
    if (!(beam.lumens > 0) || beam.lumens > 1e8) beam.lumens = kFallbackLumens, lacks("lumens");
    if (!(beam.beam_angle_deg > 0) || beam.beam_angle_deg >= 170) {
      beam.beam_angle_deg = kFallbackBeam_deg, beam.field_angle_deg = kFallbackField_deg, lacks("beam and field angle");
    } else if (!(beam.field_angle_deg > beam.beam_angle_deg) || beam.field_angle_deg >= 180) {
      beam.field_angle_deg = std::min(1.5 * beam.beam_angle_deg, 175.0), lacks("a field angle above the beam angle");
    }
    if (!missing.empty())
      remark(fmt::format("FILL IN: {}: the GDTF file lacks {}; the values here are made up.", in_quotes(kind.luminaire),
                         missing));
    text_ += fmt::format("beam_angle_deg = {:g}\nfield_angle_deg = {:g}\nlumens = {:g}\n", beam.beam_angle_deg,
                         beam.field_angle_deg, beam.lumens);
    if (beam.power_w > 0 && beam.power_w <= 1e6) text_ += fmt::format("watts = {:g}\n", beam.power_w);
    if (beam.cct_k >= 1667 && beam.cct_k <= 25000) text_ += fmt::format("cct_k = {:g}\n", beam.cct_k);
    if (mode != nullptr && has_colours(*mode)) {
      text_ +=
          "# Its colours are held full. To mix them, replace lumens and cct_k by `emitters` (rigs/REFERENCE.md).\n";
    }
    text_ += "\n";
  }

  static bool has_colours(const PersonalityMode& mode) {
    for (const PersonalityChannel& channel : mode.channels)
      for (const ChannelFunction& function : channel.functions)
        if (!channel.is_virtual() && !emitter_of_attribute(function.attribute).empty()) return true;
    return false;
  }

  /// The file's own addresses first, so that made-up ones avoid them.
  void reserve_addresses() {
    for (const MvrFixture& fixture : mvr_.scene.fixtures) {
      const FixtureKind& kind = kind_of(fixture);
      std::optional<UniverseAddress> own;
      if (!fixture.addresses.empty()) {
        const MvrAddress& first = fixture.addresses.front();
        highest_universe_ = std::max(highest_universe_, first.universe);
        if (addresses_.take({first.universe, first.address}, kind.footprint)) own = {first.universe, first.address};
      }
      given_.push_back(own);
    }
  }

  void write_fixture(std::size_t i) {
    const MvrFixture& fixture = mvr_.scene.fixtures[i];
    const FixtureKind& kind = kind_of(fixture);
    const std::string name = names_.of(fixture.name, "fixture");
    UniverseAddress at;
    if (given_[i]) {
      at = *given_[i];
    } else {
      at = addresses_.take_next(highest_universe_ < kLastUniverse ? highest_universe_ + 1 : 1, kind.footprint);
      if (fixture.addresses.empty()) {
        text_ += fmt::format("# FILL IN: {} is not patched in the MVR file; universe {}, address {} is made up.\n",
                             in_quotes(name), at.universe, at.address);
        ++unpatched_;
      } else {
        remark(
            fmt::format("FILL IN: {}: slots from universe {}, address {} on are taken, or too few; moved to "
                        "universe {}, address {}.",
                        in_quotes(name), fixture.addresses.front().universe, fixture.addresses.front().address,
                        at.universe, at.address));
      }
    }
    if (kind.personality_file.empty()) {
      remark(fmt::format("FILL IN: {}: the DMX slots are not known ({}); one dimmer slot is made up.", in_quotes(name),
                         cut(kind.trouble, 200)));
    }
    if (fixture.inverts_pan || fixture.inverts_tilt) {
      remark(fmt::format("FILL IN: {}: the MVR file inverts its {}; set that at the fixture itself.", in_quotes(name),
                         fixture.inverts_pan ? fixture.inverts_tilt ? "pan and tilt" : "pan" : "tilt"));
    }
    const Vec3 position_m = fixture.world_from_base.point(kind.base_from_lamp.translation_m);
    const Mat3 rotation = fixture.world_from_base.rotation * kind.base_from_lamp.rotation;
    const Vec3 mount_deg = mount_deg_of(rotation);
    text_ +=
        fmt::format("[[fixture]]\nname = {}\nluminaire = {}\nposition_m = [{:.4f}, {:.4f}, {:.4f}]\n", quoted(name),
                    quoted(kind.luminaire), position_m.x() + 0.0, position_m.y() + 0.0, position_m.z() + 0.0);
    if (mount_deg.cwiseAbs().maxCoeff() > 5e-4)
      text_ += fmt::format("mount_deg = [{:.3f}, {:.3f}, {:.3f}]\n", mount_deg.x(), mount_deg.y(), mount_deg.z());
    write_focus(fixture, kind, name, Pose{rotation, position_m});
    text_ += fmt::format("bus = \"dmx\"\nuniverse = {}\naddress = {}\n", at.universe, at.address);
    if (!kind.personality_file.empty())
      text_ += fmt::format("personality = {}\nmode = {}\n", quoted(kind.personality_file), quoted(kind.mode));
    text_ += "\n";
  }

  void write_focus(const MvrFixture& fixture, const FixtureKind& kind, const std::string& name, const Pose& mount) {
    if (!fixture.focus_world_m) return;
    const Vec3 direction = *fixture.focus_world_m - mount.translation_m;
    const bool reached = direction.norm() > kNearestFocus_m && kind.slots && kind.slots->moves &&
                         pan_tilt_towards(mount, direction, kind.slots->range, {});
    if (reached || (direction.norm() > kNearestFocus_m && !(kind.slots && kind.slots->moves))) {
      const Vec3& p = *fixture.focus_world_m;
      text_ += fmt::format("aim_m = [{:.4f}, {:.4f}, {:.4f}]\n", p.x(), p.y(), p.z());
      return;
    }
    // A comment may also stand between the keys of a table.
    remark(fmt::format("FILL IN: {} cannot reach its focus point in the MVR file; it looks straight out.",
                       in_quotes(name)));
  }

  const MvrFile& mvr_;
  ImportedRig out_;
  std::string text_;
  std::map<std::pair<std::string, std::string>, FixtureKind> kinds_;
  std::map<std::string, Checked<Personality>> personalities_;
  std::map<std::string, std::string> file_names_;
  std::size_t unpatched_ = 0;
  UniqueNames luminaires_, names_;
  FreeAddresses addresses_;
  std::vector<std::optional<UniverseAddress>> given_;
  int highest_universe_ = 0;
};

}  // namespace

Vec3 mount_deg_of(const Mat3& r) {
  // R = Rz(yaw) · Rx(pitch) · Ry(roll). At a pitch of a quarter turn, roll and yaw do the same, so roll is taken as 0.
  const double pitch = std::asin(std::clamp(r(2, 1), -1.0, 1.0));
  const bool upright = std::abs(r(2, 1)) > 1 - 1e-12;
  const double yaw = upright ? std::atan2(r(1, 0), r(0, 0)) : std::atan2(-r(0, 1), r(1, 1));
  const double roll = upright ? 0 : std::atan2(-r(2, 0), r(2, 2));
  return Vec3(deg_from_rad(yaw), deg_from_rad(pitch), deg_from_rad(roll)) + Vec3::Zero();
}

ImportedRig rig_of_mvr(const MvrFile& mvr, const std::string& rig_name) { return RigWriter(mvr).write(rig_name); }

}  // namespace luxrig
