#include "drivers/dmx/artnet/artnet_codec.h"

#include <gtest/gtest.h>

#include "tests/drivers/hex.h"

namespace luxrig::artnet {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// A reply of a two-output node at net 1, sub-net 2: an ArtPollReply dump with the fields that matter.
Bytes reply_bytes() {
  Bytes bytes(239, 0);
  const auto put = [&](std::size_t at, const Bytes& part) { std::copy(part.begin(), part.end(), bytes.begin() + at); };
  put(0, from_hex("4172742d4e657400 0021"));  // "Art-Net\0", OpPollReply low byte first
  put(10, from_hex("0a000007 3619"));         // IP, port low byte first
  put(18, from_hex("01 02"));                 // net switch, sub switch
  put(26, from_hex("4e6f6465"));              // short name "Node"
  put(44, from_hex("4c6f6e67"));              // long name "Long"
  put(172, from_hex("0003"));                 // ports
  put(174, from_hex("80 40 80 00"));          // output, input, output
  put(190, from_hex("03 04 05 00"));          // SwOut
  bytes[211] = 1;                             // bind index
  return bytes;
}

TEST(ArtnetCodec, WritesArtDmxAsPublished) {
  EXPECT_EQ(encode({1, 0, 0x0123, {255, 128}}), from_hex("4172742d4e657400 0050 000e 01 00 23 01 0002 ff80"));
  Dmx full{255, 0, 32767, Bytes(512, 7)};
  const Bytes bytes = encode(full);
  ASSERT_EQ(bytes.size(), 530u);
  EXPECT_EQ(Bytes(bytes.begin() + 12, bytes.begin() + 18), from_hex("ff 00 ff 7f 0200"));
}

TEST(ArtnetCodec, WritesArtPollAsPublished) { EXPECT_EQ(encode_poll(), from_hex("4172742d4e657400 0020 000e 02 00")); }

TEST(ArtnetCodec, RoundTrips) {
  const Dmx packet{9, 0, 0x1234, {1, 2, 3, 4}};
  const auto back = decode_dmx(encode(packet));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->port_address, 0x1234);
  EXPECT_EQ(back->sequence, 9);
  EXPECT_EQ(back->slots, packet.slots);
}

TEST(ArtnetCodec, IgnoresBytesAfterTheSlotsAndAcceptsLaterVersions) {
  Bytes bytes = encode(Dmx{9, 0, 0x1234, {1, 2, 3, 4}});
  bytes.push_back(99);
  bytes[10] = 1;  // version 270
  const auto packet = decode_dmx(bytes);
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->slots, (Bytes{1, 2, 3, 4}));
  bytes[10] = 0;
  bytes[11] = 13;
  EXPECT_FALSE(decode_dmx(bytes)) << "an earlier version";
  bytes[11] = 14;
  bytes.resize(21);
  EXPECT_FALSE(decode_dmx(bytes)) << "a slot is missing";
}

TEST(ArtnetCodec, ReadsTheUniversesThatANodeOutputs) {
  const auto reply = decode_poll_reply(reply_bytes());
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->short_name, "Node");
  EXPECT_EQ(reply->long_name, "Long");
  EXPECT_EQ(reply->bind_index, 1);
  ASSERT_EQ(reply->outputs.size(), 2u);
  EXPECT_EQ(reply->outputs[0].port_address, 0x0123);
  EXPECT_EQ(reply->outputs[1].port_address, 0x0125);
}

TEST(ArtnetCodec, AcceptsShortRepliesOfOlderNodes) {
  Bytes bytes = reply_bytes();
  bytes.resize(207);
  const auto reply = decode_poll_reply(bytes);
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->bind_index, 0);
  EXPECT_EQ(reply->outputs.size(), 2u);
  bytes.resize(206);
  EXPECT_FALSE(decode_poll_reply(bytes));
}

TEST(ArtnetCodec, SurvivesEveryTruncationAndEveryChangedByte) {
  const Bytes good = reply_bytes();
  for (std::size_t size = 0; size < good.size(); ++size) (void)decode_poll_reply({good.data(), size});
  for (std::size_t at = 0; at < good.size(); ++at) {
    for (int value = 0; value < 256; ++value) {
      Bytes bad = good;
      bad[at] = static_cast<std::uint8_t>(value);
      const auto reply = decode_poll_reply(bad);
      if (at < 10) {
        EXPECT_EQ(reply.has_value(), bad == good);
      }
      if (!reply) continue;
      for (const PortOutput& port : reply->outputs) {
        EXPECT_GE(port.port_address, 0);
        EXPECT_LE(port.port_address, kHighestPortAddress);
      }
    }
  }
}

