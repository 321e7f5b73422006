#include "sim/devices/dmx_fixture.h"

#include "sim/devices/personality_fixture.h"

namespace luxrig::sim {
namespace {

// One parameter, collected from its coarse, fine and ultra slots in any order.
struct Parameter {
  std::optional<int> coarse, fine, ultra;
  [[nodiscard]] double share() const {
    if (ultra) return (coarse.value_or(0) * 65536 + fine.value_or(0) * 256 + *ultra) / 16777215.0;
    if (!coarse) return fine ? *fine / 65535.0 : 0.0;
    return fine ? (*coarse * 256 + *fine) / 65535.0 : *coarse / 255.0;
  }
};

}  // namespace

DmxOrder decode_slots(const Fixture& fixture, const DmxPatch& patch, std::span<const std::uint8_t, kDmxSlots> slots) {
  if (fixture.mode) return decode_personality(fixture, patch, slots);
  Parameter dimmer, pan, tilt, zoom;
  bool zoom_inverted = false;
  bool constants_hold = true;
  for (std::size_t i = 0; i < patch.slots.size(); ++i) {
    const std::size_t index = static_cast<std::size_t>(patch.address - 1) + i;
    const int value_dmx = index < slots.size() ? slots[index] : 0;
    switch (patch.slots[i].use) {
      case SlotUse::dimmer:
        dimmer.coarse = value_dmx;
        break;
      case SlotUse::dimmer_fine:
        dimmer.fine = value_dmx;
        break;
      case SlotUse::dimmer_ultra:
        dimmer.ultra = value_dmx;
        break;
      case SlotUse::pan:
        pan.coarse = value_dmx;
        break;
      case SlotUse::pan_fine:
        pan.fine = value_dmx;
        break;
      case SlotUse::pan_ultra:
        pan.ultra = value_dmx;
        break;
      case SlotUse::tilt:
        tilt.coarse = value_dmx;
        break;
      case SlotUse::tilt_fine:
        tilt.fine = value_dmx;
        break;
      case SlotUse::tilt_ultra:
        tilt.ultra = value_dmx;
        break;
      case SlotUse::zoom:
        zoom.coarse = value_dmx;
        zoom_inverted = patch.slots[i].travel.at_end < patch.slots[i].travel.at_start;
        break;
      case SlotUse::zoom_fine:
        zoom.fine = value_dmx;
        break;
      case SlotUse::zoom_ultra:
        zoom.ultra = value_dmx;
        break;
      case SlotUse::constant:
        constants_hold = constants_hold && value_dmx == patch.slots[i].constant_dmx;
        break;
      case SlotUse::unused:
        break;
    }
  }
  DmxOrder order;
  order.drive = constants_hold ? dimmer.share() : 0;
  const JointRange& range = fixture.range;
  const auto beam_rad = [&](double share) {
    return range.beam_min_rad + (zoom_inverted ? 1 - share : share) * (range.beam_max_rad - range.beam_min_rad);
  };
  if (fixture.moves && !fixture.axes && pan.coarse && tilt.coarse) {
    order.joints =
        Joints{range.pan_min_rad + pan.share() * (range.pan_max_rad - range.pan_min_rad),
               range.tilt_min_rad + tilt.share() * (range.tilt_max_rad - range.tilt_min_rad), fixture.joints.beam_rad};
    if (zoom.coarse && range.zooms()) order.joints->beam_rad = beam_rad(zoom.share());
  }
  if (fixture.axes && zoom.coarse && range.zooms()) order.beam_rad = beam_rad(zoom.share());
  return order;
}

}  // namespace luxrig::sim
