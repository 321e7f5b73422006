/// RDM end to end: client and link against the simulated node over loopback, in real time. Also discovery against
/// simulated responders: two independent readings of one standard.
#include <gtest/gtest.h>

#include <thread>

#include "drivers/dmx/artnet/artnet_codec.h"
#include "drivers/dmx/artnet/artnet_rdm.h"
#include "drivers/dmx/rdm/rdm_discovery.h"
#include "drivers/dmx/rdm/rdm_profile.h"
#include "drivers/io/udp.h"
#include "sim/devices/rdm_line.h"
#include "tests/conformance/far_end.h"
#include "tests/drivers/test_rig.h"
#include "tests/random.h"

namespace luxrig {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr rdm::Uid kAsking{0x7ff0, 0xabcd};
constexpr int kUniverse = 0x0102;

Rig rdm_rig() {
  Rig rig = rig_with(bus_of("artnet"));
  Luminaire spot;
  spot.name = "spot-28";
  spot.lumens = 1000;
  spot.intensity = make_isotropic(1000);
  rig.luminaires = {spot};
  add_dmx(rig, "lamp", kUniverse, 5);
  add_head(rig, "head", kUniverse, 100);
  return rig;
}

class RdmOverArtnet : public ::testing::Test {
 protected:
  RdmOverArtnet()
      : far_end_(rdm_rig()),
        channel_(make_udp({})),
        link_(*channel_, {0x7F000001, static_cast<std::uint16_t>(far_end_.port())}, kUniverse),
        client_(link_, kAsking) {
    EXPECT_TRUE(channel_->open());
  }

  static Time now() { return Time{} + std::chrono::steady_clock::now().time_since_epoch(); }

