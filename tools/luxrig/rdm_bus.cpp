#include "tools/luxrig/rdm_bus.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "drivers/dmx/artnet/artnet_controller.h"
#include "drivers/dmx/enttec_pro/widget_rdm.h"
#include "drivers/dmx/usb/ftdi.h"
#include "drivers/dmx/usb/usb_dmx_driver.h"
#include "drivers/io/host_id.h"
#include "drivers/io/udp.h"
#include "tools/process/clock.h"

namespace luxrig {
namespace {

constexpr auto kRdmStep = std::chrono::milliseconds(1);
// A node answers a poll within a second; the pages of one node come together.
constexpr Duration kNodesAnswer = std::chrono::milliseconds(1200);
constexpr Duration kPagesFollow = std::chrono::milliseconds(200);
constexpr Duration kAskTableEvery = std::chrono::milliseconds(1000);
// A node that has flushed its table may first report an empty one, and searches for a second or more.
constexpr Duration kSearchTakes = std::chrono::milliseconds(2000);
constexpr std::uint16_t kPrototypeManufacturer = 0x7FF0;

/// Luxrig has no manufacturer number of its own. It uses one reserved for prototypes, and a device number from this
/// host.
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
  auto lines = bus.find_nodes(search);
  if (!lines) return tl::unexpected(lines.error());
  if (auto read = bus.read_tables(search, *lines); !read) return tl::unexpected(read.error());
  for (NodeLine& line : *lines) {
    RdmUniverse universe;
    universe.node = std::move(line.node);
    universe.universe = line.link->port_address();
    const artnet::TableOfDevices& table = line.link->table();
    universe.uids = table.uids;
    universe.complete = table.complete || !table.heard;
    universe.link = std::move(line.link);
    universe.client = std::make_unique<rdm::Client>(*universe.link, controller_uid());
    bus.universes_.push_back(std::move(universe));
  }
  return bus;
}

Result<RdmBus> RdmBus::find(const RdmWidgetSearch& search) {
  UsbSearch wanted;
  wanted.what = "ENTTEC DMX USB Pro";
  wanted.kinds = {{ftdi::kVendor, ftdi::kFt232}};
  wanted.serial = search.serial;
  wanted.port = search.port;
  auto line = std::make_unique<enttec::WidgetRdm>(make_usb_channel(std::move(wanted), search.server), controller_uid());
  if (auto opened = line->open(); !opened) return tl::unexpected(opened.error());
  const auto found = rdm::discover(*line);
  if (!found) return tl::unexpected(found.error());
  if (found->found.empty() && line->may_lack_rdm()) {
    return refusal(
        fmt::format("nobody answers on the line of {}, whose firmware {}.{} may be the one without RDM: load "
                    "firmware 2 with ENTTEC's utility",
                    line->where(), line->firmware() >> 8, line->firmware() & 0xff));
  }
  RdmBus bus;
  bus.nodes_ = 1;
  RdmUniverse universe;
  universe.node = line->where();
  universe.universe = search.universe;
  universe.uids.insert(found->found.begin(), found->found.end());
  universe.complete = found->complete;
  universe.link = std::move(line);
  universe.client = std::make_unique<rdm::Client>(*universe.link, controller_uid());
  bus.universes_.push_back(std::move(universe));
  return bus;
}

Result<std::vector<RdmBus::NodeLine>> RdmBus::find_nodes(const RdmSearch& search) {
  artnet::Controller controller{{}};
  if (auto sent = channel_->send(search.poll_to, artnet::encode_poll()); !sent) return tl::unexpected(sent.error());
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
  std::vector<NodeLine> lines;
  for (const auto& [address, node] : controller.nodes()) {
    for (const auto& [bind_index, outputs] : node.outputs) {
      for (const artnet::PortOutput& output : outputs) {
        if (search.universe && *search.universe != output.port_address) continue;
        lines.push_back({node.name, std::make_unique<artnet::ArtnetRdmLink>(*channel_, address, output.port_address)});
      }
    }
  }
  return lines;
}

Result<void> RdmBus::read_tables(const RdmSearch& search, std::span<const NodeLine> lines) {
  const Time start = now();
  if (search.rediscover) {
    for (const NodeLine& line : lines) {
      if (auto sent = line.link->flush_table(); !sent) return sent;
    }
  }
  Time ask_at = search.rediscover ? start + kSearchTakes : start;
  // Tables reported before the search was over do not count.
  const Time not_before = search.rediscover ? ask_at + kPagesFollow : start;
  const Time end = ask_at + from_seconds(search.seconds);
  const auto known = [](const NodeLine& line) { return line.link->table().complete; };
  while (now() < end && (now() < not_before || !std::all_of(lines.begin(), lines.end(), known))) {
    if (now() >= ask_at) {
      ask_at = now() + kAskTableEvery;
      for (const NodeLine& line : lines) {
        if (known(line) && !search.rediscover) continue;
        if (auto sent = line.link->ask_table(); !sent) return sent;
      }
    }
    while (channel_->take_error()) {
    }
    while (const auto datagram = channel_->receive()) {
      for (const NodeLine& line : lines) {
        if (line.link->hear(*datagram)) break;
      }
    }
    std::this_thread::sleep_for(kRdmStep);
  }
  return {};
}

const RdmUniverse* RdmBus::line_of(const rdm::Uid& uid) const {
  const auto found = std::find_if(universes_.begin(), universes_.end(),
                                  [&uid](const RdmUniverse& universe) { return universe.uids.contains(uid); });
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
