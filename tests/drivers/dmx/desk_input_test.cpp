/// DMX drivers as inputs of a show: the desk's request for each fixture, silence, and answers to the desk.
#include <gtest/gtest.h>

#include "drivers/dmx/artnet/artnet_codec.h"
#include "drivers/dmx/artnet/artnet_driver.h"
#include "drivers/dmx/dmx_patch.h"
#include "drivers/dmx/sacn/sacn_codec.h"
#include "drivers/dmx/sacn/sacn_driver.h"
#include "tests/drivers/io/scripted_datagram.h"
#include "tests/drivers/test_rig.h"

namespace luxrig {
namespace {

using Options = std::vector<std::pair<std::string, OptionValue>>;

struct InputBench {
  InputBench(const std::string& protocol, Options options) {
    rig = rig_with(bus_of(protocol, std::move(options)));
    add_dmx(rig, "spot", 1, 5);
    add_head(rig, "head", 2, 10);
    if (protocol == "sacn") {
      EXPECT_TRUE(check_sacn(rig, 0).empty());
      std::vector<std::unique_ptr<DatagramChannel>> channels;
      channels.push_back(std::make_unique<ScriptedDatagram>(net));
      driver = make_sacn_over(std::move(channels), rig, 0, std::nullopt);
    } else {
      EXPECT_TRUE(check_artnet(rig, 0).empty());
      driver = make_artnet_over(std::make_unique<ScriptedDatagram>(net), rig, 0, std::nullopt);
    }
    input = driver->level_input();
    EXPECT_TRUE(driver->activate(at_ms(0)));
  }
  void sacn(int universe, std::vector<std::uint8_t> slots, std::uint8_t sequence) {
    sacn::DataPacket packet;
    packet.cid[0] = 7;
    packet.source_name = "desk";
    packet.priority = 120;
    packet.universe = static_cast<std::uint16_t>(universe);
    packet.sequence = sequence;
    packet.slots = std::move(slots);
    net->incoming.push_back({{0x0A000063, 5568}, encode(packet)});
  }
  void artnet(const std::vector<std::uint8_t>& bytes) { net->incoming.push_back({{0x0A000063, 6454}, bytes}); }
  Result<void> write(double ms) {
    const LevelCommand commands[] = {{0, 0.5}, {1, 0.5}};
    return driver->level_output()->write(at_ms(ms), commands);
  }

  std::shared_ptr<DatagramScript> net = std::make_shared<DatagramScript>();
  Rig rig;
  std::unique_ptr<Driver> driver;
  LevelInput* input = nullptr;
};

std::vector<std::uint8_t> slots_with(std::vector<std::pair<int, int>> values) {
  std::vector<std::uint8_t> slots(512, 0);
  for (const auto& [address, value] : values)
    slots[static_cast<std::size_t>(address - 1)] = static_cast<std::uint8_t>(value);
  return slots;
}

TEST(DeskInput, IsAbsentUnlessConfigured) {
  InputBench bench("sacn", {});
  EXPECT_EQ(bench.input, nullptr);
  EXPECT_TRUE(bench.net->joined.empty());
}

TEST(DeskInput, ReadsADesksCommandsPerFixtureOverSacn) {
  InputBench bench("sacn", {{"input", std::string("takeover")}, {"input_offset", std::int64_t{100}}});
  ASSERT_NE(bench.input, nullptr);
  const auto parts = bench.input->parts();
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].name, "the-bus, universe 1");
  EXPECT_EQ(parts[1].fixtures, (std::vector<std::size_t>{1}));
  for (int i = 0; i <= 80; ++i) {
    const auto sequence = static_cast<std::uint8_t>(i);
    bench.sacn(101, slots_with({{5, 255}}), sequence);
    bench.sacn(102, slots_with({{10, 128}, {11, 0}, {12, 0}, {13, 0}, {14, 0x80}, {15, 0x00}}), sequence);
    bench.sacn(1, slots_with({{5, 77}}), sequence);  // Luxrig's own number, not the desk's
    (void)bench.input->listen(at_ms(i * 25.0));
  }
  const auto frames = bench.input->listen(at_ms(2000));
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0].presence, DeskPresence::present);
  EXPECT_EQ(frames[0].source, "desk");
  ASSERT_EQ(frames[0].commands.size(), 1u);
  EXPECT_DOUBLE_EQ(frames[0].commands[0].drive, 1);
  EXPECT_FALSE(frames[0].commands[0].joints);
  ASSERT_EQ(frames[1].commands.size(), 1u);
  EXPECT_NEAR(frames[1].commands[0].drive, 0x8000 / 65535.0, 1e-12);
  ASSERT_TRUE(frames[1].commands[0].joints);
  EXPECT_NEAR(frames[1].commands[0].joints->pan_rad, rad_from_deg(-270 + 540 * 0x8000 / 65535.0), 1e-9);
  EXPECT_NEAR(frames[1].commands[0].joints->tilt_rad, rad_from_deg(-135), 1e-9);
  EXPECT_EQ(bench.net->joined, (std::set<std::uint32_t>{sacn::multicast_group(101), sacn::multicast_group(102)}));
}

