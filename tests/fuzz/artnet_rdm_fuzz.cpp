/// RDM over Art-Net, both sides: no packet may crash the decoders or the simulated node's RDM half, an accepted packet
/// encodes to the same fields, and the node answers only about its own ports.
#include <cstdlib>
#include <map>
#include <vector>

#include "drivers/dmx/artnet/artnet_codec.h"
#include "drivers/dmx/artnet/artnet_rdm_codec.h"
#include "sim/wire/artnet/artnet_rdm_gate.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace luxrig;
  using namespace luxrig::artnet;
  // On the heap, so that a read past its end is found.
  const std::vector<std::uint8_t> packet(data, data + size);
  if (const auto tod = decode_tod_data(packet)) {
    if (tod->port_address < 0 || tod->port_address > kHighestPortAddress || tod->uids.size() > kMaxTodUids) {
      std::abort();
    }
    const auto again = decode_tod_data(encode(*tod));
    if (!again || again->uids != tod->uids || again->total != tod->total) std::abort();
  }
  if (const auto request = decode_tod_request(packet)) {
    if (request->size() > 32) std::abort();
    if (!request->empty() && decode_tod_request(encode_tod_request(*request)) != request) std::abort();
  }
  if (const auto control = decode_tod_control(packet)) {
    const auto again = decode_tod_control(encode(*control));
    if (!again || again->command != control->command) std::abort();
  }
  if (const auto carried = decode_art_rdm(packet)) {
    const auto again = decode_art_rdm(encode(*carried));
    if (!again || again->rdm != carried->rdm) std::abort();
    (void)rdm::decode(carried->rdm);
  }
  sim::Faults faults(1);
  std::map<int, sim::RdmLine> lines;
  for (const int port_address : {1, 0x0123}) {
    sim::RdmIdentity identity;
    identity.uid = 0x7a7000000001 + static_cast<std::uint64_t>(port_address);
    identity.slots.resize(60);
    lines.try_emplace(port_address, faults).first->second.add("lamp", identity);
  }
  sim::ArtnetRdmGate gate(lines);
  for (const auto& answer : gate.receive({}, packet)) {
    const auto tod = decode_tod_data(answer.packet);
    const auto carried = decode_art_rdm(answer.packet);
    if (!tod && !carried) std::abort();
    const int port_address = tod ? tod->port_address : carried->port_address;
    if (port_address != 1 && port_address != 0x0123) std::abort();
    if (carried && !rdm::decode(carried->rdm)) std::abort();
  }
  return 0;
}
