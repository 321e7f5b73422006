#include "sim/wire/artnet/artnet_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "sim/wire/bytes.h"

namespace luxrig::sim {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr int kOpPoll = 0x2000, kOpPollReply = 0x2100, kOpDmx = 0x5000, kOpSync = 0x5200;
constexpr Duration kSourceTimeout = std::chrono::seconds(10);
constexpr Duration kSyncTimeout = std::chrono::seconds(4);
constexpr std::size_t kMaxSources = 2;

// ID "Art-Net\0", OpCode low byte first, protocol version 14 or later, high byte first.
bool header_fits(Bytes packet, int op_code) {
  static constexpr std::uint8_t kId[] = {'A', 'r', 't', '-', 'N', 'e', 't', 0};
  return packet.size() >= 12 && std::equal(std::begin(kId), std::end(kId), packet.begin()) &&
         little_endian_16(packet, 8) == op_code && big_endian_16(packet, 10) >= 14;
}

bool out_of_order(std::uint8_t sequence, std::uint8_t last) {
  if (sequence == 0 || last == 0) return false;
  const auto distance = static_cast<std::int8_t>(sequence - last);
  return distance <= 0 && distance > -20;
}

void put_text(std::vector<std::uint8_t>& packet, std::size_t offset, std::size_t field, std::string_view text) {
  const std::size_t length = std::min(text.size(), field - 1);  // always NUL terminated
  std::copy_n(text.begin(), length, packet.begin() + static_cast<std::ptrdiff_t>(offset));
}

}  // namespace

std::optional<ArtDmx> decode_art_dmx(Bytes packet) {
  if (!header_fits(packet, kOpDmx) || packet.size() < 20) return std::nullopt;
  const auto length = static_cast<std::size_t>(big_endian_16(packet, 16));
  if (length < 2 || length > kDmxSlots || length % 2 != 0 || packet.size() < 18 + length) return std::nullopt;
  if (packet[15] > 0x7f) return std::nullopt;
  return ArtDmx{packet[12], packet[13], packet[15] << 8 | packet[14], packet.subspan(18, length)};
}

bool is_art_poll(Bytes packet) { return header_fits(packet, kOpPoll) && packet.size() >= 14; }

bool is_art_sync(Bytes packet) { return header_fits(packet, kOpSync) && packet.size() >= 14; }

ArtnetNode::ArtnetNode(std::vector<int> port_addresses) {
  for (const int port_address : port_addresses) ports_[port_address];
}

std::vector<std::vector<std::uint8_t>> ArtnetNode::receive(Time now, std::uint32_t from, Bytes packet,
                                                           std::uint32_t own) {
  forget_lost(now);
  if (is_art_poll(packet)) return poll_replies(own);
  if (is_art_sync(packet)) {
    for (auto& [port_address, port] : ports_) {
      // Only the controller whose data a port shows may synchronise it; a merging port is never synchronised.
      if (port.sources.size() != 1 || port.sources[0].address != from) continue;
      port.last_sync = now;
      if (port.held) port.look = port.held;
      port.held.reset();
    }
  } else if (const auto dmx = decode_art_dmx(packet)) {
    take(now, from, *dmx);
  }
  return {};
}

void ArtnetNode::take(Time now, std::uint32_t from, const ArtDmx& dmx) {
  const auto found = ports_.find(dmx.port_address);
  if (found == ports_.end()) return;
  Port& port = found->second;
  auto source = std::find_if(port.sources.begin(), port.sources.end(),
                             [from](const Source& known) { return known.address == from; });
  if (source == port.sources.end()) {
    if (port.sources.size() >= kMaxSources) return;  // a third source is ignored
    // Slots that the first source does not send keep the held look; a second source does not affect them.
    const Levels unsaid = port.sources.empty() ? port.look.value_or(Levels{}) : Levels{};
    source = port.sources.insert(port.sources.end(), Source{from, now, 0, unsaid});
    if (port.sources.size() > 1) port.held.reset();  // merging starts, synchronisation ends
  } else if (out_of_order(dmx.sequence, source->sequence)) {
    return;
  }
  source->last_seen = now;
  source->sequence = dmx.sequence;
  // A packet with fewer slots leaves the others unchanged.
  std::copy(dmx.slots.begin(), dmx.slots.end(), source->slots.begin());
  ++accepted_;
  const bool synchronised = port.last_sync && now - *port.last_sync <= kSyncTimeout && port.sources.size() < 2;
  (synchronised ? port.held : port.look) = merged(port);
}

