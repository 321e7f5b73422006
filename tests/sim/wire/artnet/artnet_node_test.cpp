#include "sim/wire/artnet/artnet_node.h"

#include <gtest/gtest.h>

#include "tests/sim/tiny_rig.h"

namespace luxrig::sim {
namespace {

using namespace std::chrono_literals;
using Packet = std::vector<std::uint8_t>;

constexpr int kPort = 0x0123;
constexpr std::uint32_t kDesk = 0x0a000001, kOther = 0x0a000002, kThird = 0x0a000003;

// ArtDmx for port address 0x0123, levels 255 and 128.
Packet two_slots() {
  return {
      'A',  'r',  't', '-', 'N', 'e', 't', 0,  // 0 id
      0x00, 0x50,                              // 8 OpCode 0x5000, low byte first
      0x00, 0x0e,                              // 10 protocol version 14
      0x01,                                    // 12 sequence
      0x00,                                    // 13 physical
      0x23,                                    // 14 sub-net 2, universe 3
      0x01,                                    // 15 net 1
      0x00, 0x02,                              // 16 length
      0xff, 0x80                               // 18 data
  };
}

Packet levels_of(std::uint8_t first, std::uint8_t sequence = 0) {
  Packet packet = two_slots();
  packet[12] = sequence;
  packet[18] = first;
  return packet;
}

Packet art_poll() {
  return {
      'A',  'r',  't', '-', 'N', 'e', 't', 0,  // 0 id
      0x00, 0x20,                              // 8 OpCode 0x2000
      0x00, 0x0e,                              // 10 protocol version
      0x02,                                    // 12 flags: reply on change
      0x00                                     // 13 diagnostics priority
  };
}

Packet art_sync() {
  return {
      'A',  'r',  't', '-', 'N', 'e', 't', 0,  // 0 id
      0x00, 0x52,                              // 8 OpCode 0x5200
      0x00, 0x0e,                              // 10 protocol version
      0x00, 0x00                               // 12 aux
  };
}

int first_slot_of_port(ArtnetNode& node, Time now) {
  const auto levels = node.levels(kPort, now);
  return levels ? (*levels)[0] : -1;
}

TEST(ArtnetFarEnd, ReadsEveryFieldOfArtDmx) {
  Packet packet = two_slots();
  packet[13] = 4;
  const auto dmx = decode_art_dmx(packet);
  ASSERT_TRUE(dmx);
  EXPECT_EQ(dmx->sequence, 1);
  EXPECT_EQ(dmx->physical, 4);
  EXPECT_EQ(dmx->port_address, 0x0123);
  EXPECT_EQ(Packet(dmx->slots.begin(), dmx->slots.end()), (Packet{0xff, 0x80}));
}

TEST(ArtnetFarEnd, RefusesEveryTruncation) {
  for (const Packet& whole : {two_slots(), art_poll(), art_sync()}) {
    for (std::size_t length = 0; length < whole.size(); ++length) {
      const Packet cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
      EXPECT_FALSE(decode_art_dmx(cut) || is_art_poll(cut) || is_art_sync(cut)) << length;
    }
  }
}

TEST(ArtnetFarEnd, RefusesEveryOtherHeader) {
  for (std::size_t at = 0; at < 10; ++at) {
    for (int change = 1; change < 256; ++change) {
      Packet packet = two_slots();
      packet[at] ^= static_cast<std::uint8_t>(change);
      EXPECT_FALSE(decode_art_dmx(packet)) << at;
    }
  }
}

TEST(ArtnetFarEnd, AcceptsLaterProtocolVersionsButNoEarlierOnes) {
  for (const auto& [version, good] : {std::pair{0, false}, {13, false}, {14, true}, {15, true}, {0x0100, true}}) {
    Packet packet = two_slots();
    packet[10] = static_cast<std::uint8_t>(version >> 8);
    packet[11] = static_cast<std::uint8_t>(version & 0xff);
    EXPECT_EQ(decode_art_dmx(packet).has_value(), good) << version;
  }
}

TEST(ArtnetFarEnd, RefusesOddZeroExcessiveAndTruncatedLengths) {
  for (const auto& [length, good] : {std::pair{0, false},
                                     {1, false},
                                     {2, true},
                                     {3, false},
                                     {4, true},
                                     {512, true},
                                     {513, false},
                                     {514, false},
                                     {0xffff, false}}) {
    Packet packet = two_slots();
    packet.resize(18 + 514, 0);
    packet[16] = static_cast<std::uint8_t>(length >> 8);
    packet[17] = static_cast<std::uint8_t>(length & 0xff);
    EXPECT_EQ(decode_art_dmx(packet).has_value(), good) << length;
  }
  Packet promised = two_slots();
  promised[17] = 4;
  EXPECT_FALSE(decode_art_dmx(promised));
  Packet net = two_slots();
  net[15] = 0x80;
  EXPECT_FALSE(decode_art_dmx(net));  // a net has 7 bits
}

TEST(ArtnetFarEnd, OutputsOnlyItsOwnPorts) {
  ArtnetNode node({kPort});
  EXPECT_FALSE(node.levels(kPort, at_s(0)));
  EXPECT_TRUE(node.receive(at_s(0), kDesk, two_slots()).empty());
  const auto levels = node.levels(kPort, at_s(0));
  ASSERT_TRUE(levels);
  EXPECT_EQ((*levels)[0], 255);
  EXPECT_EQ((*levels)[1], 128);
  EXPECT_EQ((*levels)[2], 0);
  Packet other = two_slots();
  other[14] = 0x24;
  node.receive(at_s(0), kDesk, other);
  EXPECT_FALSE(node.levels(0x0124, at_s(0)));
  EXPECT_EQ(node.accepted(), 1u);
}

TEST(ArtnetFarEnd, AnswersAPollWithEveryFieldOfItsReply) {
  ArtnetNode node({0x0123, 0x0125});
  node.receive(at_s(0), kDesk, two_slots());
  const auto replies = node.receive(at_s(1), kDesk, art_poll());
  ASSERT_EQ(replies.size(), 1u);
  const Packet& reply = replies[0];
  const Packet head = {
      'A',  'r',  't', '-', 'N', 'e', 't', 0,  // 0 id
      0x00, 0x21,                              // 8 OpCode 0x2100
      127,  0,    0,   1,                      // 10 address
      0x36, 0x19,                              // 14 port 6454, low byte first
      0x00, 0x01,                              // 16 firmware
      0x01,                                    // 18 NetSwitch
      0x02,                                    // 19 SubSwitch
      0x00, 0xff,                              // 20 OEM: unknown
      0x00,                                    // 22 UBEA
      0x00,                                    // 23 Status1
      0x00, 0x00                               // 24 ESTA
  };
  const Packet ports = {
      0x00, 0x02,              // 172 NumPorts
      0x80, 0x80, 0, 0,        // 174 PortTypes: DMX from the network
      0,    0,    0, 0,        // 178 GoodInput
      0x80, 0x00, 0, 0,        // 182 GoodOutputA: the first puts data out
      0,    0,    0, 0,        // 186 SwIn
      0x03, 0x05, 0, 0,        // 190 SwOut
      0,    0,    0,           // 194 AcnPriority, SwMacro, SwRemote
      0,    0,    0,           // 197 spare
      0,                       // 200 Style: node
      0,    0,    0, 0, 0, 0,  // 201 MAC
      127,  0,    0, 1,        // 207 BindIp
      0x01,                    // 211 BindIndex
      0x08,                    // 212 Status2: 15-bit port addresses
      0,    0,    0, 0,        // 213 GoodOutputB
      0x00                     // 217 Status3: failsafe holds
  };
  ASSERT_EQ(reply.size(), 239u);
  EXPECT_EQ(Packet(reply.begin(), reply.begin() + 26), head);
  EXPECT_STREQ(reinterpret_cast<const char*>(&reply[26]), "simulated node");
  EXPECT_STREQ(reinterpret_cast<const char*>(&reply[44]), "Luxrig simulated Art-Net node");
  EXPECT_STREQ(reinterpret_cast<const char*>(&reply[108]), "#0001 [0001] ok");
  EXPECT_EQ(Packet(reply.begin() + 172, reply.begin() + 218), ports);
  EXPECT_EQ(Packet(reply.begin() + 218, reply.end()), Packet(21, 0));
}

TEST(ArtnetFarEnd, ListsFourPortsOfOneSubNetPerPage) {
  ArtnetNode node({1, 2, 3, 4, 5, 0x10, 0x7f0f});
  Packet longer = art_poll();
  longer.resize(22, 0);  // as newer controllers send it
  const auto replies = node.receive(at_s(0), kDesk, longer);
  ASSERT_EQ(replies.size(), 4u);
  const Packet page_of_five(replies[1].begin() + 190, replies[1].begin() + 194);
  EXPECT_EQ(replies[0][173], 4);
  EXPECT_EQ(replies[1][173], 1);
  EXPECT_EQ(page_of_five, (Packet{5, 0, 0, 0}));
  EXPECT_EQ(replies[2][19], 1);
  EXPECT_EQ(replies[3][18], 0x7f);
  EXPECT_EQ(replies[3][190], 0x0f);
  for (std::size_t page = 0; page < 4; ++page) EXPECT_EQ(replies[page][211], page + 1);
}

TEST(ArtnetFarEnd, DropsTheTwentyOutOfOrderNumbersAndAcceptsAnyAtZero) {
  for (const int last : {0, 1, 19, 128, 255}) {
    for (int next = 0; next < 256; ++next) {
      ArtnetNode node({kPort});
      node.receive(at_s(0), kDesk, levels_of(1, static_cast<std::uint8_t>(last)));
      node.receive(at_s(0.01), kDesk, levels_of(2, static_cast<std::uint8_t>(next)));
      bool stale = false;
      for (int back = 0; back < 20; ++back) stale = stale || (last - back + 256) % 256 == next;
      stale = stale && last != 0 && next != 0;
      EXPECT_EQ(first_slot_of_port(node, at_s(0.01)), stale ? 1 : 2) << last << " then " << next;
    }
  }
}

TEST(ArtnetFarEnd, MergesTwoSourcesReportsItAndIgnoresAThird) {
  ArtnetNode node({kPort});
  node.receive(at_s(0), kDesk, levels_of(40));
  node.receive(at_s(0), kOther, levels_of(90));
  node.receive(at_s(0), kThird, levels_of(200));
  EXPECT_EQ(first_slot_of_port(node, at_s(0)), 90);
  EXPECT_EQ(node.receive(at_s(0), kThird, art_poll())[0][182], 0x88);
  node.receive(at_s(1), kOther, levels_of(10));
  EXPECT_EQ(first_slot_of_port(node, at_s(1)), 40);
}

TEST(ArtnetFarEnd, ForgetsASourceAfterTenSecondsAndHoldsTheLookOfTheLast) {
  ArtnetNode node({kPort});
  node.receive(at_s(0), kOther, levels_of(90));
  node.receive(at_s(5), kDesk, levels_of(40));
  EXPECT_EQ(first_slot_of_port(node, at_s(10)), 90);
  EXPECT_EQ(first_slot_of_port(node, at_s(10) + 1us), 40);
  EXPECT_EQ(node.receive(at_s(11), kDesk, art_poll())[0][182], 0x80);
  EXPECT_EQ(first_slot_of_port(node, at_s(1000)), 40);
  node.receive(at_s(1001), kThird, levels_of(7));  // there is room again
  EXPECT_EQ(first_slot_of_port(node, at_s(1001)), 7);
}

TEST(ArtnetFarEnd, WaitsForArtSyncOnceHeardUntilFourSecondsAfterTheLast) {
  ArtnetNode node({kPort});
  node.receive(at_s(0), kDesk, levels_of(10));
  EXPECT_EQ(first_slot_of_port(node, at_s(0)), 10);
  node.receive(at_s(0.1), kDesk, art_sync());
  node.receive(at_s(0.2), kDesk, levels_of(20));
  EXPECT_EQ(first_slot_of_port(node, at_s(0.2)), 10);
  node.receive(at_s(0.3), kDesk, art_sync());
  EXPECT_EQ(first_slot_of_port(node, at_s(0.3)), 20);
  node.receive(at_s(0.4), kDesk, levels_of(30));
  EXPECT_EQ(first_slot_of_port(node, at_s(4.3)), 20);
  EXPECT_EQ(first_slot_of_port(node, at_s(4.3) + 1us), 30);
  node.receive(at_s(4.5), kDesk, levels_of(40));
  EXPECT_EQ(first_slot_of_port(node, at_s(4.5)), 40);
}

TEST(ArtnetFarEnd, IgnoresArtSyncFromOthersThanItsSource) {
  ArtnetNode node({kPort});
  node.receive(at_s(0), kDesk, levels_of(10));
  node.receive(at_s(0.1), kOther, art_sync());
  node.receive(at_s(0.2), kDesk, levels_of(20));
  EXPECT_EQ(first_slot_of_port(node, at_s(0.2)), 20);  // still immediate
}

TEST(ArtnetFarEnd, DoesNotSynchroniseWhileItMerges) {
  ArtnetNode node({kPort});
  node.receive(at_s(0), kDesk, levels_of(10));
  node.receive(at_s(0), kDesk, art_sync());
  node.receive(at_s(0.1), kDesk, levels_of(50));
  node.receive(at_s(0.2), kOther, levels_of(20));
  EXPECT_EQ(first_slot_of_port(node, at_s(0.2)), 50);
  node.receive(at_s(0.3), kDesk, levels_of(60));
  EXPECT_EQ(first_slot_of_port(node, at_s(0.3)), 60);
}

}  // namespace
}  // namespace luxrig::sim
