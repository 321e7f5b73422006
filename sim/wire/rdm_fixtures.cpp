#include "sim/wire/rdm_fixtures.h"

#include <algorithm>

namespace luxrig::sim {
namespace {

constexpr std::uint64_t kPrototypes = 0x7ff0;
constexpr int kFixedFixture = 0x0101, kMovingHead = 0x0102;

// Table C-2 of E1.20. A fine slot names its coarse slot: the coarse slots directly precede their fine ones.
RdmSlot slot_of(SlotUse use, std::size_t offset) {
  const auto before = [offset](std::size_t distance) {
    return static_cast<std::uint16_t>(offset >= distance ? offset - distance : 0);
  };
  switch (use) {
    case SlotUse::dimmer:
      return {0, 0x0001};
    case SlotUse::pan:
      return {0, 0x0101};
    case SlotUse::tilt:
      return {0, 0x0102};
    case SlotUse::zoom:
      return {0, 0x0405};
    case SlotUse::dimmer_fine:
    case SlotUse::pan_fine:
    case SlotUse::tilt_fine:
    case SlotUse::zoom_fine:
      return {1, before(1)};
    case SlotUse::dimmer_ultra:
    case SlotUse::pan_ultra:
    case SlotUse::tilt_ultra:
    case SlotUse::zoom_ultra:
      return {1, before(2)};
    default:
      return {0, 0xffff};
  }
}

}  // namespace

RdmFixtures::RdmFixtures(const Rig& rig, std::size_t bus, const World& world, const Faults& faults)
    : world_(world), housing_of_(rig.fixtures.size()) {
  std::map<std::size_t, RdmIdentity> identities;
  std::map<std::size_t, int> universes;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    const Fixture& fixture = rig.fixtures[f];
    const auto* patch = std::get_if<DmxPatch>(&fixture.patch);
    if (fixture.bus != bus || patch == nullptr) continue;
    const std::size_t first = fixture.housing.value_or(f);
    housing_of_[f] = first;
    const auto [found, is_new] = identities.try_emplace(first);
    RdmIdentity& identity = found->second;
    if (is_new) {
      identity.uid = kPrototypes << 32 | static_cast<std::uint64_t>(bus) << 16 | (first + 1);
      identity.manufacturer = "Luxrig, simulated";
      identity.label = rig.fixtures[first].name;
      if (fixture.luminaire < rig.luminaires.size()) identity.model = rig.luminaires[fixture.luminaire].name;
      identity.model_id = static_cast<int>(fixture.luminaire + 1);
      identity.category = fixture.moves ? kMovingHead : kFixedFixture;
      identity.address = patch->address;
      identity.lamp_hours = static_cast<std::uint32_t>(100 + 37 * first);
      universes[first] = patch->universe;
    }
    // Parts of a housing may be patched apart: the footprint extends from the first slot to the last.
    const int begin = std::min(identity.address, patch->address);
    if (begin < identity.address) {
      identity.slots.insert(identity.slots.begin(), static_cast<std::size_t>(identity.address - begin), RdmSlot{});
      identity.address = begin;
    }
    const auto offset = static_cast<std::size_t>(patch->address - begin);
    identity.slots.resize(std::max(identity.slots.size(), offset + patch->slots.size()), RdmSlot{0, 0xffff});
    for (std::size_t i = 0; i < patch->slots.size(); ++i) {
      identity.slots[offset + i] = slot_of(patch->slots[i].use, offset + i);
    }
  }
  for (auto& [first, identity] : identities) {
    const int address = identity.address;
    RdmLine& line = lines_.try_emplace(universes[first], faults).first->second;
    housings_[first] = {&line.add(rig.fixtures[first].name, std::move(identity)), address};
  }
}

int RdmFixtures::moved_by(std::size_t fixture) const {
  if (fixture >= housing_of_.size() || !housing_of_[fixture]) return 0;
  const Housing& housing = housings_.at(*housing_of_[fixture]);
  return housing.responder->address() - housing.patched_address;
}

void RdmFixtures::shine(Time now) {
  const std::vector<double> levels = world_.levels();
  for (auto& [first, housing] : housings_) housing.responder->shine(now, levels[first]);
}

}  // namespace luxrig::sim
