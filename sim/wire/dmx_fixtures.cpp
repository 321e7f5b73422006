#include "sim/wire/dmx_fixtures.h"

namespace luxrig::sim {

void obey_dmx(const EndpointParts& parts, std::uint64_t frame, const DmxLevelsOf& levels_of,
              const DmxMovedBy& moved_by) {
  for (std::size_t f = 0; f < parts.rig.fixtures.size(); ++f) {
    const Fixture& fixture = parts.rig.fixtures[f];
    const auto* patch = std::get_if<DmxPatch>(&fixture.patch);
    if (fixture.bus != parts.bus || patch == nullptr) continue;
    // A DMX fixture cannot be late, and a broken line to it is silence.
    const Disturbance disturbance = parts.faults.disturbance({&fixture.name, 1}, frame);
    if (disturbance.silent || disturbance.garbled) continue;
    const auto slots = levels_of(patch->universe);
    if (!slots) continue;
    DmxPatch elsewhere;
    if (const int moved = moved_by ? moved_by(f) : 0; moved != 0) {
      elsewhere = *patch;
      elsewhere.address += moved;
      patch = &elsewhere;
    }
    const DmxOrder order = decode_slots(fixture, *patch, *slots);
    parts.world.set_drive(f, order.drive);
    if (order.joints) parts.world.set_aim_target(f, *order.joints);
    if (!order.beam_rad) continue;
    Joints zoomed = parts.world.joints()[f];  // its axes turn it
    zoomed.beam_rad = *order.beam_rad;
    parts.world.set_aim_target(f, zoomed);
  }
}

}  // namespace luxrig::sim
