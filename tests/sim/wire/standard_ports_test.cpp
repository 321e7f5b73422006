// Buses at the ports where the world's software looks for them, and devices that are among others in a network. Real
// sockets on loopback, at free ports.
#include "sim/wire/standard_ports.h"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "sim/wire/dmx_endpoint.h"
#include "sim/wire/rig_server.h"
#include "tests/sim/tiny_rig.h"
#include "tests/sim/wire/sacn_one_slot.h"

namespace luxrig::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;

Rig rig_of(std::initializer_list<std::pair<const char*, const char*>> buses) {
  Rig rig;
  for (const auto& [name, driver] : buses) {
    Bus bus;
    bus.name = name;
    bus.driver = driver;
    rig.buses.push_back(bus);
  }
  return rig;
}

TEST(StandardPorts, EveryProtocolGetsItsOwn) {
  const Rig rig = rig_of({{"stage", "artnet"}, {"track", "sacn"}, {"field", "modbus_tcp"}, {"axes", "canopen"}});
  std::map<std::string, EndpointPlace> places = {{"track", {40001}}};
  EXPECT_TRUE(use_standard_ports(
                  rig, [](int) { return true; }, places)
                  .empty());
  EXPECT_EQ(places.at("stage").port, 6454);
  EXPECT_EQ(places.at("track").port, 5568);
  EXPECT_EQ(places.at("field").port, 502);
  EXPECT_TRUE(places.at("track").among_others);
  EXPECT_FALSE(places.contains("axes"));
}

TEST(StandardPorts, WithoutPrivilegeModbusIsOn1502AndSaysSo) {
  const Rig rig = rig_of({{"field", "modbus_tcp"}});
  std::map<std::string, EndpointPlace> places;
  int asked = 0;
  const auto notes = use_standard_ports(
      rig,
      [&](int port) {
        asked = port;
        return false;
      },
      places);
  EXPECT_EQ(asked, 502);
  EXPECT_EQ(places.at("field").port, 1502);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0], "field: Modbus TCP on port 1502, as 502 needs root or CAP_NET_BIND_SERVICE");
}

TEST(StandardPorts, AFurtherBusOfAProtocolGetsTheNextPortAndSaysSo) {
  const Rig rig = rig_of({{"left", "sacn"}, {"right", "sacn"}});
  std::map<std::string, EndpointPlace> places;
  const auto notes = use_standard_ports(
      rig, [](int) { return true; }, places);
  EXPECT_EQ(places.at("left").port, 5568);
  EXPECT_EQ(places.at("right").port, 5569);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0], "right: left has sACN port 5568, so this bus has 5569: tell your software");
}

// A program of this machine: its socket at a loopback address.
class Sender {
 public:
  explicit Sender(std::uint32_t address = kLoopback) : socket_(*bind_udp(0, address)) {
    const int yes = 1;
    ::setsockopt(socket_.descriptor.get(), SOL_SOCKET, SO_BROADCAST, &yes, sizeof yes);
    in_addr interface {};
    interface.s_addr = htonl(kLoopback);
    ::setsockopt(socket_.descriptor.get(), IPPROTO_IP, IP_MULTICAST_IF, &interface, sizeof interface);
  }
  void send(std::uint32_t to, int port, const Bytes& bytes) const {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_addr.s_addr = htonl(to);
    place.sin_port = htons(static_cast<std::uint16_t>(port));
    EXPECT_EQ(::sendto(socket_.descriptor.get(), bytes.data(), bytes.size(), 0,
                       reinterpret_cast<const sockaddr*>(&place), sizeof place),
              static_cast<ssize_t>(bytes.size()));
  }
  [[nodiscard]] Bytes received() const { return received_by(socket_.descriptor.get(), 5000); }
  static Bytes received_by(int descriptor, int wait_ms) {
    pollfd readable{descriptor, POLLIN, 0};
    if (::poll(&readable, 1, wait_ms) <= 0) return {};
    Bytes bytes(2048);
    const auto size = ::recv(descriptor, bytes.data(), bytes.size(), MSG_DONTWAIT);
    bytes.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return bytes;
  }

 private:
  BoundSocket socket_;
};

struct AmongOthers {
  explicit AmongOthers(const std::string& driver, std::uint32_t address = kLoopback)
      : rig(tiny_rig(driver)), world(tiny_world(rig)) {
    EndpointPlace place;
    place.address = address;
    place.among_others = true;
    auto opened = RigServer::open(rig, *world, faults, {{"dmx", place}});
    if (!opened) throw std::runtime_error(opened.error().detail);
    server = std::move(*opened);
  }
  [[nodiscard]] int port() const { return server->ports().at("dmx"); }
  /// Waits until something has arrived, then serves at `now`.
  void serve(Time now) {
    std::vector<pollfd> waiting;
    for (const int descriptor : server->descriptors()) waiting.push_back({descriptor, POLLIN, 0});
    EXPECT_GT(::poll(waiting.data(), waiting.size(), 5000), 0) << "nothing arrived";
    serve_only(now);
  }
  void serve_only(Time now) {
    world->advance(now);
    server->serve(now);
  }