TEST(ArtnetCodec, ReplacesControlCharactersInNodeNames) {
  Bytes bytes = reply_bytes();
  bytes[27] = 0x1B;
  EXPECT_EQ(decode_poll_reply(bytes)->short_name, "N?de");
}

TEST(ArtnetCodec, WritesArtSyncAsPublished) {
  EXPECT_EQ(encode_sync(), from_hex("4172742d4e657400 0052 000e 00 00"));
  EXPECT_TRUE(is_sync(encode_sync()));
  EXPECT_FALSE(is_sync(encode_poll()));
}

TEST(ArtnetCodec, ReadsPollsWithAndWithoutTheirRangeOfPorts) {
  const auto whole = decode_poll(encode_poll());
  ASSERT_TRUE(whole);
  EXPECT_TRUE(whole->reply_on_change);
  EXPECT_EQ(whole->highest_port_address, kHighestPortAddress);
  const auto targeted = decode_poll(from_hex("4172742d4e657400 0020 000e 20 00 0123 0120 0000 00ff"));
  ASSERT_TRUE(targeted);
  EXPECT_EQ(targeted->highest_port_address, 0x0123);
  EXPECT_EQ(targeted->lowest_port_address, 0x0120);
}

TEST(ArtnetCodec, RoundTripsAPollReply) {
  PollReply reply;
  reply.short_name = "a name that is too long";
  reply.long_name = "Luxrig test";
  reply.bind_index = 2;
  reply.mac = {2, 1, 2, 3, 4, 5};
  reply.outputs = {{0x0123, true, false, false}, {0x012F, true, true, true}};
  const Bytes bytes = encode(reply, 0x0A000007);
  ASSERT_EQ(bytes.size(), 239u);
  EXPECT_EQ(Bytes(bytes.begin(), bytes.begin() + 20), from_hex("4172742d4e657400 0021 0a000007 3619 0001 01 02"));
  EXPECT_EQ(Bytes(bytes.begin() + 172, bytes.begin() + 176), from_hex("0002 80 80"));
  EXPECT_EQ(Bytes(bytes.begin() + 182, bytes.begin() + 184), from_hex("80 8a"));
  EXPECT_EQ(Bytes(bytes.begin() + 190, bytes.begin() + 192), from_hex("03 0f"));
  EXPECT_EQ(Bytes(bytes.begin() + 201, bytes.begin() + 213), from_hex("020102030405 0a000007 02 08"));
  const auto back = decode_poll_reply(bytes);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->short_name, "a name that is to");  // 17 and its NUL
  EXPECT_EQ(back->mac, reply.mac);
  ASSERT_EQ(back->outputs.size(), 2u);
  EXPECT_TRUE(back->outputs[1].merging && back->outputs[1].ltp && !back->outputs[0].merging);
}

TEST(ArtnetCodec, WritesArtAddressThatChangesOnlyItsCommand) {
  const Bytes bytes = encode(Address{1, AddressCommand::merge_ltp, 2});
  ASSERT_EQ(bytes.size(), 107u);
  EXPECT_EQ(Bytes(bytes.begin(), bytes.begin() + 14), from_hex("4172742d4e657400 0060 000e 7f 01"));
  EXPECT_EQ(Bytes(bytes.begin() + 96, bytes.end()), from_hex("7f7f7f7f 7f7f7f7f 7f ff 12"));
  const auto back = decode_address(bytes);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->command, AddressCommand::merge_ltp);
  EXPECT_EQ(back->port, 2);
  EXPECT_EQ(decode_address(encode(Address{1, AddressCommand::cancel_merge, 0}))->command, AddressCommand::cancel_merge);
  EXPECT_EQ(encode(Address{1, AddressCommand::cancel_merge, 3}).back(), 1);
}

TEST(ArtnetCodec, ShowsPortAddressesAsNodesDo) {
  EXPECT_EQ(text_of_port_address(0), "0:0:0");
  EXPECT_EQ(text_of_port_address(0x0123), "1:2:3");
  EXPECT_EQ(text_of_port_address(32767), "127:15:15");
}

}  // namespace
}  // namespace luxrig::artnet
