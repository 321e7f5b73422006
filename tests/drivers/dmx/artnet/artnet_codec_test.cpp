#include "drivers/dmx/artnet/artnet_codec.h"

#include <gtest/gtest.h>

#include "tests/drivers/hex.h"

namespace luxrig::artnet {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// A reply of a two-output node at net 1, sub-net 2, as an ArtPollReply dump of the fields that matter.
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

TEST(ArtnetCodec, ReadsBackWhatItWrites) {
  const Dmx packet{9, 0, 0x1234, {1, 2, 3, 4}};
  const auto back = decode_dmx(encode(packet));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->port_address, 0x1234);
  EXPECT_EQ(back->sequence, 9);
  EXPECT_EQ(back->slots, packet.slots);
}

TEST(ArtnetCodec, ReadsWhichUniversesANodePutsOut) {
  const auto reply = decode_poll_reply(reply_bytes());
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->short_name, "Node");
  EXPECT_EQ(reply->long_name, "Long");
  EXPECT_EQ(reply->bind_index, 1);
  EXPECT_EQ(reply->output_port_addresses, (std::vector<int>{0x0123, 0x0125}));
}

TEST(ArtnetCodec, TakesTheShortRepliesOfOlderNodes) {
  Bytes bytes = reply_bytes();
  bytes.resize(207);
  const auto reply = decode_poll_reply(bytes);
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->bind_index, 0);
  EXPECT_EQ(reply->output_port_addresses.size(), 2u);
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
      for (const int port_address : reply->output_port_addresses) {
        EXPECT_GE(port_address, 0);
        EXPECT_LE(port_address, kHighestPortAddress);
      }
    }
  }
}

TEST(ArtnetCodec, LetsNoControlCharacterOfANodeIntoAReport) {
  Bytes bytes = reply_bytes();
  bytes[27] = 0x1B;
  EXPECT_EQ(decode_poll_reply(bytes)->short_name, "N?de");
}

TEST(ArtnetCodec, ShowsPortAddressesAsNodesDo) {
  EXPECT_EQ(text_of_port_address(0), "0:0:0");
  EXPECT_EQ(text_of_port_address(0x0123), "1:2:3");
  EXPECT_EQ(text_of_port_address(32767), "127:15:15");
}

}  // namespace
}  // namespace luxrig::artnet
