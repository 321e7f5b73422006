// A recording sent again: when, where, with which numbers, and how it ends.
#include "tools/recording/desk_player.h"

#include <gtest/gtest.h>

#include "drivers/dmx/artnet/artnet_codec.h"
#include "tests/loopback_desk.h"
#include "tests/tools/recording/capture_bytes.h"

namespace luxrig::recording {
namespace {

using std::chrono::milliseconds;

/// Packets of one source of universe 1, a second apart; number by number.
Recording desk_recording(Protocol protocol, const std::vector<std::uint8_t>& numbers) {
  Recording recording;
  recording.sources.push_back({protocol, "desk", {}, {0x0A000005, 5568}, false, {1}, 0});
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto value = static_cast<std::uint8_t>(i);
    std::vector<std::uint8_t> bytes = {value, 9};
    if (protocol == Protocol::sacn) bytes = test::sacn_packet(1, numbers[i], {value});
    if (protocol == Protocol::artnet) bytes = test::artdmx_packet(1, numbers[i], {value});
    recording.dmx.push_back({std::chrono::seconds(i), 0, 1, bytes});
    recording.length = std::chrono::seconds(i);
  }
  return recording;
}

PlayerSettings to_sacn(bool repeats = false, double speed = 1) {
  return {{true}, {{Protocol::sacn, std::nullopt, 5568, std::nullopt}}, speed, repeats};
}
PlayerSettings to_artnet(bool repeats) {
  return {{true}, {{Protocol::artnet, 0x0A000001, 6454, std::nullopt}}, 1, repeats};
}

TEST(DeskPlayer, EachPacketIsSentAtItsTimeWithItsNumber) {
  const Recording recording = desk_recording(Protocol::sacn, {7, 9, 8});
  DeskPlayer player(recording, to_sacn());
  EXPECT_EQ(player.packets(), 3u);
  EXPECT_EQ(player.next(), Duration{});
  const auto first = player.due(milliseconds(999));
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(text_of(first[0].to), "239.255.0.1:5568");
  const auto packet = sacn::decode(first[0].bytes);
  ASSERT_TRUE(packet.has_value());
  EXPECT_EQ(packet->sequence, 7);
  EXPECT_EQ(packet->source_name, "X");
  EXPECT_EQ(packet->slots.size(), 512u);
  EXPECT_NE(packet->cid[0], 0xAB) << "the recorded desk may be there too";
  EXPECT_EQ(player.next(), milliseconds(1000));
  const auto rest = player.due(milliseconds(5000));
  ASSERT_EQ(rest.size(), 2u);
  EXPECT_EQ(sacn::decode(rest[0].bytes)->sequence, 9) << "as the network had it";
  EXPECT_EQ(sacn::decode(rest[1].bytes)->sequence, 8);
  EXPECT_EQ(sacn::decode(rest[1].bytes)->cid, packet->cid);
  EXPECT_EQ(player.next(), std::nullopt);
}

TEST(DeskPlayer, SpeedShortensTheTime) {
  const Recording recording = desk_recording(Protocol::sacn, {1, 2, 3});
  DeskPlayer player(recording, to_sacn(false, 4));
  EXPECT_EQ(player.due(milliseconds(249)).size(), 1u);
  EXPECT_EQ(player.due(milliseconds(500)).size(), 2u);
}

TEST(DeskPlayer, NumbersGoOnWhenItRepeats) {
  const auto numbers = [](Protocol protocol, PlayerSettings settings) {
    const Recording recording =
        desk_recording(protocol, {254, 255, protocol == Protocol::sacn ? std::uint8_t{0} : std::uint8_t{1}});
    DeskPlayer player(recording, std::move(settings));
    std::vector<int> all;
    for (const auto& one : player.due(milliseconds(2 * 2025 + 500)))
      all.push_back(protocol == Protocol::sacn ? sacn::decode(one.bytes)->sequence
                                               : artnet::decode_dmx(one.bytes)->sequence);
    return all;
  };
  EXPECT_EQ(numbers(Protocol::sacn, to_sacn(true)), (std::vector<int>{254, 255, 0, 1, 2, 3, 4}));
  EXPECT_EQ(numbers(Protocol::artnet, to_artnet(true)), (std::vector<int>{254, 255, 1, 2, 3, 4, 5}));
}

TEST(DeskPlayer, ASenderThatDoesNotCountStaysSo) {
  const Recording recording = desk_recording(Protocol::artnet, {0, 0});
  DeskPlayer player(recording, to_artnet(true));
  for (const auto& one : player.due(std::chrono::seconds(10))) EXPECT_EQ(artnet::decode_dmx(one.bytes)->sequence, 0);
}

TEST(DeskPlayer, SacnEndsWithThreeGoodbyesUnlessItsRecordingHasThem) {
  Recording recording = desk_recording(Protocol::sacn, {255});
  DeskPlayer player(recording, to_sacn());
  EXPECT_TRUE(player.goodbyes().empty()) << "nothing was sent";
  (void)player.due(Duration{});
  const auto all = player.goodbyes();
  ASSERT_EQ(all.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(sacn::decode(all[i].bytes)->terminated);
    EXPECT_EQ(sacn::decode(all[i].bytes)->sequence, i);
    EXPECT_EQ(text_of(all[i].to), "239.255.0.1:5568");
  }
  recording.dmx[0].bytes[112] = 0x40;
  DeskPlayer ended(recording, to_sacn());
  (void)ended.due(Duration{});
  EXPECT_TRUE(ended.goodbyes().empty());
  const Recording by_artnet = desk_recording(Protocol::artnet, {1});
  DeskPlayer artnet(by_artnet, to_artnet(false));
  (void)artnet.due(Duration{});
  EXPECT_TRUE(artnet.goodbyes().empty()) << "Art-Net has none";
}

TEST(DeskPlayer, OnlyWhatIsChosenIsSent) {
  const Recording recording = desk_recording(Protocol::sacn, {1});
  EXPECT_EQ(DeskPlayer(recording, to_artnet(true)).packets(), 0u) << "another protocol";
  PlayerSettings settings = to_sacn();
  settings.sources = {false};
  EXPECT_EQ(DeskPlayer(recording, settings).packets(), 0u) << "another source";
  settings.sources = {true};
  settings.receivers[0].universes = std::set<int>{2};
  EXPECT_EQ(DeskPlayer(recording, settings).packets(), 0u) << "another universe";
  settings.receivers[0] = {Protocol::sacn, 0x7F000001, 5570, std::set<int>{1}};
  DeskPlayer player(recording, settings);
  EXPECT_EQ(text_of(player.due(Duration{})[0].to), "127.0.0.1:5570");
}

TEST(DeskPlayer, AShowByOlaGoesToEveryProtocol) {
  const Recording recording = desk_recording(Protocol::ola, {0, 0});
  PlayerSettings settings = to_sacn();
  settings.receivers.push_back(to_artnet(false).receivers[0]);
  DeskPlayer player(recording, settings);
  const auto all = player.due(std::chrono::seconds(1));
  ASSERT_EQ(all.size(), 4u);
  const auto first = sacn::decode(all[0].bytes), second = sacn::decode(all[2].bytes);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->slots, (std::vector<std::uint8_t>{0, 9}));
  EXPECT_EQ(second->sequence, first->sequence + 1);
  const auto dmx = artnet::decode_dmx(all[3].bytes);
  ASSERT_TRUE(dmx.has_value());
  EXPECT_EQ(dmx->slots, (std::vector<std::uint8_t>{1, 9}));
  EXPECT_EQ(dmx->port_address, 1);
  EXPECT_EQ(player.goodbyes().size(), 3u);
}

}  // namespace
}  // namespace luxrig::recording
