/// The simulated Art-Net node: input = packets, each with its sender and the delay since the last. It answers only
/// polls, always with whole replies that name its own ports; only its own ports ever show levels.
#include <algorithm>
#include <cstdlib>
#include <vector>

#include "sim/wire/artnet/artnet_node.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace luxrig;
  using namespace luxrig::sim;
  ArtnetNode node({0, 1, 2, 3, 4, 0x0123, 0x7fff});
  Time now{};
  std::span<const std::uint8_t> rest(data, size);
  // Record: sender and delay in units of 50 ms (two and six bits), length of the packet (two bytes), packet.
  while (rest.size() >= 3) {
    const std::uint32_t from = rest[0] >> 6;
    now += std::chrono::milliseconds(50 * (rest[0] & 0x3f));
    const std::size_t length = std::min<std::size_t>(rest[1] << 8 | rest[2], rest.size() - 3);
    // On the heap, so that a read past its end is found.
    const std::vector<std::uint8_t> packet(rest.begin() + 3, rest.begin() + 3 + static_cast<std::ptrdiff_t>(length));
    rest = rest.subspan(3 + length);
    const auto replies = node.receive(now, from, packet);
    if (is_art_poll(packet) != !replies.empty()) std::abort();
    int ports = 0;
    for (const auto& reply : replies) {
      if (reply.size() != 239 || reply[173] < 1 || reply[173] > 4) std::abort();
      ports += reply[173];
    }
    if (!replies.empty() && ports != 7) std::abort();
    if (const auto dmx = decode_art_dmx(packet)) {
      if (dmx->port_address < 0 || dmx->port_address > 0x7fff || dmx->slots.size() > kDmxSlots) std::abort();
      if (dmx->port_address > 4 && dmx->port_address != 0x0123 && dmx->port_address != 0x7fff &&
          node.levels(dmx->port_address, now)) {
        std::abort();
      }
    }
    if (node.levels(5, now) || node.levels(-1, now)) std::abort();
  }
  return 0;
}