ArtnetNode::Levels ArtnetNode::merged(const Port& port) {
  Levels levels{};
  for (const Source& source : port.sources) {
    for (std::size_t slot = 0; slot < levels.size(); ++slot) levels[slot] = std::max(levels[slot], source.slots[slot]);
  }
  return levels;
}

void ArtnetNode::forget_lost(Time now) {
  for (auto& [port_address, port] : ports_) {
    const auto gone =
        std::erase_if(port.sources, [now](const Source& source) { return now - source.last_seen > kSourceTimeout; });
    if (gone > 0 && !port.sources.empty()) port.look = merged(port);            // without sources the look is held
    if (port.held && port.last_sync && now - *port.last_sync > kSyncTimeout) {  // back to immediate mode
      port.look = port.held;
      port.held.reset();
    }
  }
}

std::optional<ArtnetNode::Levels> ArtnetNode::levels(int port_address, Time now) {
  forget_lost(now);
  const auto found = ports_.find(port_address);
  return found == ports_.end() ? std::nullopt : found->second.look;
}

std::vector<std::vector<std::uint8_t>> ArtnetNode::poll_replies(std::uint32_t own) const {
  std::vector<std::vector<std::uint8_t>> replies;
  for (auto port = ports_.begin(); port != ports_.end();) {
    // One page: up to four ports that share net and sub-net.
    const int page = port->first >> 4;
    std::vector<const std::pair<const int, Port>*> on_page;
    for (; port != ports_.end() && port->first >> 4 == page && on_page.size() < 4; ++port) on_page.push_back(&*port);
    const auto bind_index = static_cast<std::uint8_t>(std::min<std::size_t>(replies.size() + 1, 255));

    std::vector<std::uint8_t> reply(239, 0);
    put_text(reply, 0, 8, "Art-Net");
    reply[8] = kOpPollReply & 0xff;
    reply[9] = kOpPollReply >> 8;
    const auto put_own = [&](std::size_t offset) {
      for (int i = 0; i < 4; ++i) reply[offset + static_cast<std::size_t>(i)] = own >> (24 - 8 * i) & 0xff;
    };
    put_own(10);       // IpAddress
    reply[14] = 0x36;  // port 0x1936, low byte first
    reply[15] = 0x19;
    reply[17] = 1;                                                                 // firmware
    reply[18] = static_cast<std::uint8_t>(page >> 4 & 0x7f);                       // NetSwitch
    reply[19] = static_cast<std::uint8_t>(page & 0x0f);                            // SubSwitch
    reply[21] = 0xff;                                                              // OEM 0x00ff: unknown
    put_text(reply, 26, 18, "simulated node");                                     // ShortName
    put_text(reply, 44, 64, "Luxrig simulated Art-Net node");                      // LongName
    put_text(reply, 108, 64, fmt::format("#0001 [{:04}] ok", accepted_ % 10000));  // NodeReport
    reply[173] = static_cast<std::uint8_t>(on_page.size());                        // NumPorts
    for (std::size_t i = 0; i < on_page.size(); ++i) {
      const Port& state = on_page[i]->second;
      reply[174 + i] = 0x80;  // outputs DMX from the network
      reply[182 + i] = static_cast<std::uint8_t>((state.look ? 0x80 : 0) | (state.sources.size() > 1 ? 0x08 : 0));
      reply[190 + i] = static_cast<std::uint8_t>(on_page[i]->first & 0x0f);  // SwOut
    }
    put_own(207);  // BindIp
    reply[211] = bind_index;
    reply[212] = 0x08;  // Status2: 15-bit port addresses
    reply[217] = 0x00;  // Status3: failsafe holds the last look
    replies.push_back(std::move(reply));
  }
  return replies;
}

}  // namespace luxrig::sim