  Rig rig;
  std::unique_ptr<World> world;
  Faults faults;
  std::unique_ptr<RigServer> server;
};

const Bytes kArtPoll = {'A', 'r', 't', '-', 'N', 'e', 't', 0, 0, 0x20, 0, 14, 2, 0};
constexpr std::uint32_t kLoopbackBroadcast = 0x7fffffff;

TEST(AmongOthers, MulticastOfItsUniverseReachesAFixture) {
  AmongOthers served("sacn");
  const Sender desk;
  desk.send(sacn_group(1), served.port(), sacn_one_slot(0, 255));
  served.serve(at_s(0.1));
  served.serve_only(at_s(0.2));
  EXPECT_EQ(served.world->drives()[0], 1);
  desk.send(kLoopback, served.port(), sacn_one_slot(1, 51));
  served.serve(at_s(0.3));
  served.serve_only(at_s(0.4));
  EXPECT_DOUBLE_EQ(served.world->drives()[0], 0.2) << "unicast as well";
}

TEST(AmongOthers, AfterTheFaultDeadMulticastReachesItAgain) {
  AmongOthers served("sacn");
  const int port = served.port();
  const std::size_t sockets = served.server->descriptors().size();
  served.faults.set("dmx", FaultKind::dead, true);
  served.serve_only(at_s(0.1));
  EXPECT_LT(served.server->descriptors().size(), sockets - 1) << "the sockets of multicast are closed too";
  served.faults.clear();
  served.serve_only(at_s(0.2));
  EXPECT_EQ(served.server->descriptors().size(), sockets);
  Sender().send(sacn_group(1), port, sacn_one_slot(0, 255));
  served.serve(at_s(0.3));
  served.serve_only(at_s(0.4));
  EXPECT_EQ(served.world->drives()[0], 1);
}

TEST(AmongOthers, APollByBroadcastIsAnsweredToItsSenderWithTheNodesAddress) {
  AmongOthers served("artnet", kLoopback + 1);
  const Sender desk;
  for (const std::uint32_t to : {kLoopbackBroadcast, kLoopback + 1}) {
    desk.send(to, served.port(), kArtPoll);
    served.serve(at_s(to == kLoopbackBroadcast ? 0.1 : 0.2));
    const Bytes reply = desk.received();
    ASSERT_EQ(reply.size(), 239u) << address_text(to);
    EXPECT_EQ(Bytes(reply.begin() + 10, reply.begin() + 14), (Bytes{127, 0, 0, 2})) << "IpAddress";
    EXPECT_EQ(Bytes(reply.begin() + 207, reply.begin() + 211), (Bytes{127, 0, 0, 2})) << "BindIp";
  }
}

TEST(AmongOthers, APollFromAnyPortIsAnsweredToTheStandardPortToo) {
  AmongOthers served("artnet", kLoopback + 1);
  const auto listener = share_udp(served.port(), kLoopback);
  ASSERT_TRUE(listener) << listener.error().detail;
  Sender().send(kLoopback + 1, served.port(), kArtPoll);
  served.serve(at_s(0.1));
  EXPECT_EQ(Sender::received_by(listener->descriptor.get(), 5000).size(), 239u);
}

TEST(AmongOthers, AProgramOnAllAddressesMayHaveTheSamePortButNoOtherSimulator) {
  AmongOthers served("artnet");
  EXPECT_TRUE(share_udp(served.port(), kAnyAddress));
  EndpointPlace same;
  same.port = served.port();
  same.among_others = true;
  const auto second = RigServer::open(served.rig, *served.world, served.faults, {{"dmx", same}});
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().detail.find("another luxrig-sim listens on 127.0.0.1 port"), std::string::npos)
      << second.error().detail;
}

TEST(AmongOthers, OnAllAddressesAPacketArrivesOnce) {
  AmongOthers served("sacn", kAnyAddress);
  const Sender desk;
  // Were multicast heard twice, the second copy would be out of order, and the world would not show it. So count.
  desk.send(sacn_group(1), served.port(), sacn_one_slot(0, 255));
  std::vector<pollfd> waiting;
  for (const int descriptor : served.server->descriptors()) waiting.push_back({descriptor, POLLIN, 0});
  ASSERT_EQ(::poll(waiting.data(), waiting.size(), 5000), 1);
  served.serve_only(at_s(0.1));
  served.serve_only(at_s(0.2));
  EXPECT_EQ(served.world->drives()[0], 1);
}

TEST(AmongOthers, AnAddressOfAnotherComputerIsRefusedWithAMend) {
  const auto socket = bind_udp(0, 0xc0000201);  // 192.0.2.1, for documentation
  ASSERT_FALSE(socket);
  EXPECT_NE(socket.error().detail.find("192.0.2.1"), std::string::npos) << socket.error().detail;
  EXPECT_NE(socket.error().detail.find("this computer has no such address"), std::string::npos);
}

}  // namespace
}  // namespace luxrig::sim
