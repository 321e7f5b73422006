#include <fmt/format.h>

#include <charconv>
#include <set>

#include "core/rig/nearest.h"
#include "core/rig/rig_reader.h"

namespace luxrig {
namespace {

constexpr std::string_view kDmxKeys[] = {"universe", "address", "slots"};
constexpr std::string_view kModbusKeys[] = {"unit", "register", "full_scale"};
constexpr std::string_view kTravelKeys[] = {"pan_range_deg", "tilt_range_deg", "pan_speed_deg_s", "tilt_speed_deg_s"};
constexpr double kNearest_m = 0.001;  // an aim nearer than this has no direction worth the name

// In the order of SlotUse; a constant carries its number.
constexpr std::string_view kSlotNames[] = {"dimmer", "dimmer-fine", "pan",       "pan-fine",
                                           "tilt",   "tilt-fine",   "constant:", "unused"};

std::string_view name_of(SlotUse use) { return kSlotNames[static_cast<std::size_t>(use)]; }

std::optional<DmxSlot> slot_from(const std::string& text, const Place& place, ProblemList& problems) {
  const std::string_view constant = name_of(SlotUse::constant);
  if (text.starts_with(constant)) {
    int value = -1;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + constant.size(), end, value);
    if (error == std::errc{} && stop == end && value >= 0 && value <= 255) return DmxSlot{SlotUse::constant, value};
    problems.add(place, fmt::format("slot {} has no value from 0 to 255", in_quotes(text)),
                 "write it as \"constant:255\"");
    return std::nullopt;
  }
  for (std::size_t i = 0; i < std::size(kSlotNames); ++i) {
    if (text == kSlotNames[i]) return DmxSlot{static_cast<SlotUse>(i), 0};
  }
  problems.add(place, fmt::format("no slot is called {}", in_quotes(text)), mend_for_unknown(text, kSlotNames, ""));
  return std::nullopt;
}

/// What the slots of a fixture need of one another.
bool check_slots(const std::vector<DmxSlot>& slots, const std::vector<Place>& places, const Place& list,
                 ProblemList& problems) {
  bool good = true;
  std::set<SlotUse> uses;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const SlotUse use = slots[i].use;
    if (use == SlotUse::constant || use == SlotUse::unused || uses.insert(use).second) continue;
    problems.add(places[i], fmt::format("a second {} slot", name_of(use)),
                 "leave one; a further cell or lamp is a fixture of its own");
    good = false;
  }
  for (const auto& [fine, coarse] :
       {std::pair{SlotUse::dimmer_fine, SlotUse::dimmer}, std::pair{SlotUse::pan_fine, SlotUse::pan},
        std::pair{SlotUse::tilt_fine, SlotUse::tilt}}) {
    if (!uses.contains(fine) || uses.contains(coarse)) continue;
    problems.add(list, fmt::format("a {} slot without a {} slot", name_of(fine), name_of(coarse)),
                 fmt::format("add \"{}\" where the coarse byte is, or make the fine one \"unused\"", name_of(coarse)));
    good = false;
  }
  if (!uses.contains(SlotUse::dimmer) && !uses.contains(SlotUse::dimmer_fine)) {
    problems.add(list, "no dimmer slot", "add \"dimmer\": every fixture is set by its level");
    good = false;
  }
  if (uses.contains(SlotUse::pan) != uses.contains(SlotUse::tilt)) {
    problems.add(list,
                 uses.contains(SlotUse::pan) ? "a pan slot without a tilt slot" : "a tilt slot without a pan slot",
                 "give both, or hold the one with \"constant:N\"");
    good = false;
  }
  return good;
}

/// Reads the DMX patch; true when its slots can be claimed.
bool read_dmx(Section& s, Fixture& fixture, ProblemList& problems) {
  DmxPatch patch;
  bool good = true;
  s.read("universe", patch.universe);
  if (!s.has("address")) s.require("address", "which DMX needs");
  good &= s.read("address", patch.address);
  std::vector<std::pair<std::string, Place>> names;
  if (s.read_texts("slots", names)) {
    std::vector<Place> places;
    patch.slots.clear();
    for (const auto& [name, place] : names) {
      if (const auto slot = slot_from(name, place, problems)) {
        patch.slots.push_back(*slot);
        places.push_back(place);
      }
      if (problems.full()) break;
    }
    good &= patch.slots.size() == names.size() && check_slots(patch.slots, places, s.place_of("slots"), problems);
  } else {
    good &= !s.has("slots");
  }
  const auto count = static_cast<int>(std::min<std::size_t>(patch.slots.size(), 10000));
  if (good && patch.address + count - 1 > 512) {
    problems.add(s.place_of("address"),
                 fmt::format("{} slots from address {} end at {}, past slot 512", count, patch.address,
                             patch.address + count - 1),
                 count <= 512 ? fmt::format("use address {} or lower", 513 - count) : "a universe has 512 slots");
    good = false;
  }
  for (const DmxSlot& slot : patch.slots) fixture.moves |= slot.use == SlotUse::pan || slot.use == SlotUse::tilt;
  fixture.patch = std::move(patch);
  return good;
}

