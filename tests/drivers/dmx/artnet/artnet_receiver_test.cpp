#include "drivers/dmx/artnet/artnet_receiver.h"

#include <gtest/gtest.h>

#include "tests/drivers/test_rig.h"

namespace luxrig::artnet {
namespace {

using Verdict = Receiver::Verdict;

const SocketAddress kOne{0x0A000001, kPort}, kTwo{0x0A000002, kPort}, kThree{0x0A000003, kPort};

ReceiverSettings node_of(std::vector<int> port_addresses = {1}) {
  ReceiverSettings settings;
  settings.port_addresses = std::move(port_addresses);
  settings.short_name = "Luxrig";
  settings.long_name = "Luxrig test";
  settings.mac = {2, 1, 2, 3, 4, 5};
  return settings;
}

Verdict send(Receiver& receiver, double ms, const SocketAddress& from, int level, int sequence = 0, int universe = 1) {
  Dmx packet{static_cast<std::uint8_t>(sequence), 0, universe, std::vector<std::uint8_t>(512, 0)};
  packet.slots[0] = static_cast<std::uint8_t>(level);
  return receiver.receive(at_ms(ms), from, encode(packet));
}
int level(Receiver& receiver, double ms) { return receiver.heard(at_ms(ms), 1).levels.slots[0]; }
DeskPresence presence(Receiver& receiver, double ms) { return receiver.heard(at_ms(ms), 1).presence; }

TEST(ArtnetInput, FollowsADeskAtOnceAndLosesItAfterTenSeconds) {
  Receiver receiver(node_of());
  EXPECT_EQ(presence(receiver, 0), DeskPresence::unknown);
  EXPECT_EQ(send(receiver, 100, kOne, 42), Verdict::taken);
  EXPECT_EQ(presence(receiver, 101), DeskPresence::present);
  EXPECT_EQ(receiver.heard(at_ms(101), 1).source, "10.0.0.1");
  EXPECT_EQ(presence(receiver, 10100), DeskPresence::present);
  EXPECT_EQ(presence(receiver, 10101), DeskPresence::absent);
  EXPECT_EQ(level(receiver, 10101), 42);
}

TEST(ArtnetInput, ReportsNoDeskOnlyAfterTheSlowestRefresh) {
  Receiver receiver(node_of());
  EXPECT_EQ(presence(receiver, 0), DeskPresence::unknown);
  EXPECT_EQ(presence(receiver, 3999), DeskPresence::unknown);
  EXPECT_EQ(presence(receiver, 4000), DeskPresence::absent);
}

TEST(ArtnetInput, FollowsTheSequenceRuleUnlessTheNumberIsZero) {
  Receiver receiver(node_of());
  EXPECT_EQ(send(receiver, 0, kOne, 1, 100), Verdict::taken);
  EXPECT_EQ(send(receiver, 1, kOne, 2, 100), Verdict::out_of_order);
  EXPECT_EQ(send(receiver, 2, kOne, 3, 81), Verdict::out_of_order);
  EXPECT_EQ(level(receiver, 3), 1);
  EXPECT_EQ(send(receiver, 4, kOne, 4, 80), Verdict::taken);  // 20 behind: a desk that restarted
  EXPECT_EQ(send(receiver, 5, kOne, 5, 255), Verdict::taken);
  EXPECT_EQ(send(receiver, 6, kOne, 6, 1), Verdict::taken);  // 255, then wraps, skipping 0
  EXPECT_EQ(send(receiver, 7, kOne, 7, 0), Verdict::taken);
  EXPECT_EQ(send(receiver, 8, kOne, 8, 0), Verdict::taken);
  EXPECT_EQ(level(receiver, 9), 8);
}

TEST(ArtnetInput, MergesTwoSendersIgnoresAThirdAndForgetsASilentOne) {
  Receiver receiver(node_of());
  send(receiver, 0, kOne, 200);
  send(receiver, 10, kTwo, 90);
  EXPECT_EQ(send(receiver, 20, kThree, 255), Verdict::third_sender);
  EXPECT_EQ(level(receiver, 21), 200);
  for (double ms = 1000; ms <= 10000; ms += 1000) send(receiver, ms, kTwo, 90);
  EXPECT_EQ(level(receiver, 10000), 200);
  EXPECT_EQ(level(receiver, 10001), 90);
  EXPECT_EQ(send(receiver, 10002, kThree, 255), Verdict::taken);
}

TEST(ArtnetInput, FollowsArtAddressMergeCommands) {
  Receiver receiver(node_of());
  send(receiver, 0, kOne, 200);
  send(receiver, 10, kTwo, 90);
  receiver.receive(at_ms(20), kTwo, encode(Address{1, AddressCommand::merge_ltp, 0}));
  send(receiver, 30, kTwo, 91);
  EXPECT_EQ(level(receiver, 31), 91);
  receiver.receive(at_ms(40), kTwo, encode(Address{1, AddressCommand::merge_htp, 0}));
  send(receiver, 50, kTwo, 92);
  EXPECT_EQ(level(receiver, 51), 200);
  receiver.receive(at_ms(60), kTwo, encode(Address{1, AddressCommand::cancel_merge, 0}));
  EXPECT_EQ(level(receiver, 61), 200);  // only the next ArtDmx decides the owner
  send(receiver, 70, kTwo, 93);
  EXPECT_EQ(level(receiver, 71), 93);
  // Packet for another page: ignored.
  receiver.receive(at_ms(80), kTwo, encode(Address{2, AddressCommand::merge_ltp, 0}));
  send(receiver, 90, kOne, 10);
  EXPECT_EQ(level(receiver, 91), 93);
}

TEST(ArtnetInput, WaitsForItsSendersArtSyncAndFallsBackAfterFourSeconds) {
  Receiver receiver(node_of());
  send(receiver, 0, kOne, 10);
  receiver.receive(at_ms(10), kTwo, encode_sync());  // not the source of the data it shows
  send(receiver, 20, kOne, 20);
  EXPECT_EQ(level(receiver, 21), 20);
  receiver.receive(at_ms(30), kOne, encode_sync());
  send(receiver, 40, kOne, 30);
  EXPECT_EQ(level(receiver, 41), 20);
  receiver.receive(at_ms(50), kOne, encode_sync());
  EXPECT_EQ(level(receiver, 51), 30);
  send(receiver, 60, kOne, 40);
  EXPECT_EQ(level(receiver, 4050), 30);
  EXPECT_EQ(level(receiver, 4051), 40);
  send(receiver, 4060, kOne, 50);
  EXPECT_EQ(level(receiver, 4061), 50);
}

TEST(ArtnetInput, DoesNotSynchroniseWhileItMerges) {
  Receiver receiver(node_of());
  send(receiver, 0, kOne, 10);
  receiver.receive(at_ms(5), kOne, encode_sync());
  send(receiver, 10, kTwo, 20);
  EXPECT_EQ(level(receiver, 11), 20);
  receiver.receive(at_ms(15), kOne, encode_sync());
  send(receiver, 20, kOne, 30);
  EXPECT_EQ(level(receiver, 21), 30);
}

TEST(ArtnetInput, AnswersPollsAfterItsDelayWithFourPortsAPage) {
  ReceiverSettings settings = node_of({0x10, 0x11, 0x12, 0x13, 0x14, 0x20});
  settings.reply_delay = std::chrono::milliseconds(300);
  Receiver receiver(settings);
  EXPECT_EQ(receiver.receive(at_ms(0), kOne, encode_poll()), Verdict::taken);
  EXPECT_TRUE(receiver.answers_due(at_ms(299)).empty());
  const auto answers = receiver.answers_due(at_ms(300));
  ASSERT_EQ(answers.size(), 3u);
  EXPECT_EQ(answers[0].to, kOne);
  EXPECT_EQ(answers[0].reply.outputs.size(), 4u);
  EXPECT_EQ(answers[1].reply.bind_index, 2);
  EXPECT_EQ(answers[1].reply.outputs.at(0).port_address, 0x14);
  EXPECT_EQ(answers[2].reply.outputs.at(0).port_address, 0x20);
  EXPECT_TRUE(receiver.answers_due(at_ms(301)).empty());
  // A controller hears the receiver's own replies.
  const auto heard = decode_poll_reply(encode(answers[0].reply, 0x0A000009));
  ASSERT_TRUE(heard);
  EXPECT_EQ(heard->outputs.size(), 4u);
  EXPECT_EQ(heard->mac, settings.mac);
}

TEST(ArtnetInput, ReportsMergingToControllers) {
  Receiver receiver(node_of());
  send(receiver, 0, kOne, 200);
  send(receiver, 10, kTwo, 90);
  receiver.receive(at_ms(20), kOne, encode_poll());
  const auto answers = receiver.answers_due(at_ms(20));
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_TRUE(answers[0].reply.outputs.at(0).merging);
  EXPECT_FALSE(answers[0].reply.outputs.at(0).ltp);
}

TEST(ArtnetInput, IgnoresOtherUniverses) {
  Receiver receiver(node_of());
  EXPECT_EQ(presence(receiver, 0), DeskPresence::unknown);
  EXPECT_EQ(send(receiver, 0, kOne, 1, 0, 2), Verdict::not_for_us);
  EXPECT_EQ(receiver.receive(at_ms(1), kOne, std::vector<std::uint8_t>(20, 0)), Verdict::not_for_us);
  EXPECT_EQ(presence(receiver, 5000), DeskPresence::absent);
}

}  // namespace
}  // namespace luxrig::artnet