  Result<Bytes> ask(const rdm::Request& request) {
    client_.begin(request);
    for (;;) {
      client_.step(now());
      if (auto answer = client_.take()) return *answer;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  Result<Bytes> set(const rdm::Uid& uid, rdm::Pid pid, Bytes data) {
    return ask({uid, rdm::CommandClass::set, pid, std::move(data)});
  }

  /// The devices, lamp first.
  std::vector<rdm::Uid> table() {
    EXPECT_TRUE(link_.flush_table());
    for (int i = 0; i < 2000 && !link_.table().complete; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      link_.listen();
    }
    return {link_.table().uids.begin(), link_.table().uids.end()};
  }

  /// Puts a level on one slot; returns the lamp's drive after it.
  double drive_by_slot(int address, std::uint8_t level) {
    artnet::Dmx dmx;
    dmx.port_address = kUniverse;
    dmx.slots.assign(512, 0);
    dmx.slots[static_cast<std::size_t>(address - 1)] = level;
    EXPECT_TRUE(channel_->send(link_.node(), encode(dmx)));
    far_end_.serve_what_arrived();
    return far_end_.drives()[0];
  }

  FarEnd far_end_;
  std::unique_ptr<DatagramChannel> channel_;
  artnet::ArtnetRdmLink link_;
  rdm::Client client_;
};

TEST_F(RdmOverArtnet, ReadsTheWholeProfileOfEachFixture) {
  const auto uids = table();
  ASSERT_EQ(uids.size(), 2u);
  const rdm::Ask asking = [this](const rdm::Request& request) { return ask(request); };
  const auto head = rdm::read_profile(asking, uids[1]);
  ASSERT_TRUE(head) << head.error().detail;
  EXPECT_EQ(head->label, "head");
  EXPECT_EQ(head->model, "spot-28");
  EXPECT_EQ(head->manufacturer, "Luxrig, simulated");
  EXPECT_EQ(head->info.start_address, 100);
  EXPECT_EQ(head->info.footprint_slots, 7);
  EXPECT_EQ(head->slots.size(), 7u);
  EXPECT_EQ(head->lamp_hours, 137u);  // by ACK_TIMER and the queue
  ASSERT_EQ(head->sensors.size(), 1u);
  ASSERT_TRUE(head->sensors[0].value);
  EXPECT_EQ(rdm::text_of(head->sensors[0].definition, head->sensors[0].value->present), "25.0 °C");
  EXPECT_EQ(head->lamp, rdm::LampState::off);
}

TEST_F(RdmOverArtnet, SettingAStartAddressMovesWhereTheLampListens) {
  const auto uids = table();
  ASSERT_EQ(uids.size(), 2u);
  EXPECT_NEAR(drive_by_slot(5, 255), 1, 1e-9);
  EXPECT_EQ(drive_by_slot(300, 0), 0);
  const auto moved = set(uids[0], rdm::Pid::dmx_start_address, rdm::encode_start_address(300));
  ASSERT_TRUE(moved) << moved.error().detail;
  EXPECT_EQ(drive_by_slot(5, 255), 0);
  EXPECT_NEAR(drive_by_slot(300, 255), 1, 1e-9);
  const auto refused = set(uids[1], rdm::Pid::dmx_start_address, rdm::encode_start_address(512));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().cause, Cause::refused);
  EXPECT_NE(refused.error().detail.find("out of range"), std::string::npos);
}

TEST_F(RdmOverArtnet, SurvivesLostGarbledAndLateAnswers) {
  const auto uids = table();
  ASSERT_EQ(uids.size(), 2u);
  const rdm::Request hours{uids[0], rdm::CommandClass::get, rdm::Pid::device_hours};
  far_end_.faults().set("lamp", sim::FaultKind::slow, true, 300);
  EXPECT_TRUE(ask(hours));
  far_end_.faults().clear();
  far_end_.faults().set("lamp", sim::FaultKind::lost, true, 0.3);
  int answered = 0;
  for (int i = 0; i < 8; ++i) answered += ask(hours) ? 1 : 0;
  EXPECT_GE(answered, 6);
  far_end_.faults().clear();
  far_end_.faults().set("lamp", sim::FaultKind::garbled, true);
  const auto spoiled = ask(hours);
  ASSERT_FALSE(spoiled);
  EXPECT_EQ(spoiled.error().cause, Cause::timeout);
  far_end_.faults().clear();
  EXPECT_TRUE(ask(hours));
  far_end_.faults().set("lamp", sim::FaultKind::unpowered, true);
  EXPECT_EQ(table(), std::vector<rdm::Uid>{uids[1]});
}

/// Our discovery on a simulated line.
class SimulatedLine final : public rdm::DiscoveryLine {
 public:
  explicit SimulatedLine(sim::RdmLine& line) : line_(line) {}
  Result<void> un_mute_everybody() override {
    exchange(rdm::un_mute_request(kAsking, ++number_));
    return {};
  }
  Result<Bytes> ask_branch(const rdm::Uid& lowest, const rdm::Uid& highest) override {
    return exchange(rdm::unique_branch_request(kAsking, ++number_, lowest, highest));
  }
  Result<bool> mute(const rdm::Uid& who) override {
    const auto answer = rdm::decode(exchange(rdm::mute_request(kAsking, ++number_, who)));
    return answer && answer->from == who && answer->pid == rdm::Pid::disc_mute;
  }

 private:
  Bytes exchange(const rdm::Packet& packet) { return line_.exchange({}, rdm::encode(packet)).bytes; }
  sim::RdmLine& line_;
  std::uint8_t number_ = 0;
};

TEST(RdmDiscoveryOfSimulatedResponders, FindsThemAll) {
  sim::Faults faults(1);
  sim::RdmLine line(faults);
  Random random(3);
  std::set<rdm::Uid> wanted;
  while (wanted.size() < 120) {
    wanted.insert(
        {static_cast<std::uint16_t>(random.below(3) + 0x7ff0), static_cast<std::uint32_t>(random.below(500))});
  }
  for (const rdm::Uid& uid : wanted) {
    sim::RdmIdentity identity;
    identity.uid = rdm::number_of(uid);
    line.add(rdm::text_of(uid), identity);
  }
  SimulatedLine simulated(line);
  const auto result = rdm::discover(simulated);
  ASSERT_TRUE(result);
  EXPECT_EQ(std::set<rdm::Uid>(result->found.begin(), result->found.end()), wanted);
  EXPECT_TRUE(result->unmutable.empty() && result->complete);
}

}  // namespace
}  // namespace luxrig
