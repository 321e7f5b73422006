#include "drivers/dmx/dmx_patch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/check.h"

namespace luxrig {
namespace {

constexpr double kAngleSlack_rad = 1e-6;

/// Most significant byte first, in the order of SlotUse.
struct ByteOfValue {
  SlotUse coarse;
  int byte;  // 0…2
};
ByteOfValue byte_of_value(SlotUse use) {
  const int index = static_cast<int>(use);
  return {static_cast<SlotUse>(index - index % 3), index % 3};
}
static_assert(static_cast<int>(SlotUse::pan) == 3 && static_cast<int>(SlotUse::tilt) == 6 &&
              static_cast<int>(SlotUse::zoom) == 9 && static_cast<int>(SlotUse::constant) == 12);

/// Number of the patch's slots that form this slot's value.
int bytes_of_value(const DmxPatch& patch, const DmxSlot& slot) {
  if (slot.use >= SlotUse::constant) return 1;
  const SlotUse coarse = byte_of_value(slot.use).coarse;
  int bytes = 1;
  for (const DmxSlot& other : patch.slots) {
    if (other.use >= SlotUse::constant || other.cell != slot.cell || byte_of_value(other.use).coarse != coarse)
      continue;
    bytes = std::max(bytes, byte_of_value(other.use).byte + 1);
  }
  return bytes;
}

/// A shutter slot: shut at level 0, open at any other. It shows no level.
bool is_shutter_at_dark(const DmxSlot& slot) {
  return slot.travel.at_dark && slot.travel.at_start == slot.travel.at_end;
}

}  // namespace

std::uint32_t encode_dmx(double value, int bytes) {
  return static_cast<std::uint32_t>(std::lround(value * ((1 << (8 * bytes)) - 1)));
}

double share_of_travel(double angle_rad, double from_rad, double to_rad) {
  if (to_rad == from_rad) return 0;
  return std::clamp((angle_rad - from_rad) / (to_rad - from_rad), 0.0, 1.0);
}

DmxPatchbay::DmxPatchbay(const Rig& rig, std::size_t bus) : bus_(rig.buses[bus].name) {
  std::set<int> numbers;
  for (const Fixture& fixture : rig.fixtures) {
    if (fixture.bus == bus) numbers.insert(std::get<DmxPatch>(fixture.patch).universe);
  }
  for (const int number : numbers) universes_.push_back({number, {}});

  for (std::size_t i = 0; i < rig.fixtures.size(); ++i) {
    const Fixture& fixture = rig.fixtures[i];
    if (fixture.bus != bus) continue;
    Entry entry;
    entry.name = fixture.name;
    entry.patch = std::get<DmxPatch>(fixture.patch);
    entry.range = fixture.sent_range();
    entry.moves = fixture.moves && (!fixture.axes || fixture.range.zooms());  // the zoom of a head on axes is here
    for (const DmxSlot& slot : entry.patch.slots) entry.bytes.push_back(bytes_of_value(entry.patch, slot));
    entry.universe = static_cast<std::size_t>(std::distance(numbers.begin(), numbers.find(entry.patch.universe)));
    entry.joints = fixture.joint_map ? fixture.joint_map->sent_for(fixture.joints, {}) : fixture.joints;
    has_heads_ = has_heads_ || entry.moves;
    encode(entry);
    entries_.emplace(i, std::move(entry));
  }
}

Fault DmxPatchbay::invalid(std::size_t fixture, std::string detail) const {
  const auto found = entries_.find(fixture);
  return {Cause::invalid, found == entries_.end() ? bus_ : found->second.name, std::move(detail), {}};
}

Result<void> DmxPatchbay::set_levels(std::span<const LevelCommand> commands) {
  for (const LevelCommand& command : commands) {
    if (!entries_.contains(command.fixture)) {
      return tl::unexpected(invalid(command.fixture, fmt::format("fixture {} is not on this bus", command.fixture)));
    }
    if (!(command.drive >= 0 && command.drive <= 1)) {  // also when NaN
      return tl::unexpected(invalid(command.fixture, fmt::format("drive {} is outside 0…1", command.drive)));
    }
  }
  for (const LevelCommand& command : commands) entries_.at(command.fixture).drive = command.drive;
  for (const auto& [index, entry] : entries_) encode(entry);
  return {};
}

Result<void> DmxPatchbay::set_aims(std::span<const AimCommand> commands) {
  const auto within = [](double angle, double lowest, double highest) {
    return angle >= lowest - kAngleSlack_rad && angle <= highest + kAngleSlack_rad;
  };
  for (const AimCommand& command : commands) {
    const auto found = entries_.find(command.fixture);
    if (found == entries_.end()) {
      return tl::unexpected(invalid(command.fixture, fmt::format("fixture {} is not on this bus", command.fixture)));
    }
    const Entry& entry = found->second;
    if (!entry.moves) return tl::unexpected(invalid(command.fixture, "this fixture has no pan and tilt"));
    const auto [pan, tilt, beam] = command.joints;
    if (!within(pan, entry.range.pan_min_rad, entry.range.pan_max_rad)) {
      return tl::unexpected(invalid(
          command.fixture, fmt::format("pan {}° is outside {}…{}°", deg_from_rad(pan),
                                       deg_from_rad(entry.range.pan_min_rad), deg_from_rad(entry.range.pan_max_rad))));
    }
    if (!within(tilt, entry.range.tilt_min_rad, entry.range.tilt_max_rad)) {
      return tl::unexpected(invalid(command.fixture, fmt::format("tilt {}° is outside {}…{}°", deg_from_rad(tilt),
                                                                 deg_from_rad(entry.range.tilt_min_rad),
                                                                 deg_from_rad(entry.range.tilt_max_rad))));
    }
    if (entry.range.zooms() && !within(beam, entry.range.beam_min_rad, entry.range.beam_max_rad)) {
      return tl::unexpected(
          invalid(command.fixture,
                  fmt::format("a beam angle of {}° is outside {}…{}°", deg_from_rad(beam),
                              deg_from_rad(entry.range.beam_min_rad), deg_from_rad(entry.range.beam_max_rad))));
    }
  }
  for (const AimCommand& command : commands) entries_.at(command.fixture).joints = command.joints;
  return {};
}

void DmxPatchbay::encode(const Entry& entry) {
  const double pan = share_of_travel(entry.joints.pan_rad, entry.range.pan_min_rad, entry.range.pan_max_rad);
  const double tilt = share_of_travel(entry.joints.tilt_rad, entry.range.tilt_min_rad, entry.range.tilt_max_rad);
  const double zoom = share_of_travel(entry.joints.beam_rad, entry.range.beam_min_rad, entry.range.beam_max_rad);
  const auto byte_of = [&](std::size_t i) -> std::uint32_t {
    const DmxSlot& slot = entry.patch.slots[i];
    if (slot.use == SlotUse::constant) return static_cast<std::uint32_t>(slot.constant_dmx);
    const auto [coarse, byte] = byte_of_value(slot.use);
    const double share = coarse == SlotUse::pan    ? pan
                         : coarse == SlotUse::tilt ? tilt
                         : coarse == SlotUse::zoom ? zoom
                                                   : entry.drive;
    // If a value has a fine byte, the coarse byte is its high byte; else it is the whole value in 8 bits.
    return encode_dmx(slot.travel.at(share), entry.bytes[i]) >> (8 * (entry.bytes[i] - 1 - byte)) & 0xFF;
  };
  DmxSlots& out = universes_[entry.universe].slots;
  for (std::size_t i = 0; i < entry.patch.slots.size(); ++i) {
    const DmxSlot& slot = entry.patch.slots[i];
    if (slot.use == SlotUse::unused || !slot.sent) continue;
    out[static_cast<std::size_t>(entry.patch.address - 1) + i] = static_cast<std::uint8_t>(byte_of(i));
  }
}

DmxSlots DmxPatchbay::used_slots(std::size_t universe) const {
  DmxSlots used{};
  for (const auto& [index, entry] : entries_) {
    if (entry.universe != universe) continue;
    for (std::size_t i = 0; i < entry.patch.slots.size(); ++i) {
      if (entry.patch.slots[i].use == SlotUse::unused) continue;
      used[static_cast<std::size_t>(entry.patch.address - 1) + i] = 1;
    }
  }
  return used;
}

std::vector<std::size_t> DmxPatchbay::fixtures_of(std::size_t universe) const {
  std::vector<std::size_t> fixtures;
  for (const auto& [index, entry] : entries_) {
    if (entry.universe == universe) fixtures.push_back(index);
  }
  return fixtures;
}

/// Share 0…1 of level or travel in a cell's slots; empty if one of them is not given.
std::optional<double> DmxPatchbay::share_in_cell(const Entry& entry, std::size_t coarse_slot, const DmxSlots& slots,
                                                 const std::bitset<kDmxSlots>& given) {
  const DmxSlot& coarse = entry.patch.slots[coarse_slot];
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < entry.patch.slots.size(); ++i) {
    const DmxSlot& slot = entry.patch.slots[i];
    if (slot.use >= SlotUse::constant || slot.cell != coarse.cell) continue;
    const auto [use, byte] = byte_of_value(slot.use);
    if (use != coarse.use) continue;
    const std::size_t at = static_cast<std::size_t>(entry.patch.address - 1) + i;
    if (!given[at]) return std::nullopt;
    value |= static_cast<std::uint32_t>(slots[at]) << (8 * (entry.bytes[coarse_slot] - 1 - byte));
  }
  const double share = value / static_cast<double>((1u << (8 * entry.bytes[coarse_slot])) - 1);
  const DmxTravel& travel = coarse.travel;
  const bool below = travel.at_end > travel.at_start ? share < travel.at_start : share > travel.at_start;
  if (below && travel.at_dark) return 0;
  return travel.least + (1 - travel.least) * share_of_travel(share, travel.at_start, travel.at_end);
}