bool read_modbus(Section& s, Fixture& fixture) {
  ModbusPatch patch;
  bool good = s.read("unit", patch.unit) || !s.has("unit");
  if (!s.has("register")) s.require("register", "which a Modbus dimmer needs");
  good &= s.read("register", patch.holding_register);
  s.read("full_scale", patch.full_scale_raw);
  fixture.patch = patch;
  return good;
}

enum class PatchKind { none, dmx, modbus };

PatchKind patch_kind(Section& s, ProblemList& problems) {
  const auto any = [&](std::span<const std::string_view> keys) {
    for (const std::string_view key : keys) {
      if (s.has(key)) return true;
    }
    return false;
  };
  const bool dmx = any(kDmxKeys), modbus = any(kModbusKeys);
  if (dmx != modbus) return dmx ? PatchKind::dmx : PatchKind::modbus;
  problems.add(s.place(), dmx ? "[[fixture]] has both a DMX and a Modbus address" : "[[fixture]] has no address",
               "give it universe, address and slots (DMX), or unit, register and full_scale (Modbus)");
  return PatchKind::none;
}

void read_travel(Section& s, Fixture& fixture) {
  if (!fixture.moves) {
    for (const std::string_view key : kTravelKeys) {
      s.refuse(key, fmt::format("{} has no effect: the fixture does not move", key),
               "add \"pan\" and \"tilt\" to its slots, or remove this key");
    }
    return;
  }
  std::pair<double, double> range_deg;
  if (s.read("pan_range_deg", range_deg)) {
    fixture.range.pan_min_rad = rad_from_deg(range_deg.first);
    fixture.range.pan_max_rad = rad_from_deg(range_deg.second);
  }
  if (s.read("tilt_range_deg", range_deg)) {
    fixture.range.tilt_min_rad = rad_from_deg(range_deg.first);
    fixture.range.tilt_max_rad = rad_from_deg(range_deg.second);
  }
  fixture.pan_speed_rad_s = rad_from_deg(180);
  fixture.tilt_speed_rad_s = rad_from_deg(120);
  s.read_deg("pan_speed_deg_s", fixture.pan_speed_rad_s);
  s.read_deg("tilt_speed_deg_s", fixture.tilt_speed_rad_s);
}

}  // namespace

void RigReader::check_joints(Section& s, const Fixture& fixture) {
  if (!fixture.moves) return;
  const auto check = [&](std::string_view key, double at_rad, double min_rad, double max_rad) {
    if (at_rad >= min_rad - 1e-9 && at_rad <= max_rad + 1e-9) return;
    problems.add(s.place_of(key),
                 fmt::format("{} {:g} is outside the travel of {:g} to {:g}", key, deg_from_rad(at_rad),
                             deg_from_rad(min_rad), deg_from_rad(max_rad)),
                 "turn it within its travel, or correct the travel");
  };
  check("pan_deg", fixture.joints.pan_rad, fixture.range.pan_min_rad, fixture.range.pan_max_rad);
  check("tilt_deg", fixture.joints.tilt_rad, fixture.range.tilt_min_rad, fixture.range.tilt_max_rad);
}

