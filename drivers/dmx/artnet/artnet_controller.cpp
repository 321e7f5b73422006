#include "drivers/dmx/artnet/artnet_controller.h"

#include <algorithm>

#include "drivers/dmx/sequence.h"

namespace luxrig::artnet {
namespace {

// Bounds memory: more nodes than this are a flood, not a rig.
constexpr std::size_t kMaxNodes = 1024;

}  // namespace

bool Node::puts_out(int port_address) const {
  return std::any_of(outputs.begin(), outputs.end(), [&](const auto& page) {
    return std::any_of(page.second.begin(), page.second.end(),
                       [&](const PortOutput& port) { return port.port_address == port_address; });
  });
}

bool Node::merges(int port_address) const {
  return std::any_of(outputs.begin(), outputs.end(), [&](const auto& page) {
    return std::any_of(page.second.begin(), page.second.end(),
                       [&](const PortOutput& port) { return port.port_address == port_address && port.merging; });
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
  if (!nodes_.contains(datagram.from) && nodes_.size() >= kMaxNodes) return true;
  const auto [found, is_new] = nodes_.try_emplace(datagram.from);
  Node& node = found->second;
  std::vector<PortOutput>& outputs = node.outputs[reply->bind_index];
  const auto same_port = [](const PortOutput& a, const PortOutput& b) { return a.port_address == b.port_address; };
  if (is_new || node.gone ||
      !std::equal(outputs.begin(), outputs.end(), reply->outputs.begin(), reply->outputs.end(), same_port)) {
    if (is_new || node.gone) node.since = now;
    send_afresh();
  }
  outputs = reply->outputs;
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
    stream.sent = false;
  }
  if (!stream.wanted && !settings_.continuous && now - stream.last < kKeepAlive) return std::nullopt;
  if (!stream.rate.take(now)) return std::nullopt;
  stream.wanted = false;
  stream.sent = true;
  stream.last = now;

  Dmx packet;
  packet.sequence = settings_.sequence ? stream.sequence : 0;
  packet.port_address = port_address;
  packet.slots.assign(slots.begin(), slots.end());
  // 1…255, wrapping past 0, which would mean "no order".
  const int step = stream.packets == 0 ? kJumpAfterFirstPacket : 1;
  stream.sequence = static_cast<std::uint8_t>((stream.sequence - 1 + step) % 255 + 1);
  // The packet after the jump must not wait for the keep-alive: the one before it may have been dropped.
  if (stream.packets == 0) stream.wanted = true;
  ++stream.packets;
  owes_sync_ = settings_.sync;
  return encode(packet);
}

bool Controller::is_sent(int port_address, const DmxSlots& slots) const {
  const auto found = streams_.find(port_address);
  return found != streams_.end() && found->second.sent && found->second.slots == slots;
}

std::optional<std::vector<std::uint8_t>> Controller::sync_due() {
  if (!owes_sync_) return std::nullopt;
  owes_sync_ = false;
  return encode_sync();
}

std::vector<SocketAddress> Controller::subscribers(int port_address) const {
  std::vector<SocketAddress> all;
  for (const auto& [address, node] : nodes_) {
    if (!node.gone && node.puts_out(port_address)) all.push_back(address);
  }
  return all;
}

void Controller::rest() {
  owes_sync_ = false;
  nodes_.clear();
  last_poll_.reset();
  send_afresh();
}

void Controller::send_afresh() {
  for (auto& [port_address, stream] : streams_) {
    stream.wanted = true;
    stream.sent = false;
  }
}

}  // namespace luxrig::artnet