std::vector<DeskCommand> DmxPatchbay::decode(std::size_t universe, const DmxSlots& slots,
                                             const std::bitset<kDmxSlots>& given) const {
  std::vector<DeskCommand> commands;
  for (const auto& [index, entry] : entries_) {
    if (entry.universe != universe) continue;
    // Of several cells the highest counts: the fixture has one level here.
    const auto value_of = [&, &of = entry](SlotUse use) {
      std::optional<double> highest;
      for (std::size_t i = 0; i < of.patch.slots.size(); ++i) {
        if (of.patch.slots[i].use != use || is_shutter_at_dark(of.patch.slots[i])) continue;
        const auto share = share_in_cell(of, i, slots, given);
        if (!share) return std::optional<double>();
        highest = std::max(highest.value_or(0), *share);
      }
      return highest;
    };
    const auto drive = value_of(SlotUse::dimmer);
    if (!drive) continue;
    DeskCommand command{index, *drive, std::nullopt};
    const auto pan = value_of(SlotUse::pan), tilt = value_of(SlotUse::tilt);
    if (entry.moves && pan && tilt) {
      const JointRange& range = entry.range;
      command.joints =
          Joints{range.pan_min_rad + *pan * (range.pan_max_rad - range.pan_min_rad),
                 range.tilt_min_rad + *tilt * (range.tilt_max_rad - range.tilt_min_rad), entry.joints.beam_rad};
      const auto zoom = range.zooms() ? value_of(SlotUse::zoom) : std::nullopt;
      if (zoom) command.joints->beam_rad = range.beam_min_rad + *zoom * (range.beam_max_rad - range.beam_min_rad);
    }
    commands.push_back(command);
  }
  return commands;
}

