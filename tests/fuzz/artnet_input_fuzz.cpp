/// The Art-Net receiver: input = packets, each with its sender and the delay since the last. It answers only polls,
/// with replies that a controller can read; at most two senders count; a silent sender is lost.
#include <algorithm>
#include <cstdlib>
#include <vector>

#include "drivers/dmx/artnet/artnet_receiver.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace luxrig;
  using namespace luxrig::artnet;
  ReceiverSettings settings;
  settings.port_addresses = {0, 1, 2, 3, 4, 0x0123, 0x7fff};
  settings.reply_delay = std::chrono::milliseconds(100);
  Receiver receiver(settings);
  Time now{};
  std::span<const std::uint8_t> rest(data, size);
  // Record: sender and delay in units of 50 ms (two and six bits), length of the packet (two bytes), packet.
  while (rest.size() >= 3) {
    const SocketAddress from{static_cast<std::uint32_t>(rest[0] >> 6), kPort};
    now += std::chrono::milliseconds(50 * (rest[0] & 0x3f));
    const std::size_t length = std::min<std::size_t>(rest[1] << 8 | rest[2], rest.size() - 3);
    // On the heap, so that a read past its end is found.
    const std::vector<std::uint8_t> packet(rest.begin() + 3, rest.begin() + 3 + static_cast<std::ptrdiff_t>(length));
    rest = rest.subspan(3 + length);
    if (const auto address = decode_address(packet)) {
      if (address->port < 0 || address->port > 3 || !decode_address(encode(*address))) std::abort();
    }
    const auto verdict = receiver.receive(now, from, packet);
    const auto dmx = decode_dmx(packet);
    if (dmx && verdict == Receiver::Verdict::taken && dmx->port_address > 4 && dmx->port_address != 0x0123 &&
        dmx->port_address != 0x7fff) {
      std::abort();
    }
    for (const auto& [to, reply] : receiver.answers_due(now)) {
      const auto heard = decode_poll_reply(encode(reply, 0));
      if (!heard || heard->outputs.size() != reply.outputs.size() || to.port != kPort) std::abort();
    }
    for (const int port_address : settings.port_addresses) {
      const HeardUniverse heard = receiver.heard(now, port_address);
      if (heard.presence == DeskPresence::present && heard.source.empty()) std::abort();
    }
    if (receiver.heard(now, 5).presence != DeskPresence::unknown) std::abort();
  }
  now += kSenderLoss + std::chrono::milliseconds(1);
  for (const int port_address : settings.port_addresses) {
    if (receiver.heard(now, port_address).presence == DeskPresence::present) std::abort();
  }
  return 0;
}
