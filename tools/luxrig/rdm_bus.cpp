#include "tools/luxrig/rdm_bus.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "drivers/dmx/artnet/artnet_controller.h"
#include "drivers/io/host_id.h"
#include "drivers/io/udp.h"
#include "tools/luxrigd/clock.h"

namespace luxrig {
namespace {

constexpr auto kRdmStep = std::chrono::milliseconds(1);
// A node answers a poll within a second; the pages of one node come together.
constexpr Duration kNodesAnswer = std::chrono::milliseconds(1200);
constexpr Duration kPagesFollow = std::chrono::milliseconds(200);
constexpr Duration kAskTableEvery = std::chrono::milliseconds(1000);
// A node that has flushed its table may tell an empty one at first, and searches for a second or more.
constexpr Duration kSearchTakes = std::chrono::milliseconds(2000);
constexpr std::uint16_t kPrototypeManufacturer = 0x7FF0;

/// Luxrig has no manufacturer number of its own: one of those for prototypes, and a device number that is this host's.
rdm::Uid controller_uid() {
  const std::string host = host_id();
  const std::string_view parts[] = {"rdm controller", host};
  const auto id = hashed_id(parts);
  const auto device = static_cast<std::uint32_t>(id[0]) << 24 | static_cast<std::uint32_t>(id[1]) << 16 |
                      static_cast<std::uint32_t>(id[2]) << 8 | id[3];
  return {kPrototypeManufacturer, device == 0xFFFFFFFF ? 1 : device};
}

}  // namespace

Result<RdmBus> RdmBus::find(const RdmSearch& search) {
  RdmBus bus;
  UdpSettings settings;
  settings.local_port = artnet::kPort;  // nodes answer to this port, some by broadcast
  settings.share_local_port = true;
  settings.broadcast = true;
  bus.channel_ = make_udp(std::move(settings));
  if (auto opened = bus.channel_->open(); !opened) return tl::unexpected(opened.error());
  if (auto found = bus.find_nodes(search); !found) return tl::unexpected(found.error());
  if (auto read = bus.read_tables(search); !read) return tl::unexpected(read.error());
  return bus;
}

Result<void> RdmBus::find_nodes(const RdmSearch& search) {
  artnet::Controller controller{{}};
  if (auto sent = channel_->send(search.poll_to, artnet::encode_poll()); !sent) return sent;
  Time end = now() + kNodesAnswer;
  while (now() < end) {
    while (channel_->take_error()) {
    }
    while (const auto datagram = channel_->receive()) {
      if (!controller.hear(now(), *datagram)) continue;
      if (search.one_node && datagram->from.ipv4 == search.poll_to.ipv4) end = std::min(end, now() + kPagesFollow);
    }
    std::this_thread::sleep_for(kRdmStep);
  }
  nodes_ = controller.nodes().size();
  for (const auto& [address, node] : controller.nodes()) {
    for (const auto& [bind_index, outputs] : node.outputs) {
      for (const artnet::PortOutput& output : outputs) {
        if (search.universe && *search.universe != output.port_address) continue;
        RdmUniverse universe;
        universe.node = node.name;
        universe.link = std::make_unique<artnet::ArtnetRdmLink>(*channel_, address, output.port_address);
        universe.client = std::make_unique<rdm::Client>(*universe.link, controller_uid());
        universes_.push_back(std::move(universe));
      }
    }
  }
  return {};
}

Result<void> RdmBus::read_tables(const RdmSearch& search) {
  const Time start = now();
  if (search.rediscover) {
    for (const RdmUniverse& universe : universes_) {
      if (auto sent = universe.link->flush_table(); !sent) return sent;
    }
  }
  Time ask_at = search.rediscover ? start + kSearchTakes : start;
  // What was told before the search was over does not count.
  const Time not_before = search.rediscover ? ask_at + kPagesFollow : start;
  const Time end = ask_at + from_seconds(search.seconds);
  const auto known = [](const RdmUniverse& universe) { return universe.link->table().complete; };
  while (now() < end && (now() < not_before || !std::all_of(universes_.begin(), universes_.end(), known))) {
    if (now() >= ask_at) {
      ask_at = now() + kAskTableEvery;
      for (const RdmUniverse& universe : universes_) {
        if (known(universe) && !search.rediscover) continue;
        if (auto sent = universe.link->ask_table(); !sent) return sent;
      }
    }
    while (channel_->take_error()) {
    }
    while (const auto datagram = channel_->receive()) {
      for (const RdmUniverse& universe : universes_) {
        if (universe.link->hear(*datagram)) break;
      }
    }
    std::this_thread::sleep_for(kRdmStep);
  }
  return {};
}

const RdmUniverse* RdmBus::line_of(const rdm::Uid& uid) const {
  const auto found = std::find_if(universes_.begin(), universes_.end(), [&uid](const RdmUniverse& universe) {
    return universe.link->table().uids.contains(uid);
  });
  return found == universes_.end() ? nullptr : &*found;
}

Result<std::vector<std::uint8_t>> RdmBus::ask(const RdmUniverse& universe, const rdm::Request& request) {
  rdm::Client& client = *universe.client;
  client.begin(request);
  for (;;) {
    client.step(now());
    if (auto answer = client.take()) return std::move(*answer);
    std::this_thread::sleep_for(kRdmStep);
  }
}

}  // namespace luxrig