TEST(DeskInput, OmitsAFixtureWhoseSlotsAreNotSent) {
  InputBench bench("sacn", {{"input", std::string("merge")}});
  for (int i = 0; i <= 80; ++i) {
    bench.sacn(1, {1, 2, 3, 4}, static_cast<std::uint8_t>(i));  // the spot is slot 5
    (void)bench.input->listen(at_ms(i * 25.0));
  }
  const auto frames = bench.input->listen(at_ms(2000));
  EXPECT_EQ(frames[0].presence, DeskPresence::present);
  EXPECT_TRUE(frames[0].commands.empty());
}

TEST(DeskInput, RoundTripsThePatchsOwnOutput) {
  Rig rig = rig_with(bus_of("sacn"));
  add_dmx(rig, "spot", 1, 5);
  add_head(rig, "head", 1, 10);
  DmxPatchbay bay(rig, 0);
  std::bitset<kDmxSlots> all;
  all.set();
  for (int i = 0; i <= 100; ++i) {
    const double drive = i / 100.0;
    const AimCommand aim{1, {rad_from_deg(-270 + 5.4 * i), rad_from_deg(135 - 2.7 * i)}};
    ASSERT_TRUE(bay.set_aims({&aim, 1}));
    const LevelCommand commands[] = {{0, drive}, {1, drive}};
    ASSERT_TRUE(bay.set_levels(commands));
    const auto read = bay.decode(0, bay.universes()[0].slots, all);
    ASSERT_EQ(read.size(), 2u);
    EXPECT_NEAR(read[0].drive, drive, 0.5 / 255 + 1e-12);
    EXPECT_NEAR(read[1].drive, drive, 0.5 / 65535 + 1e-12);
    EXPECT_NEAR(read[1].joints->pan_rad, aim.joints.pan_rad, rad_from_deg(270.0 / 65535) + 1e-12);
    EXPECT_NEAR(read[1].joints->tilt_rad, aim.joints.tilt_rad, rad_from_deg(135.0 / 65535) + 1e-12);
  }
}

