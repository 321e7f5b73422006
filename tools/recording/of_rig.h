#pragma once
/// What of a recording concerns a rig: which sources are lighting desks, what its luxmeters showed.

#include "core/rig/rig.h"
#include "drivers/dmx/desk_options.h"
#include "tools/recording/recording.h"

namespace luxrig::recording {

/// TCP ports of the rig's Modbus servers.
[[nodiscard]] std::set<std::uint16_t> modbus_ports(const Rig& rig);

/// A bus that listens to a desk.
struct DeskBus {
  std::size_t bus = 0;
  Protocol protocol = Protocol::sacn;
  DeskOptions desk;
  std::set<int> universes;  ///< on which a desk sends for its fixtures
  int lowest_priority = 0;  ///< of sources that count
};
/// requires a rig whose buses were checked.
[[nodiscard]] std::vector<DeskBus> desk_buses(const Rig& rig);

/// Per source: whether it is Luxrig itself, as this rig has it send. sACN: by name or CID. Art-Net has no names: what
/// the recording computer sent, or a computer that sends this rig's sACN or asks its Modbus devices. Loopback
/// addresses tell nothing.
[[nodiscard]] std::vector<bool> own_sources(const Recording& recording, const Rig& rig);

/// Whether this bus hears the packet of this source.
[[nodiscard]] bool hears(const DeskBus& bus, const Recording& recording, const DmxPacket& packet);

struct MeterReading {
  Duration at{};
  double lux = 0;
};
/// Per luxmeter of the rig, by its patch and the address of its bus; in order of time.
[[nodiscard]] std::vector<std::vector<MeterReading>> meter_readings(const Recording& recording, const Rig& rig);

/// The number that the packet's source gave it; OLA: 0.
[[nodiscard]] int number_of(const Recording& recording, const DmxPacket& packet);

/// A DMX packet as a bus of that protocol hears it: the datagram; of OLA one that is made.
/// number: added to the recorded one. cid: of sACN, in place of the recorded one.
[[nodiscard]] std::vector<std::uint8_t> datagram_of(const Recording& recording, const DmxPacket& packet,
                                                    Protocol protocol, int number,
                                                    const std::optional<sacn::Cid>& cid = {});

}  // namespace luxrig::recording
