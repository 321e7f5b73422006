#include "drivers/dmx/sacn/sacn_codec.h"

#include <gtest/gtest.h>

#include "tests/drivers/hex.h"

namespace luxrig::sacn {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes part(const Bytes& bytes, std::size_t from, std::size_t to) {
  return {bytes.begin() + static_cast<std::ptrdiff_t>(from), bytes.begin() + static_cast<std::ptrdiff_t>(to)};
}

DataPacket full_packet() {
  DataPacket packet;
  packet.cid = {0x01, 0x23, 0x45, 0x67, 0x89, 0xAB, 0x4D, 0xEF, 0x81, 0x23, 0x45, 0x67, 0x89, 0xAB, 0xCD, 0xEF};
  packet.source_name = "Luxrig gallery";
  packet.slots.assign(512, 0);
  return packet;
}

TEST(SacnCodec, WritesAFullUniverseAsTheStandardPrintsIt) {
  const Bytes bytes = encode(full_packet());
  ASSERT_EQ(bytes.size(), 638u);
  // preamble size, postamble size, "ASC-E1.17\0\0\0", root flags and length
  EXPECT_EQ(part(bytes, 0, 18), from_hex("0010 0000 4153432d45312e3137000000 726e"));
  EXPECT_EQ(part(bytes, 18, 22), from_hex("00000004"));                          // root vector: data
  EXPECT_EQ(part(bytes, 22, 38), from_hex("0123456789ab4def8123456789abcdef"));  // CID
  EXPECT_EQ(part(bytes, 38, 44), from_hex("7258 00000002"));                     // framing length, vector
  EXPECT_EQ(part(bytes, 44, 60), from_hex("4c75787269672067616c6c657279 0000"));
  // priority, sync universe, sequence, options, universe, DMP length, vector, type, first, increment, count, start code
  EXPECT_EQ(part(bytes, 108, 126), from_hex("64 0000 00 00 0001 720b 02 a1 0000 0001 0201 00"));
}

TEST(SacnCodec, WritesAShortPacketWithItsOwnLengths) {
  DataPacket packet = full_packet();
  packet.universe = 3;
  packet.sequence = 7;
  packet.slots = {1, 2, 3};
  const Bytes bytes = encode(packet);
  ASSERT_EQ(bytes.size(), 129u);
  EXPECT_EQ(part(bytes, 16, 18), from_hex("7071"));
  EXPECT_EQ(part(bytes, 38, 40), from_hex("705b"));
  EXPECT_EQ(part(bytes, 108, 129), from_hex("64 0000 07 00 0003 700e 02 a1 0000 0001 0004 00 010203"));
}

TEST(SacnCodec, EncodesEachOptionInItsBit) {
  DataPacket packet = full_packet();
  packet.preview = true;
  EXPECT_EQ(encode(packet)[112], 0x80);
  packet = full_packet();
  packet.terminated = true;
  EXPECT_EQ(encode(packet)[112], 0x40);
  packet = full_packet();
  packet.force_sync = true;
  EXPECT_EQ(encode(packet)[112], 0x20);
}

TEST(SacnCodec, CutsALongNameAtACharacterAndEndsItWithNul) {
  DataPacket packet = full_packet();
  packet.source_name = std::string(62, 'x') + "ä";  // the last character would reach the place of the NUL
  const Bytes bytes = encode(packet);
  EXPECT_EQ(bytes[44 + 61], 'x');
  EXPECT_EQ(bytes[44 + 62], 0);
  EXPECT_EQ(bytes[44 + 63], 0);
}

TEST(SacnCodec, AcceptsASourceNameThatFillsItsField) {
  Bytes bytes = encode(full_packet());
  std::fill_n(bytes.begin() + 44, 64, 'x');
  const auto packet = decode(bytes);
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->source_name, std::string(64, 'x'));
}

TEST(SacnCodec, RoundTrips) {
  DataPacket packet = full_packet();
  packet.universe = 63999;
  packet.priority = 200;
  packet.sequence = 255;
  packet.sync_universe = 9;
  packet.terminated = true;
  for (const std::size_t slots : {0u, 1u, 511u, 512u}) {
    packet.slots.assign(slots, 0x5A);
    const auto back = decode(encode(packet));
    ASSERT_TRUE(back);
    EXPECT_EQ(back->cid, packet.cid);
    EXPECT_EQ(back->source_name, packet.source_name);
    EXPECT_EQ(back->universe, 63999);
    EXPECT_EQ(back->priority, 200);
    EXPECT_EQ(back->sequence, 255);
    EXPECT_EQ(back->sync_universe, 9);
    EXPECT_TRUE(back->terminated);
    EXPECT_FALSE(back->preview);
    EXPECT_EQ(back->slots, packet.slots);
  }
}

TEST(SacnCodec, RefusesEveryTruncationAndEveryChangeOfAFixedField) {
  const Bytes good = encode(full_packet());
  for (std::size_t size = 0; size < good.size(); ++size) EXPECT_FALSE(decode(part(good, 0, size))) << size;
  Bytes longer = good;
  longer.push_back(0);
  EXPECT_FALSE(decode(longer));
  for (std::size_t at = 0; at < 126; ++at) {
    const bool free = (at >= 22 && at < 38) || (at >= 44 && at < 115) || at == 125;
    if (free) continue;
    for (const int flip : {0x01, 0x80, 0xFF}) {
      Bytes bad = good;
      bad[at] = static_cast<std::uint8_t>(bad[at] ^ flip);
      EXPECT_FALSE(decode(bad)) << at;
    }
  }
}

TEST(SacnCodec, RefusesUniverseZeroAndPriority201) {
  Bytes bytes = encode(full_packet());
  bytes[108] = 201;
  EXPECT_FALSE(decode(bytes));
  bytes = encode(full_packet());
  bytes[114] = 0;
  EXPECT_FALSE(decode(bytes));
}

TEST(SacnCodec, GivesTheMulticastGroupOfAUniverse) {
  EXPECT_EQ(multicast_group(1), 0xEFFF0001u);      // 239.255.0.1
  EXPECT_EQ(multicast_group(63999), 0xEFFFF9FFu);  // 239.255.249.255
}

}  // namespace
}  // namespace luxrig::sacn