TEST(DeskInput, RoundTripsThreeBytesAndPartialRanges) {
  Rig rig = rig_with(bus_of("sacn"));
  add_dmx(rig, "cells", 1, 500);
  const DmxTravel middle{0.25, 0.75}, falling{1, 0};
  std::get<DmxPatch>(rig.fixtures[0].patch).slots = {{SlotUse::dimmer_ultra, 0, true, 0, middle},
                                                     {SlotUse::dimmer, 0, true, 0, middle},
                                                     {SlotUse::constant, 77},
                                                     {SlotUse::dimmer_fine, 0, true, 0, middle},
                                                     {SlotUse::dimmer, 0, true, 1, falling}};
  DmxPatchbay bay(rig, 0);
  std::bitset<kDmxSlots> all;
  all.set();
  for (int i = 0; i <= 100; ++i) {
    const LevelCommand command{0, i / 100.0};
    ASSERT_TRUE(bay.set_levels({&command, 1}));
    DmxSlots slots = bay.universes()[0].slots;
    slots[503] = 255;  // the falling cell is dark: only the other's three bytes count
    EXPECT_NEAR(bay.decode(0, slots, all)[0].drive, command.drive, 1.0 / 16777215);
    slots[499] = slots[500] = slots[502] = 0;  // below its travel
    EXPECT_DOUBLE_EQ(bay.decode(0, slots, all)[0].drive, 0);
    slots[503] = bay.universes()[0].slots[503];
    EXPECT_NEAR(bay.decode(0, slots, all)[0].drive, command.drive, 0.5 / 255 + 1e-12);
  }
  all.reset(502);
  EXPECT_TRUE(bay.decode(0, bay.universes()[0].slots, all).empty());
}

TEST(DeskInput, RoundTripsADimmerAboveDarkAndAShutterClosedAtLevel0) {
  Rig rig = rig_with(bus_of("sacn"));
  add_dmx(rig, "lamp", 1, 500);
  const double open = 40 / 255.0, shut = 15 / 255.0;
  std::get<DmxPatch>(rig.fixtures[0].patch).slots = {
      {SlotUse::dimmer, 0, true, 0, DmxTravel{16 / 255.0, 215 / 255.0, 0.1, 0.0}},
      {SlotUse::dimmer, 0, true, 1, DmxTravel{open, open, 0, shut}}};
  DmxPatchbay bay(rig, 0);
  std::bitset<kDmxSlots> all;
  all.set();
  for (const auto& [drive, dimmer, shutter] : {std::tuple(0.0, 0, 15), {0.05, 0, 40}, {0.1, 16, 40}, {1.0, 215, 40}}) {
    const LevelCommand command{0, drive};
    ASSERT_TRUE(bay.set_levels({&command, 1}));
    const DmxSlots& slots = bay.universes()[0].slots;
    EXPECT_EQ(slots[499], dimmer) << drive;
    EXPECT_EQ(slots[500], shutter) << drive;
    EXPECT_NEAR(bay.decode(0, slots, all)[0].drive, dimmer == 0 ? 0 : drive, 1e-9) << "an open shutter tells no level";
  }
}

TEST(DeskInput, FallsSilentPerUniverseWithThreeGoodbyes) {
  InputBench bench("sacn", {{"input", std::string("standby")}});
  bench.input->set_silent(at_ms(0), 0, true);
  EXPECT_TRUE(bench.net->sent.empty());  // nothing was sent, so there is nothing to end
  ASSERT_TRUE(bench.write(0));
  ASSERT_EQ(bench.net->sent.size(), 1u);
  EXPECT_EQ(sacn::decode(bench.net->sent[0].bytes)->universe, 2);
  bench.net->sent.clear();
  bench.input->set_silent(at_ms(23), 1, true);
  bench.input->set_silent(at_ms(23), 1, true);
  ASSERT_EQ(bench.net->sent.size(), 3u);
  for (const auto& [to, bytes] : bench.net->sent) EXPECT_TRUE(sacn::decode(bytes)->terminated);
  ASSERT_TRUE(bench.write(46));
  EXPECT_EQ(bench.net->sent.size(), 3u);
  bench.input->set_silent(at_ms(60), 1, false);
  ASSERT_TRUE(bench.write(69));
  ASSERT_EQ(bench.net->sent.size(), 4u);
  EXPECT_FALSE(sacn::decode(bench.net->sent[3].bytes)->terminated);
}

