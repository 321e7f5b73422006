#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "core/rig/null_bus.h"
#include "core/rig/reading/dmx_slots.h"
#include "core/rig/reading/mode_slots.h"
#include "core/rig/reading/rig_reader.h"

namespace luxrig {
namespace {

constexpr std::string_view kDmxKeys[] = {"universe", "address", "slots", "personality", "mode", "dimmer"};
constexpr std::string_view kModbusKeys[] = {"unit", "register", "full_scale", "register_map", "channel", "output"};
constexpr std::string_view kTravelKeys[] = {"pan_range_deg", "tilt_range_deg", "pan_speed_deg_s", "tilt_speed_deg_s"};
constexpr std::string_view kAxisKeys[] = {
    "pan_node",     "tilt_node",     "pan_counts_per_degree",   "tilt_counts_per_degree",
    "pan_home_deg", "tilt_home_deg", "pan_acceleration_deg_s2", "tilt_acceleration_deg_s2"};
constexpr double kNearest_m = 0.001;  // a nearer aim has no useful direction

enum class PatchKind { none, dmx, modbus };

/// `planned`: on a null bus, where no fixture has an address yet.
PatchKind patch_kind(Section& s, bool planned, ProblemList& problems) {
  const auto any = [&](std::span<const std::string_view> keys) {
    for (const std::string_view key : keys) {
      if (s.has(key)) return true;
    }
    return false;
  };
  const bool dmx = any(kDmxKeys), modbus = any(kModbusKeys);
  if (dmx != modbus) return dmx ? PatchKind::dmx : PatchKind::modbus;
  if (planned && !dmx) return PatchKind::dmx;
  problems.add(
      s.in_file(), dmx ? "[[fixture]] has both a DMX and a Modbus address" : "[[fixture]] has no address",
      "give it universe, address and slots (DMX), or unit and register_map, or unit, register and full_scale (Modbus)");
  return PatchKind::none;
}

/// `joint` is "pan" or "tilt". False if it cannot be claimed.
bool read_axis(Section& s, const std::string& joint, AxisPatch& axis) {
  for (const char* key : {"_node", "_counts_per_degree", "_home_deg"}) {
    if (!s.has(joint + key)) s.require(joint + key, "which a head with an axes_bus needs");
  }
  const std::string counts = joint + "_counts_per_degree";
  if (s.read(counts, axis.counts_per_degree) && axis.counts_per_degree == 0) {
    s.problems().add(s.place_of(counts), fmt::format("{} is 0, so that every angle is the same to the drive", counts),
                     "give the position units of the drive per degree of the joint");
  }
  s.read_deg(joint + "_home_deg", axis.home_rad);
  axis.acceleration_rad_s2 = rad_from_deg(s.number(joint + "_acceleration_deg_s2"));
  return s.read(joint + "_node", axis.node);
}

/// `stated_rad_s`: by its maker's file, which holds where the key is left out; 0: it states none.
double speed_rad_s(Section& s, std::string_view key, double stated_rad_s) {
  return stated_rad_s > 0 && !s.has(key) ? stated_rad_s : rad_from_deg(s.number(key));
}

/// `stated`: travel from its maker's file; null = none.
void read_travel(Section& s, const ModeSlots* stated, Fixture& fixture) {
  if (!fixture.moves) {
    for (const std::string_view key : kTravelKeys) {
      s.refuse(key, fmt::format("{} has no effect: the fixture does not move", key),
               stated ? "remove it: this mode of its personality has no pan and tilt"
                      : "add \"pan\" and \"tilt\" to its slots, give it an axes_bus, or remove this key");
    }
    return;
  }
  std::pair<double, double> range_deg;
  if (stated) {
    fixture.range = stated->range;  // already narrowed by the two keys
  } else if (s.read("pan_range_deg", range_deg)) {
    fixture.range.pan_min_rad = rad_from_deg(range_deg.first);
    fixture.range.pan_max_rad = rad_from_deg(range_deg.second);
  }
  if (!stated && s.read("tilt_range_deg", range_deg)) {
    fixture.range.tilt_min_rad = rad_from_deg(range_deg.first);
    fixture.range.tilt_max_rad = rad_from_deg(range_deg.second);
  }
  fixture.pan_speed_rad_s = speed_rad_s(s, "pan_speed_deg_s", stated ? stated->pan_speed_rad_s : 0);
  fixture.tilt_speed_rad_s = speed_rad_s(s, "tilt_speed_deg_s", stated ? stated->tilt_speed_rad_s : 0);
}

bool has_zoom_slot(const Fixture& fixture) {
  const auto* dmx = std::get_if<DmxPatch>(&fixture.patch);
  return dmx && std::any_of(dmx->slots.begin(), dmx->slots.end(),
                            [](const DmxSlot& slot) { return slot.use == SlotUse::zoom; });
}

/// `luminaire`: null if unknown, which is reported.
void read_zoom(Section& s, const Luminaire* luminaire, const ModeSlots* stated, Fixture& fixture) {
  const bool zooms = has_zoom_slot(fixture);
  if (!zooms) {
    for (const char* key : {"zoom_inverted", "zoom_speed_deg_s"})
      s.refuse(key, fmt::format("{} has no effect: the fixture does not zoom", key),
               stated ? "remove it: no zoom of its personality is used (zoom_deg of its luminaire asks for that)"
                      : "add \"zoom\" to its slots, or remove this key");
    return;
  }
  if (!luminaire) return;
  if (!luminaire->zoom_beam_rad) {
    s.problems().add(
        s.place_of("slots"),
        fmt::format("a zoom slot, but luminaire {} does not say what it zooms through", in_quotes(luminaire->name)),
        "give the luminaire zoom_deg, or hold the slot with \"constant:N\"");
    return;
  }
  if (stated) {
    s.refuse("zoom_inverted", "zoom_inverted has no effect: the personality says which end is wide", "remove it");
    fixture.range.beam_min_rad = stated->range.beam_min_rad;
    fixture.range.beam_max_rad = stated->range.beam_max_rad;
  } else {
    std::tie(fixture.range.beam_min_rad, fixture.range.beam_max_rad) = *luminaire->zoom_beam_rad;
    const bool inverted = s.yes_no("zoom_inverted");
    for (DmxSlot& slot : std::get<DmxPatch>(fixture.patch).slots)
      if (inverted && slot.use >= SlotUse::zoom && slot.use <= SlotUse::zoom_ultra) slot.travel = {1, 0};
  }
  fixture.joints.beam_rad = luminaire->beam_angle_rad;
  fixture.zoom_speed_rad_s = speed_rad_s(s, "zoom_speed_deg_s", stated ? stated->zoom_speed_rad_s : 0);
}

SlotOwner slot_owner_of(const Rig& rig, std::size_t luminaire) {
  SlotOwner owner{rig.luminaires[luminaire].name, {}};
  for (const std::size_t emitter : rig.luminaires[luminaire].emitters)
    owner.emitters.push_back(rig.luminaires[emitter].name.substr(owner.luminaire.size() + 1));
  return owner;
}

}  // namespace

void RigReader::read_axes(Section& s, Fixture& fixture) {
  if (!s.has("axes_bus")) {
    for (const std::string_view key : kAxisKeys)
      s.refuse(key, fmt::format("{} has no effect without axes_bus", key), "add axes_bus, or remove this key");
    return;
  }
  if (fixture.moves) {
    problems.add(s.place_of("axes_bus"), "its pan and tilt are both slots of its address and drives on axes_bus",
                 "keep one of the two");
    return;
  }
  AxesPatch axes;
  const auto bus = buses.read_reference(s, "axes_bus");
  if (bus) axes.bus = *bus;
  const bool pan = read_axis(s, "pan", axes.pan), tilt = read_axis(s, "tilt", axes.tilt);
  const std::string what = "fixture " + in_quotes(fixture.name);
  if (bus && pan) patches.claim_node(*bus, axes.pan.node, {"the pan of " + what, s.place_of("pan_node")});
  if (bus && tilt) patches.claim_node(*bus, axes.tilt.node, {"the tilt of " + what, s.place_of("tilt_node")});
  fixture.axes = axes;
  fixture.moves = true;
}

void RigReader::check_joints(Section& s, const Fixture& fixture, const Joints& at, const std::string& prefix) {
  if (!fixture.moves) return;
  const auto check = [&](const std::string& key, double at_rad, double min_rad, double max_rad) {
    if (at_rad >= min_rad - 1e-9 && at_rad <= max_rad + 1e-9) return;
    problems.add(s.place_of(key),
                 fmt::format("{} {:g} is outside the travel of {:g} to {:g}", key, deg_from_rad(at_rad),
                             deg_from_rad(min_rad), deg_from_rad(max_rad)),
                 "turn it within its travel, or correct the travel");
  };
  check(prefix + "pan_deg", at.pan_rad, fixture.range.pan_min_rad, fixture.range.pan_max_rad);
  check(prefix + "tilt_deg", at.tilt_rad, fixture.range.tilt_min_rad, fixture.range.tilt_max_rad);
}

void RigReader::read_park(Section& s, Fixture& fixture) {
  if (!fixture.moves) {
    for (const char* key : {"park_pan_deg", "park_tilt_deg", "reset_s"})
      s.refuse(key, fmt::format("{} has no effect: the fixture does not move", key), "remove it");
    return;
  }
  s.read("reset_s", fixture.reset_s);
  if (!s.has("park_pan_deg") && !s.has("park_tilt_deg")) return;
  Joints park;
  park.beam_rad = fixture.joints.beam_rad;
  const bool pan = s.read_deg("park_pan_deg", park.pan_rad) || !s.has("park_pan_deg");
  const bool tilt = s.read_deg("park_tilt_deg", park.tilt_rad) || !s.has("park_tilt_deg");
  if (!pan || !tilt) return;
  check_joints(s, fixture, park, "park_");
  fixture.park = park;
}

void RigReader::read_aim(Section& s, Fixture& fixture) {
  const bool joints = s.has("pan_deg") || s.has("tilt_deg");
  if (s.has("aim") + s.has("aim_m") + joints > 1) {
    problems.add(s.in_file(), "[[fixture]] says more than once where it looks",
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
    if (pan && tilt) check_joints(s, fixture, fixture.joints, "");
    return;
  }
  const Vec3 direction_world = *fixture.aim_world_m - fixture.world_from_mount.translation_m;
  if (!direction_world.allFinite()) return;  // one of the two is wrong and reported
  if (direction_world.norm() < kNearest_m) {
    problems.add(s.place_of(key), "the fixture stands where it shall look", "aim it at another place, or move it");
    return;
  }
  const JointRange anywhere{-2 * kPi, 2 * kPi, -2 * kPi, 2 * kPi};
  const auto wanted = pan_tilt_towards(fixture.world_from_mount, direction_world, anywhere, {});
  const auto reached =
      fixture.moves ? pan_tilt_towards(fixture.world_from_mount, direction_world, fixture.range, {}) : wanted;
  if (reached) {
    fixture.joints = {reached->pan_rad, reached->tilt_rad, fixture.joints.beam_rad};
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

void RigReader::read_switched(Section& s, bool has_emitters, bool steps, Fixture& fixture) {
  const auto* modbus = std::get_if<ModbusPatch>(&fixture.patch);
  const bool coil = modbus != nullptr && modbus->coil;
  if (s.read("switched", fixture.switched) && coil && !fixture.switched)
    problems.add(s.place_of("switched"), "it hangs on a coil, which is on or off", "remove switched");
  if (steps && s.has("switched") && !fixture.switched)
    problems.add(s.place_of("switched"), "the dimmer of this mode is on or off",
                 "remove switched, or choose another mode");
  fixture.switched = fixture.switched || coil || steps;
  if (!fixture.switched) return;
  const std::string_view cannot = coil    ? "it hangs on a coil, and is on or off"
                                  : steps ? "the dimmer of its mode is on or off"
                                          : "it is switched: on or off";
  const auto wrong = [&](std::string_view key, const std::string& what, const std::string& mend) {
    problems.add(s.place_of(s.has(key) ? key : "name"), fmt::format("{}: {}", cannot, what), mend);
  };
  if (has_emitters)
    wrong("switched", "the emitters of its luminaire would mix no colour", "use a luminaire of one light");
  s.refuse("dimmer_curve", fmt::format("{}: dimmer_curve has no effect", cannot), "remove dimmer_curve");
  fixture.dimmer_curve = DimmerCurve::linear;
  if (fixture.max_level > 0 && fixture.max_level < 1)
    wrong("max_level", fmt::format("max_level {} keeps it off", fixture.max_level), "make it 1, or 0 to keep it off");
  if (fixture.max_level > 0 && rig.limits.max_level > 0 && rig.limits.max_level < 1)
    wrong("switched", fmt::format("max_level {} of [limits] keeps it off", rig.limits.max_level),
          "raise that to 1 and give max_level to the fixtures that dim, or put this one on a dimmer");
}

void RigReader::read_fixtures() {
  each(root, "fixture", [&](Section& s) {
    Fixture fixture;
    fixture.in_file = s.in_file();
    if (s.read("name", fixture.name)) fixtures.add(fixture.name, rig.fixtures.size(), s.place_of("name"), problems);
    std::optional<SlotOwner> slot_owner;
    if (const auto index = luminaires.read_reference(s, "luminaire")) {
      fixture.luminaire = *index;
      slot_owner = slot_owner_of(rig, *index);
    }
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

    const PatchMap::Owner owner{"fixture " + in_quotes(fixture.name), s.place_of(s.has("address")    ? "address"
                                                                                 : s.has("register") ? "register"
                                                                                                     : "register_map")};
    const bool planned = bus && is_null_bus(rig.buses[*bus]);
    const PatchKind kind = patch_kind(s, planned, problems);
    std::vector<NamedSlot> slots;
    std::optional<ModeSlots> of_mode;
    if (kind == PatchKind::dmx && read_dmx(s, slot_owner, planned, fixture, slots, of_mode) && bus) {
      const auto& dmx = std::get<DmxPatch>(fixture.patch);
      if (!planned) patches.claim_slots(*bus, dmx.universe, dmx.address, static_cast<int>(dmx.slots.size()), owner);
    } else if (kind == PatchKind::modbus && read_modbus(s, slot_owner, fixture) && bus) {
      const auto& modbus = std::get<ModbusPatch>(fixture.patch);
      if (!planned)
        patches.claim_registers(*bus, modbus.unit, modbus.coil ? RegisterTable::coil : RegisterTable::holding,
                                modbus.holding_register, modbus.format.registers, owner);
    }
    // If a personality cannot be used, it is unknown whether the fixture moves, so nothing is reported about that.
    if (of_mode || !s.has("personality")) {
      read_axes(s, fixture);
      const ModeSlots* stated = of_mode && !fixture.axes ? &*of_mode : nullptr;
      read_travel(s, stated, fixture);
      read_zoom(s, slot_owner ? &rig.luminaires[fixture.luminaire] : nullptr, of_mode ? &*of_mode : nullptr, fixture);
      read_aim(s, fixture);
      read_park(s, fixture);
    }
    s.read("stage", fixture.stage);
    if (of_mode && of_mode->dimmer_curve) fixture.dimmer_curve = *of_mode->dimmer_curve;

    s.read_choice("dimmer_curve", fixture.dimmer_curve);
    s.read("max_level", fixture.max_level);
    read_switched(s, slot_owner && !slot_owner->emitters.empty(), of_mode && of_mode->steps, fixture);
    if (s.read("safe_level", fixture.safe_level) && *fixture.safe_level > fixture.max_level) {
      problems.add(s.place_of("safe_level"),
                   fmt::format("safe_level {} is above max_level {}", *fixture.safe_level, fixture.max_level),
                   "lower safe_level, or raise max_level");
    }
    if (fixture.switched && fixture.safe_level && *fixture.safe_level > 0 && *fixture.safe_level < 1) {
      problems.add(s.place_of("safe_level"), fmt::format("safe_level {} of what is on or off", *fixture.safe_level),
                   "make it 0 or 1");
    }
    if (!slot_owner || slot_owner->emitters.empty()) {
      rig.fixtures.push_back(std::move(fixture));
      return;
    }
    const std::size_t housing = rig.fixtures.size();
    for (std::size_t e = 0; e < slot_owner->emitters.size(); ++e) {
      Fixture part = fixture;
      part.name = fixture.name + "/" + slot_owner->emitters[e];
      part.luminaire = rig.luminaires[fixture.luminaire].emitters[e];
      part.housing = housing;
      if (auto* dmx = std::get_if<DmxPatch>(&part.patch)) dmx->slots = slots_of(slots, e);
      if (part.mode) part.mode->emitter = slot_owner->emitters[e];
      fixtures.add(part.name, rig.fixtures.size(), s.place_of("name"), problems);
      rig.fixtures.push_back(std::move(part));
    }
  });
}

}  // namespace luxrig
