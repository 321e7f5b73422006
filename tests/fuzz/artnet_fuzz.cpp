/// Art-Net decoders: no packet may crash them, none yields a port address that does not exist, and an accepted ArtDmx
/// encodes to no more bytes, with the same fields.
#include <cstdlib>

#include "drivers/dmx/artnet/artnet_codec.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace luxrig::artnet;
  if (const auto reply = decode_poll_reply({data, size})) {
    if (reply->outputs.size() > 4) std::abort();
    for (const PortOutput& port : reply->outputs) {
      if (port.port_address < 0 || port.port_address > kHighestPortAddress) std::abort();
    }
  }
  if (const auto dmx = decode_dmx({data, size})) {
    const auto bytes = encode(*dmx);
    const auto again = decode_dmx(bytes);
    if (bytes.size() > size || !again || again->slots != dmx->slots || again->port_address != dmx->port_address) {
      std::abort();
    }
  }
  return 0;
}
