#include "tools/scenario/desk_sender.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "drivers/dmx/artnet/artnet_codec.h"
#include "drivers/dmx/sacn/sacn_codec.h"
#include "tools/scenario/desk.h"

namespace luxrig::scenario {
namespace {

constexpr Duration kDeskPeriod = std::chrono::milliseconds(25);
constexpr sacn::Cid kDeskCid = {0x6c, 0x75, 0x78, 0x72, 0x69, 0x67, 0x2d, 0x64, 0x65, 0x73, 0x6b};
constexpr int kDeskPriority = 100;

sockaddr_in desk_address(std::uint32_t ipv4, int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(ipv4);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return address;
}

Fault socket_fault(const char* what) {
  return {Cause::system, "desk", std::string(what) + ": " + std::strerror(errno), {}};
}

/// A UDP port that nobody has now.
Result<int> free_udp_port() {
  const int probe = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address = desk_address(INADDR_LOOPBACK, 0);
  socklen_t size = sizeof address;
  const bool bound = probe >= 0 && ::bind(probe, reinterpret_cast<const sockaddr*>(&address), size) == 0 &&
                     ::getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  Result<int> port = ntohs(address.sin_port);
  if (!bound) port = tl::unexpected(socket_fault("no port for a lighting desk"));
  if (probe >= 0) ::close(probe);
  return port;
}

bool on_bus(const Fixture& fixture, std::size_t bus) {
  return fixture.bus == bus && std::holds_alternative<DmxPatch>(fixture.patch);
}

}  // namespace

Result<DeskSender> DeskSender::open(const Rig& rig, const std::map<std::string, int>& lamps) {
  DeskSender desk(rig, ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  // Art-Net tells senders apart by address, and Luxrig sends from 127.0.0.1.
  const sockaddr_in own = desk_address(INADDR_LOOPBACK + 1, 0);
  if (desk.socket_ < 0 || ::bind(desk.socket_, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0)
    return tl::unexpected(socket_fault("no socket for a lighting desk"));
  desk.lamp_ports_ = lamps;
  for (const Bus& bus : rig.buses) {
    if (!desk_rules(bus)) continue;
    const auto port = free_udp_port();
    if (!port) return tl::unexpected(port.error());
    desk.daemon_ports_[bus.name] = *port;
  }
  return desk;
}

DeskSender::DeskSender(DeskSender&& other) noexcept
    : rig_(other.rig_),
      socket_(std::exchange(other.socket_, -1)),
      daemon_ports_(std::move(other.daemon_ports_)),
      lamp_ports_(std::move(other.lamp_ports_)),
      commands_(std::move(other.commands_)),
      sequence_(std::move(other.sequence_)),
      due_(other.due_) {}

DeskSender::~DeskSender() {
  if (socket_ >= 0) ::close(socket_);
}

void DeskSender::send(Time now) {
  if (due_ && now < *due_) return;
  due_ = std::max(due_.value_or(now) + kDeskPeriod, now);
  for (std::size_t b = 0; b < rig_->buses.size(); ++b)
    if (daemon_ports_.contains(rig_->buses[b].name)) send_bus(b);
}

void DeskSender::send_bus(std::size_t b) {
  // Each desk value encoded as our own driver would; those of other fixtures have no value.
  DmxPatchbay bay(*rig_, b);
  std::map<int, DmxSlots> priorities;
  for (std::size_t f = 0; f < commands_.size(); ++f) {
    if (!on_bus(rig_->fixtures[f], b) || !commands_[f]) continue;
    const LevelCommand level{f, commands_[f]->drive};
    (void)bay.set_levels({&level, 1});
    if (commands_[f]->joints) {
      const AimCommand aim{f, *commands_[f]->joints};
      (void)bay.set_aims({&aim, 1});
      (void)bay.set_levels({&level, 1});  // an aim is encoded with the next level
    }
    const auto& patch = std::get<DmxPatch>(rig_->fixtures[f].patch);
    DmxSlots& given = priorities[patch.universe];
    for (std::size_t s = 0; s < patch.slots.size(); ++s)
      given.at(static_cast<std::size_t>(patch.address - 1) + s) = kDeskPriority;
  }
  const Bus& bus = rig_->buses[b];
  const DeskOptions options = desk_options(bus, find_driver(bus.driver)->options);
  const bool standby = options.rules && options.rules->mode == DeskMode::standby;
  for (const DmxUniverse& universe : bay.universes()) {
    const auto given = priorities.find(universe.number);
    if (given == priorities.end()) continue;
    std::uint8_t& sequence = sequence_[universe.number];
    const auto packets = [&](int number) {
      std::vector<std::vector<std::uint8_t>> all;
      if (bus.driver == "artnet") {
        if (++sequence == 0) ++sequence;
        artnet::Dmx packet;
        packet.sequence = sequence;
        packet.port_address = number;
        packet.slots.assign(universe.slots.begin(), universe.slots.end());
        all.push_back(artnet::encode(packet));
        return all;
      }
      sacn::DataPacket packet;
      packet.cid = kDeskCid;
      packet.source_name = "desk";
      packet.priority = kDeskPriority;
      packet.universe = static_cast<std::uint16_t>(number);
      for (const std::uint8_t code : {sacn::kSlotPriority, sacn::kLevels}) {
        const DmxSlots& slots = code == sacn::kLevels ? universe.slots : given->second;
        packet.sequence = ++sequence;
        packet.start_code = code;
        packet.slots.assign(slots.begin(), slots.end());
        all.push_back(sacn::encode(packet));
      }
      return all;
    };
    for (const auto& packet : packets(universe.number + options.offset)) send_to(daemon_ports_.at(bus.name), packet);
    if (!standby) continue;
    if (const auto lamps = lamp_ports_.find(bus.name); lamps != lamp_ports_.end())
      for (const auto& packet : packets(universe.number)) send_to(lamps->second, packet);
  }
}

void DeskSender::send_to(int port, const std::vector<std::uint8_t>& packet) const {
  const sockaddr_in to = desk_address(INADDR_LOOPBACK, port);
  ::sendto(socket_, packet.data(), packet.size(), MSG_DONTWAIT | MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&to),
           sizeof to);
}

}  // namespace luxrig::scenario
