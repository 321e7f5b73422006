// The endpoints over real loopback sockets, under a clock that the test steps.
#include "sim/wire/rig_server.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>

#include "tests/sim/tiny_rig.h"
#include "tests/sim/wire/sacn_one_slot.h"

namespace luxrig::sim {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

// A UDP or TCP client of a loopback port.
class Client {
 public:
  Client(int type, int port) : fd_(::socket(AF_INET, type | SOCK_CLOEXEC, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    connected_ = ::connect(fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
  }
  ~Client() { ::close(fd_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  [[nodiscard]] bool connected() const { return connected_; }
  void send(const Bytes& bytes) const { ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL); }
  /// Bytes received after waiting at most that long; empty if none. `closed`: the peer hung up.
  Bytes received(int wait_ms, bool* closed = nullptr) const {
    pollfd readable{fd_, POLLIN, 0};
    if (::poll(&readable, 1, wait_ms) <= 0) return {};
    Bytes bytes(2048);
    const auto size = ::recv(fd_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (closed != nullptr) *closed = size == 0;
    bytes.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return bytes;
  }

 private:
  int fd_;
  bool connected_ = false;
};

struct Served {
  explicit Served(const std::string& dmx_driver)
      : rig(tiny_rig(dmx_driver)), world(tiny_world(rig)), server(std::move(*RigServer::open(rig, *world, faults))) {}

  // Waits until the bytes on their way to the server have arrived, then serves at `now`.
  void serve(Time now) {
    std::vector<pollfd> waiting;
    for (const int descriptor : server->descriptors()) waiting.push_back({descriptor, POLLIN, 0});
    ::poll(waiting.data(), waiting.size(), 1000);
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

Bytes artdmx_two_slots(std::uint8_t level) {
  return {'A', 'r', 't', '-', 'N', 'e', 't', 0, 0, 0x50, 0, 14, 0, 0, 1, 0, 0, 2, level, 0};
}

const Bytes kReadMeter1 = {0, 1, 0, 0, 0, 6, 1, 3, 0, 2, 0, 2};
const Bytes kWriteBulb500 = {0, 2, 0, 0, 0, 6, 10, 6, 0, 0, 0x01, 0xf4};

TEST(RigServer, ASacnPacketRaisesItsFixture) {
  Served served("sacn");
  const Client desk(SOCK_DGRAM, served.server->ports().at("dmx"));
  desk.send(sacn_one_slot(0, 255));
  served.serve(at_s(0.1));
  served.serve_only(at_s(0.2));
  EXPECT_EQ(served.world->drives()[0], 1);
  EXPECT_DOUBLE_EQ(served.world->points()[0].lux, 100);
}

TEST(RigServer, AnArtDmxPacketRaisesItToo) {
  Served served("artnet");
  const Client desk(SOCK_DGRAM, served.server->ports().at("dmx"));
  desk.send(artdmx_two_slots(51));
  served.serve(at_s(0.1));
  EXPECT_DOUBLE_EQ(served.world->drives()[0], 0.2);
  desk.send({'A', 'r', 't', '-', 'N', 'e', 't', 0, 0, 0x20, 0, 14, 2, 0});
  served.serve(at_s(0.2));
  EXPECT_EQ(desk.received(1000).size(), 239u);
}

TEST(RigServer, ASilentFixtureOrBusKeepsItsLight) {
  for (const char* device : {"dmx", "spot-1"}) {
    for (const FaultKind fault : {FaultKind::silent, FaultKind::garbled}) {
      Served served("sacn");
      const Client desk(SOCK_DGRAM, served.server->ports().at("dmx"));
      desk.send(sacn_one_slot(0, 51));
      served.serve(at_s(0.1));
      served.faults.set(device, fault, true);
      desk.send(sacn_one_slot(1, 255));
      served.serve(at_s(0.2));
      EXPECT_DOUBLE_EQ(served.world->drives()[0], 0.2) << device << ' ' << name_of(fault);
      served.faults.set(device, fault, false);
      desk.send(sacn_one_slot(2, 255));
      served.serve(at_s(0.3));
      EXPECT_EQ(served.world->drives()[0], 1) << device << ' ' << name_of(fault);
    }
  }
}

TEST(RigServer, ABurntOutOrUnpoweredLampGoesDarkWithoutFurtherPackets) {
  for (const FaultKind fault : {FaultKind::lamp_failure, FaultKind::unpowered}) {
    for (const char* driver : {"sacn", "artnet"}) {
      Served served(driver);
      const Client desk(SOCK_DGRAM, served.server->ports().at("dmx"));
      const bool sacn = std::string(driver) == "sacn";
      desk.send(sacn ? sacn_one_slot(0, 255) : artdmx_two_slots(255));
      served.serve(at_s(0.1));
      ASSERT_EQ(served.world->drives()[0], 1);
      served.faults.set("spot-1", fault, true);
      served.serve_only(at_s(0.2));
      served.serve_only(at_s(0.3));
      EXPECT_EQ(served.world->points()[0].lux, 0) << driver << ' ' << name_of(fault);
      desk.send(sacn ? sacn_one_slot(1, 255) : artdmx_two_slots(255));
      served.serve(at_s(0.4));
      served.serve_only(at_s(0.5));
      EXPECT_EQ(served.world->points()[0].lux, 0) << driver << ' ' << name_of(fault);
      served.faults.clear();
      desk.send(sacn ? sacn_one_slot(2, 255) : artdmx_two_slots(255));
      served.serve(at_s(0.6));
      EXPECT_EQ(served.world->drives()[0], 1) << driver << ' ' << name_of(fault);
    }
  }
}

TEST(RigServer, ASlowBusActsLateAndInOrder) {
  Served served("sacn");
  const Client desk(SOCK_DGRAM, served.server->ports().at("dmx"));
  served.faults.set("dmx", FaultKind::slow, true, 300);
  desk.send(sacn_one_slot(0, 51));
  served.serve(at_s(0.1));
  served.faults.clear();
  desk.send(sacn_one_slot(1, 255));
  served.serve(at_s(0.2));
  EXPECT_EQ(served.world->drives()[0], 0);
  served.serve_only(at_s(0.39));
  EXPECT_EQ(served.world->drives()[0], 0);
  served.serve_only(at_s(0.4));
  EXPECT_EQ(served.world->drives()[0], 1);
}

TEST(RigServer, DropsOvertakenSacnButAppliesOvertakenArtDmxWithoutANumber) {
  for (const char* driver : {"sacn", "artnet"}) {
    const bool sacn = std::string_view(driver) == "sacn";
    Served served(driver);
    const Client desk(SOCK_DGRAM, served.server->ports().at("dmx"));
    served.faults.set("dmx", FaultKind::reordered, true, 1);
    desk.send(sacn ? sacn_one_slot(1, 51) : artdmx_two_slots(51));
    served.serve(at_s(0.1));
    EXPECT_EQ(served.world->drives()[0], 0) << driver << ": not there yet";
    served.faults.clear();
    desk.send(sacn ? sacn_one_slot(2, 255) : artdmx_two_slots(255));
    served.serve(at_s(0.12));
    EXPECT_EQ(served.world->drives()[0], 1) << driver;
    served.serve_only(at_s(0.2));
    EXPECT_DOUBLE_EQ(served.world->drives()[0], sacn ? 1 : 0.2) << driver;
  }
}

TEST(RigServer, ADuplicatedPacketActsOnce) {
  Served served("sacn");
  const Client desk(SOCK_DGRAM, served.server->ports().at("dmx"));
  served.faults.set("dmx", FaultKind::duplicated, true, 1);
  desk.send(sacn_one_slot(0, 51));
  served.serve(at_s(0.1));
  EXPECT_DOUBLE_EQ(served.world->drives()[0], 0.2);
  desk.send(sacn_one_slot(1, 255));
  served.serve(at_s(0.2));
  EXPECT_EQ(served.world->drives()[0], 1);
}

TEST(RigServer, ADeadBusComesBackOnTheSamePort) {
  Served served("sacn");
  const int port = served.server->ports().at("dmx");
  served.faults.set("dmx", FaultKind::dead, true);
  served.serve_only(at_s(0.1));
  served.faults.clear();
  served.serve_only(at_s(0.2));
  EXPECT_EQ(served.server->ports().at("dmx"), port);
  const Client desk(SOCK_DGRAM, port);
  desk.send(sacn_one_slot(0, 255));
  served.serve(at_s(0.3));
  EXPECT_EQ(served.world->drives()[0], 1);
}

TEST(RigServer, AMeterReadsInMilliluxAndADimmerScalesToFull) {
  Served served("sacn");
  const Client master(SOCK_STREAM, served.server->ports().at("field"));
  ASSERT_TRUE(master.connected());
  master.send(kWriteBulb500);  // of 1000
  served.serve(at_s(0.1));     // accepts, and reads what is there
  served.serve_only(at_s(0.11));
  EXPECT_EQ(master.received(1000), kWriteBulb500);
  EXPECT_DOUBLE_EQ(served.world->drives()[2], 0.5);
  served.serve_only(at_s(1));
  master.send(kReadMeter1);
  served.serve(at_s(1.1));
  // 0.5 of 200 lx, 0.001 lx a count: 100000 = 0x000186a0.
  EXPECT_EQ(master.received(1000), (Bytes{0, 1, 0, 0, 0, 7, 1, 3, 4, 0x00, 0x01, 0x86, 0xa0}));
}

TEST(RigServer, FaultsOfAMeterAffectNoOtherUnit) {
  Served served("sacn");
  const Client master(SOCK_STREAM, served.server->ports().at("field"));
  Bytes other = kReadMeter1;
  other[6] = 2;
  served.faults.set("meter-1", FaultKind::silent, true);
  master.send(kReadMeter1);
  master.send(other);
  served.serve(at_s(0.1));
  served.serve_only(at_s(0.1));
  const Bytes answer = master.received(1000);
  ASSERT_EQ(answer.size(), 13u);
  EXPECT_EQ(answer[6], 2);
  served.faults.set("meter-1", FaultKind::silent, false);
  served.faults.set("meter-1", FaultKind::exception, true, 6);
  master.send(kReadMeter1);
  served.serve(at_s(0.2));
  EXPECT_EQ(master.received(1000), (Bytes{0, 1, 0, 0, 0, 3, 1, 0x83, 6}));
}

TEST(RigServer, ASlowMeterAnswersAfterItsDelay) {
  Served served("sacn");
  const Client master(SOCK_STREAM, served.server->ports().at("field"));
  served.faults.set("meter-1", FaultKind::slow, true, 300);
  master.send(kReadMeter1);
  served.serve(at_s(0.1));
  served.serve_only(at_s(0.1));
  served.serve_only(at_s(0.399));
  EXPECT_TRUE(master.received(0).empty());
  served.serve_only(at_s(0.4));
  EXPECT_EQ(master.received(1000).size(), 13u);
}

TEST(RigServer, DisconnectsOnInvalidModbusAndWhenItsBusDies) {
  Served served("sacn");
  const int port = served.server->ports().at("field");
  const Client rude(SOCK_STREAM, port), polite(SOCK_STREAM, port);
  rude.send({'G', 'E', 'T', ' ', '/', ' ', 'H', 'T', 'T', 'P'});
  served.serve(at_s(0.1));
  served.serve_only(at_s(0.1));
  bool closed = false;
  rude.received(1000, &closed);
  EXPECT_TRUE(closed);
  polite.send(kReadMeter1);
  served.serve(at_s(0.2));
  EXPECT_EQ(polite.received(1000).size(), 13u);
  served.faults.set("field", FaultKind::dead, true);
  served.serve_only(at_s(0.3));
  closed = false;
  polite.received(1000, &closed);
  EXPECT_TRUE(closed);
  EXPECT_FALSE(Client(SOCK_STREAM, port).connected());
  served.faults.clear();
  served.serve_only(at_s(0.4));
  EXPECT_TRUE(Client(SOCK_STREAM, port).connected());
}

TEST(RigServer, NamesATakenPortAndAnUnknownDriver) {
  Served served("sacn");
  const int port = served.server->ports().at("field");
  const auto again = RigServer::open(served.rig, *served.world, served.faults, {{"field", {port}}});
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().device, "field");
  EXPECT_NE(again.error().detail.find(std::to_string(port)), std::string::npos) << again.error().detail;
  const Rig strange = tiny_rig("smoke_signals");
  const auto none = RigServer::open(strange, *served.world, served.faults);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().detail.find("sacn, artnet, enttec_pro, open_dmx, udmx, modbus_tcp"), std::string::npos)
      << none.error().detail;
}

}  // namespace
}  // namespace luxrig::sim