TEST(DeskInput, StandsByOnlyForSourcesThatOutrankIt) {
  InputBench bench("sacn", {{"input", std::string("standby")}, {"priority", std::int64_t{150}}});
  for (int i = 0; i <= 80; ++i) {
    bench.sacn(1, slots_with({{5, 255}}), static_cast<std::uint8_t>(i));  // priority 120
    (void)bench.input->listen(at_ms(i * 25.0));
  }
  EXPECT_EQ(bench.input->listen(at_ms(2500))[0].presence, DeskPresence::absent);
}

TEST(DeskInput, IsFoundByAnArtnetDeskAndFollowsIt) {
  InputBench bench("artnet", {{"input", std::string("merge")}, {"input_offset", std::int64_t{16}}});
  bench.artnet(artnet::encode_poll());
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(bench.write(i * 23.0));
  std::set<int> found;
  std::optional<std::vector<std::uint8_t>> answer;
  for (const auto& [to, bytes] : bench.net->sent) {
    const auto reply = artnet::decode_poll_reply(bytes);
    if (!reply) continue;
    EXPECT_EQ(text_of(to), "10.0.0.99:6454");
    answer = bytes;
    for (const auto& port : reply->outputs) found.insert(port.port_address);
  }
  EXPECT_EQ(found, (std::set<int>{17, 18}));
  artnet::Dmx packet{1, 0, 17, slots_with({{5, 51}})};
  bench.artnet(artnet::encode(packet));
  const auto frames = bench.input->listen(at_ms(2000));
  EXPECT_EQ(frames[0].presence, DeskPresence::present);
  EXPECT_EQ(frames[0].source, "10.0.0.99");
  ASSERT_EQ(frames[0].commands.size(), 1u);
  EXPECT_DOUBLE_EQ(frames[0].commands[0].drive, 0.2);
  // A broadcast brings back its own answer: it must not become its own subscriber.
  ASSERT_TRUE(answer);
  bench.artnet(*answer);
  ASSERT_TRUE(bench.write(2023));
  EXPECT_EQ(bench.driver->health(at_ms(2023)).size(), 1u);
}

TEST(DeskInput, LeavesNodesNothingToMergeWhenItFallsSilent) {
  InputBench bench("artnet", {{"input", std::string("standby")}});
  artnet::PollReply node;
  node.short_name = "node";
  node.bind_index = 3;
  node.outputs = {{1, true, false, false}};
  bench.artnet(artnet::encode(node, 0x0A000063));
  ASSERT_TRUE(bench.write(0));
  bench.net->sent.clear();
  bench.input->set_silent(at_ms(23), 0, true);
  ASSERT_EQ(bench.net->sent.size(), 1u);
  const auto address = artnet::decode_address(bench.net->sent[0].bytes);
  ASSERT_TRUE(address);
  EXPECT_EQ(address->command, artnet::AddressCommand::cancel_merge);
  EXPECT_EQ(address->bind_index, 3);
}

TEST(DeskInput, RefusesInvalidInputOptions) {
  const auto problem = [](Options options) {
    Rig rig = rig_with(bus_of("sacn", std::move(options)));
    add_dmx(rig, "spot", 1, 5);
    const auto problems = check_sacn(rig, 0);
    EXPECT_EQ(problems.size(), 1u);
    return problems.empty() ? std::string() : problems[0].text();
  };
  EXPECT_EQ(problem({{"input", std::string("standy")}}),
            "a/rig.toml:8:5: input = \"standy\" is not known: did you mean \"standby\"?");
  problem({{"input_hand_back", std::string("never")}});
  problem({{"input_merge", std::string("highest")}});
  EXPECT_EQ(problem({{"input", std::string("merge")}, {"input_offset", std::int64_t{-1}}}),
            "a/rig.toml:9:5: fixture \"spot\": the desk's universe 1 + -1 does not exist: keep the sum in 1…63999");
}

}  // namespace
}  // namespace luxrig