std::vector<Problem> check_dmx_patch(const Rig& rig, std::size_t bus, int lowest_universe, int highest_universe) {
  std::vector<Problem> problems;
  const std::string& name = rig.buses[bus].name;
  const auto report = [&](const FilePosition& in_file, std::string what, std::string mend) {
    problems.push_back({rig.file.string(), in_file.line, in_file.column, std::move(what), std::move(mend)});
  };
  for (const Fixture& fixture : rig.fixtures) {
    if (fixture.bus != bus) continue;
    const auto* patch = std::get_if<DmxPatch>(&fixture.patch);
    if (patch == nullptr) {
      report(fixture.in_file,
             fmt::format("fixture \"{}\" has a Modbus register, but its bus \"{}\" carries DMX", fixture.name, name),
             "give it universe and address in place of unit and register, or another bus");
      continue;
    }
    if (patch->universe < lowest_universe || patch->universe > highest_universe) {
      report(fixture.in_file,
             fmt::format("fixture \"{}\": universe {} does not exist on a {} bus", fixture.name, patch->universe,
                         rig.buses[bus].driver),
             fmt::format("choose a universe in {}…{}", lowest_universe, highest_universe));
    }
    const auto last = patch->address + static_cast<std::int64_t>(patch->slots.size()) - 1;
    if (patch->address < 1 || last > static_cast<std::int64_t>(kDmxSlots)) {
      report(fixture.in_file,
             fmt::format("fixture \"{}\" takes slots {}…{} of a universe that has 1…512", fixture.name, patch->address,
                         last),
             fmt::format("choose an address in 1…{}",
                         static_cast<std::int64_t>(kDmxSlots) + 1 - static_cast<std::int64_t>(patch->slots.size())));
    }
  }
  for (const Luxmeter& meter : rig.luxmeters) {
    if (meter.bus != bus) continue;
    report(meter.in_file,
           fmt::format("luxmeter \"{}\" is on the bus \"{}\", which carries DMX and cannot be read from", meter.name,
                       name),
           "put it on a bus with driver = \"modbus_tcp\"");
  }
  return problems;
}

}  // namespace luxrig