void RigReader::read_aim(Section& s, Fixture& fixture) {
  const bool joints = s.has("pan_deg") || s.has("tilt_deg");
  if (s.has("aim") + s.has("aim_m") + joints > 1) {
    problems.add(s.place(), "[[fixture]] says more than once where it looks",
                 "keep one of aim, aim_m, and pan_deg with tilt_deg");
    return;
  }
  const std::string_view key = s.has("aim") ? "aim" : "aim_m";
  if (s.has("aim")) {
    const auto index = points.read_reference(s, "aim");
    if (!index) return;
    fixture.aim_world_m = rig.points[*index].position_world_m;
  } else if (s.has("aim_m")) {
    if (!s.read("aim_m", fixture.aim_world_m)) return;
  } else {
    const bool pan = s.read_deg("pan_deg", fixture.joints.pan_rad) || !s.has("pan_deg");
    const bool tilt = s.read_deg("tilt_deg", fixture.joints.tilt_rad) || !s.has("tilt_deg");
    if (pan && tilt) check_joints(s, fixture);
    return;
  }
  const Vec3 direction_world = *fixture.aim_world_m - fixture.world_from_mount.translation_m;
  if (!direction_world.allFinite()) return;  // one of the two is wrong, and reported
  if (direction_world.norm() < kNearest_m) {
    problems.add(s.place_of(key), "the fixture stands where it shall look", "aim it at another place, or move it");
    return;
  }
  const PanTiltRange anywhere{-2 * kPi, 2 * kPi, -2 * kPi, 2 * kPi};
  const auto wanted = pan_tilt_towards(fixture.world_from_mount, direction_world, anywhere, {});
  const auto reached =
      fixture.moves ? pan_tilt_towards(fixture.world_from_mount, direction_world, fixture.range, {}) : wanted;
  if (reached) {
    fixture.joints = *reached;
    return;
  }
  problems.add(s.place_of(key),
               fmt::format("its aim needs pan {:.1f}° and tilt {:.1f}°, out of reach of pan {:g} to {:g} and tilt "
                           "{:g} to {:g}",
                           deg_from_rad(wanted->pan_rad), deg_from_rad(wanted->tilt_rad),
                           deg_from_rad(fixture.range.pan_min_rad), deg_from_rad(fixture.range.pan_max_rad),
                           deg_from_rad(fixture.range.tilt_min_rad), deg_from_rad(fixture.range.tilt_max_rad)),
               "aim it elsewhere, or turn its base with mount_deg");
}

void RigReader::read_fixtures() {
  NameIndex fixtures("fixture");
  each(root, "fixture", [&](Section& s) {
    Fixture fixture;
    fixture.place = s.place();
    if (s.read("name", fixture.name)) fixtures.add(fixture.name, rig.fixtures.size(), s.place_of("name"), problems);
    if (const auto index = luminaires.read_reference(s, "luminaire")) fixture.luminaire = *index;
    const auto bus = buses.read_reference(s, "bus");
    if (bus) fixture.bus = *bus;

    fixture.world_from_mount.translation_m.setConstant(std::numeric_limits<double>::quiet_NaN());  // until known
    s.read("position_m", fixture.world_from_mount.translation_m);
    Vec3 mount_deg = Vec3::Zero();
    s.read("mount_deg", mount_deg);
    fixture.world_from_mount.rotation = (Eigen::AngleAxisd(rad_from_deg(mount_deg[0]), Vec3::UnitZ()) *
                                         Eigen::AngleAxisd(rad_from_deg(mount_deg[1]), Vec3::UnitX()) *
                                         Eigen::AngleAxisd(rad_from_deg(mount_deg[2]), Vec3::UnitY()))
                                            .toRotationMatrix();
    s.read_deg("roll_deg", fixture.roll_rad);

    const PatchMap::Owner owner{"fixture " + in_quotes(fixture.name),
                                s.place_of(s.has("address") ? "address" : "register")};
    const PatchKind kind = patch_kind(s, problems);
    if (kind == PatchKind::dmx && read_dmx(s, fixture, problems) && bus) {
      const auto& dmx = std::get<DmxPatch>(fixture.patch);
      patches.claim_slots(*bus, dmx.universe, dmx.address, static_cast<int>(dmx.slots.size()), owner);
    } else if (kind == PatchKind::modbus && read_modbus(s, fixture) && bus) {
      const auto& modbus = std::get<ModbusPatch>(fixture.patch);
      patches.claim_registers(*bus, modbus.unit, false, modbus.holding_register, 1, owner);
    }
    read_travel(s, fixture);
    read_aim(s, fixture);

    s.read_choice("dimmer_curve", fixture.dimmer_curve);
    s.read("max_level", fixture.max_level);
    if (s.read("safe_level", fixture.safe_level) && *fixture.safe_level > fixture.max_level) {
      problems.add(s.place_of("safe_level"),
                   fmt::format("safe_level {} is above max_level {}", *fixture.safe_level, fixture.max_level),
                   "lower safe_level, or raise max_level");
    }
    rig.fixtures.push_back(std::move(fixture));
  });
}

}  // namespace luxrig
