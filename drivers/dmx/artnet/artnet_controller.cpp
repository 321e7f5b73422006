#include "drivers/dmx/artnet/artnet_controller.h"

#include <algorithm>

namespace luxrig::artnet {
namespace {

// A node drops data whose sequence number is 0…19 behind the last one it heard. A restarted controller does not know
// that number; one jump of 20 after its first packet gets past it, whatever it was.
constexpr int kPastTheDropWindow = 20;
// A network of more nodes than this is not a rig but a flood.
constexpr std::size_t kMostNodes = 1024;

}  // namespace

bool Node::puts_out(int port_address) const {
  return std::any_of(outputs.begin(), outputs.end(), [&](const auto& page) {
    return std::find(page.second.begin(), page.second.end(), port_address) != page.second.end();
  });
}

bool Controller::poll_due(Time now) {
  for (auto& [address, node] : nodes_) {
    if (!node.gone && now - node.last_seen > kNodeGone) {
      node.gone = true;
      node.since = now;
    }
  }
  if (last_poll_ && now - *last_poll_ < kPollPeriod) return false;
  last_poll_ = now;
  return true;
}

bool Controller::hear(Time now, const Datagram& datagram) {
  const auto reply = decode_poll_reply(datagram.bytes);
  if (!reply) return false;
  if (!nodes_.contains(datagram.from) && nodes_.size() >= kMostNodes) return true;
  const auto [found, is_new] = nodes_.try_emplace(datagram.from);
  Node& node = found->second;
  std::vector<int>& outputs = node.outputs[reply->bind_index];
  if (is_new || node.gone || outputs != reply->output_port_addresses) {
    if (is_new || node.gone) node.since = now;
    for (auto& [port_address, stream] : streams_) stream.wanted = true;
  }
  outputs = reply->output_port_addresses;
  node.name = reply->short_name.empty() ? text_of(datagram.from.ipv4) : reply->short_name;
  node.last_seen = now;
  node.gone = false;
  ++node.replies;
  return true;
}

std::optional<std::vector<std::uint8_t>> Controller::due(Time now, int port_address, const DmxSlots& slots) {
  Stream& stream = streams_[port_address];
  if (slots != stream.slots) {
    stream.slots = slots;
    stream.wanted = true;
  }
  if (!stream.wanted && !continuous_ && now - stream.last < kKeepAlive) return std::nullopt;
  if (!stream.rate.take(now)) return std::nullopt;
  stream.wanted = false;
  stream.last = now;

  Dmx packet;
  packet.sequence = stream.sequence;
  packet.port_address = port_address;
  packet.slots.assign(slots.begin(), slots.end());
  // 1…255 and round again, leaving out 0, which would mean "no order".
  const int step = stream.packets == 0 ? kPastTheDropWindow : 1;
  stream.sequence = static_cast<std::uint8_t>((stream.sequence - 1 + step) % 255 + 1);
  // The packet behind the jump must not wait for the keep-alive: the one before it may have been dropped.
  if (stream.packets == 0) stream.wanted = true;
  ++stream.packets;
  return encode(packet);
}

std::vector<SocketAddress> Controller::subscribers(int port_address) const {
  std::vector<SocketAddress> all;
  for (const auto& [address, node] : nodes_) {
    if (!node.gone && node.puts_out(port_address)) all.push_back(address);
  }
  return all;
}

void Controller::rest() {
  nodes_.clear();
  last_poll_.reset();
  for (auto& [port_address, stream] : streams_) stream.wanted = true;
}

}  // namespace luxrig::artnet
