#include "sim/wire/sacn/sacn_receiver.h"

#include <gtest/gtest.h>

#include "tests/sim/tiny_rig.h"

namespace luxrig::sim {
namespace {

using namespace std::chrono_literals;
using Packet = std::vector<std::uint8_t>;
using Verdict = SacnReceiver::Verdict;

// A whole data packet, byte by byte from ANSI E1.31-2018, tables 4-1 to 4-3. 129 bytes.
Packet three_slots() {
  return {
      0x00, 0x10,                                                  // 0 preamble size
      0x00, 0x00,                                                  // 2 postamble size
      'A',  'S',  'C',  '-',  'E', '1', '.', '1', '7', 0,  0,  0,  // 4 ACN packet identifier
      0x70, 0x71,                                                  // 16 root: flags 7, length 129 - 16 = 113
      0x00, 0x00, 0x00, 0x04,                                      // 18 root vector: data
      0xc1, 0xd2, 3,    4,    5,   6,   7,   8,   9,   10, 11, 12, 13, 14, 15,  // 22 CID
      16,                                                                       //
      0x70, 0x5b,              // 38 framing: flags 7, length 129 - 38 = 91
      0x00, 0x00, 0x00, 0x02,  // 40 framing vector: data packet
      'd',  'e',  's',  'k',  0,   0,   0,   0,   0,   0,  0,  0,  0,  0,  0,  0,  // 44 source name, 64 bytes
      0,    0,    0,    0,    0,   0,   0,   0,   0,   0,  0,  0,  0,  0,  0,  0,  //
      0,    0,    0,    0,    0,   0,   0,   0,   0,   0,  0,  0,  0,  0,  0,  0,  //
      0,    0,    0,    0,    0,   0,   0,   0,   0,   0,  0,  0,  0,  0,  0,  0,  //
      0x64,                                                                        // 108 priority 100
      0x00, 0x00,                                                                  // 109 synchronisation universe: none
      0x07,                                                                        // 111 sequence
      0x00,                                                                        // 112 options
      0x00, 0x03,                                                                  // 113 universe
      0x70, 0x0e,       // 115 DMP: flags 7, length 129 - 115 = 14
      0x02,             // 117 set property
      0xa1,             // 118 address and data type
      0x00, 0x00,       // 119 first address
      0x00, 0x01,       // 121 increment
      0x00, 0x04,       // 123 count: start code and three slots
      0x00,             // 125 start code
      0x01, 0x02, 0x03  // 126 slots
  };
}

constexpr std::size_t kCid = 22, kPriority = 108, kSync = 109, kSequence = 111, kOptions = 112, kSlots = 126;
constexpr std::uint8_t kPreview = 0x80, kTerminated = 0x40, kForceSync = 0x20;

// A synchronisation packet, table 4-2 of E1.31 with root vector 8: universe 9000, sequence 5. 49 bytes.
Packet sync_9000() {
  return {
      0x00, 0x10,                                                               // 0 preamble size
      0x00, 0x00,                                                               // 2 postamble size
      'A',  'S',  'C',  '-',  'E', '1', '.', '1', '7', 0,  0,  0,               // 4 ACN packet identifier
      0x70, 0x21,                                                               // 16 root: flags 7, length 49 - 16 = 33
      0x00, 0x00, 0x00, 0x08,                                                   // 18 root vector: extended
      0xc1, 0xd2, 3,    4,    5,   6,   7,   8,   9,   10, 11, 12, 13, 14, 15,  // 22 CID
      16,                                                                       //
      0x70, 0x0b,              // 38 framing: flags 7, length 49 - 38 = 11
      0x00, 0x00, 0x00, 0x01,  // 40 framing vector: synchronisation
      0x05,                    // 44 sequence
      0x23, 0x28,              // 45 synchronisation universe 9000
      0x00, 0x00               // 47 reserved
  };
}

struct Sent {
  std::uint8_t source = 1, priority = 100, sequence = 0, options = 0, level = 0;
  int sync_universe = 0;
};

// From one of several sources; `level` is the first of its three slots.
Packet packet_of(const Sent& sent) {
  Packet packet = three_slots();
  packet[kCid] = sent.source;
  packet[kPriority] = sent.priority;
  packet[kSync] = static_cast<std::uint8_t>(sent.sync_universe >> 8);
  packet[kSync + 1] = static_cast<std::uint8_t>(sent.sync_universe & 0xff);
  packet[kSequence] = sent.sequence;
  packet[kOptions] = sent.options;
  packet[kSlots] = sent.level;
  return packet;
}

int first_slot_of_universe(SacnReceiver& receiver, Time now) {
  const auto levels = receiver.levels(3, now);
  return levels ? (*levels)[0] : -1;
}

TEST(SacnFarEnd, ReadsEveryFieldOfADataPacket) {
  Packet packet = three_slots();
  packet[kOptions] = 0xe0;
  const auto data = decode_sacn_data(packet);
  ASSERT_TRUE(data);
  EXPECT_EQ(data->cid, (std::array<std::uint8_t, 16>{0xc1, 0xd2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16}));
  EXPECT_EQ(data->source_name, "desk");
  EXPECT_EQ(data->priority, 100);
  EXPECT_EQ(data->sync_universe, 0);
  EXPECT_EQ(data->sequence, 7);
  EXPECT_TRUE(data->preview && data->terminated && data->force_sync);
  EXPECT_EQ(data->universe, 3);
  EXPECT_EQ(data->start_code, 0);
  EXPECT_EQ(Packet(data->slots.begin(), data->slots.end()), (Packet{1, 2, 3}));
}

TEST(SacnFarEnd, ReadsAWholeUniverse) {
  Packet packet = three_slots();
  packet.resize(638, 0xaa);
  packet[16] = 0x72, packet[17] = 0x6e;    // 638 - 16
  packet[38] = 0x72, packet[39] = 0x58;    // 638 - 38
  packet[115] = 0x72, packet[116] = 0x0b;  // 638 - 115
  packet[123] = 0x02, packet[124] = 0x01;  // 513
  const auto data = decode_sacn_data(packet);
  ASSERT_TRUE(data);
  ASSERT_EQ(data->slots.size(), 512u);
  EXPECT_EQ(data->slots[511], 0xaa);
}

TEST(SacnFarEnd, AcceptsASourceNameThatFillsItsField) {
  Packet packet = three_slots();
  std::fill_n(packet.begin() + 44, 64, std::uint8_t{'x'});
  const auto data = decode_sacn_data(packet);
  ASSERT_TRUE(data);
  EXPECT_EQ(data->source_name, std::string(64, 'x'));
}

TEST(SacnFarEnd, RefusesEveryTruncationAndExtension) {
  for (Packet whole : {three_slots(), sync_9000()}) {
    for (std::size_t length = 0; length < whole.size(); ++length) {
      const Packet cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
      EXPECT_FALSE(decode_sacn_data(cut)) << length;
      EXPECT_FALSE(decode_sacn_sync(cut)) << length;
    }
    whole.push_back(0);
    EXPECT_FALSE(decode_sacn_data(whole));
    EXPECT_FALSE(decode_sacn_sync(whole));
  }
}

TEST(SacnFarEnd, RefusesEveryChangeOfAFixedByte) {
  const auto unread = [](std::size_t at, bool data) {  // bytes that may differ from packet to packet
    if (at >= 22 && at < 38) return true;
    return data ? (at >= 44 && at < 115) || at >= 125 : at >= 44;
  };
  for (const bool is_data : {true, false}) {
    const Packet good = is_data ? three_slots() : sync_9000();
    for (std::size_t at = 0; at < good.size(); ++at) {
      if (unread(at, is_data)) continue;
      for (int change = 1; change < 256; ++change) {
        Packet packet = good;
        packet[at] ^= static_cast<std::uint8_t>(change);
        EXPECT_FALSE(decode_sacn_data(packet)) << at << " ^ " << change;
        EXPECT_FALSE(decode_sacn_sync(packet)) << at << " ^ " << change;
      }
    }
  }
}

TEST(SacnFarEnd, RefusesPrioritiesAbove200AndInvalidUniverses) {
  Packet packet = three_slots();
  packet[kPriority] = 200;
  EXPECT_TRUE(decode_sacn_data(packet));
  packet[kPriority] = 201;
  EXPECT_FALSE(decode_sacn_data(packet));
  for (const auto& [universe, exists] : {std::pair{0, false}, {1, true}, {63999, true}, {64000, false}}) {
    packet = three_slots();
    packet[113] = static_cast<std::uint8_t>(universe >> 8);
    packet[114] = static_cast<std::uint8_t>(universe & 0xff);
    EXPECT_EQ(decode_sacn_data(packet).has_value(), exists) << universe;
  }
}

TEST(SacnFarEnd, ReadsASynchronisationPacket) {
  const auto sync = decode_sacn_sync(sync_9000());
  ASSERT_TRUE(sync);
  EXPECT_EQ(sync->sync_universe, 9000);
  EXPECT_EQ(sync->sequence, 5);
  EXPECT_EQ(sync->cid[1], 0xd2);
}

TEST(SacnFarEnd, ShowsNothingBeforeItsFirstData) {
  SacnReceiver receiver;
  EXPECT_FALSE(receiver.levels(3, at_s(0)));
  EXPECT_EQ(receiver.receive(at_s(0), three_slots()), Verdict::accepted);
  EXPECT_FALSE(receiver.levels(4, at_s(0)));
  const auto levels = receiver.levels(3, at_s(0));
  ASSERT_TRUE(levels);
  EXPECT_EQ((*levels)[2], 3);
  EXPECT_EQ((*levels)[3], 0);
}

TEST(SacnFarEnd, DropsExactlyTheTwentyOutOfOrderNumbers) {
  for (const int last : {0, 5, 19, 128, 250, 255}) {
    for (int next = 0; next < 256; ++next) {
      SacnReceiver receiver;
      ASSERT_EQ(receiver.receive(at_s(0), packet_of({.sequence = static_cast<std::uint8_t>(last)})), Verdict::accepted);
      // The last number and the nineteen before it, modulo 256.
      bool stale = false;
      for (int back = 0; back < 20; ++back) stale = stale || (last - back + 256) % 256 == next;
      const Verdict verdict =
          receiver.receive(at_s(0.01), packet_of({.sequence = static_cast<std::uint8_t>(next), .level = 99}));
      EXPECT_EQ(verdict, stale ? Verdict::out_of_order : Verdict::accepted) << last << " then " << next;
      EXPECT_EQ(first_slot_of_universe(receiver, at_s(0.01)), stale ? 0 : 99) << last << " then " << next;
    }
  }
}

TEST(SacnFarEnd, TracksSequenceNumbersPerSource) {
  SacnReceiver receiver;
  EXPECT_EQ(receiver.receive(at_s(0), packet_of({.source = 1, .sequence = 50})), Verdict::accepted);
  EXPECT_EQ(receiver.receive(at_s(0), packet_of({.source = 2, .sequence = 45})), Verdict::accepted);
}

TEST(SacnFarEnd, PreviewDataNeverReachesTheOutputs) {
  SacnReceiver receiver;
  EXPECT_EQ(receiver.receive(at_s(0), packet_of({.options = kPreview, .level = 255})), Verdict::preview);
  EXPECT_FALSE(receiver.levels(3, at_s(0)));
  EXPECT_EQ(receiver.sources(3, at_s(0)), 0u);
}

TEST(SacnFarEnd, ATerminatedSourceIsGoneAtOnceWithItsLevels) {
  SacnReceiver receiver;
  receiver.receive(at_s(0), packet_of({.source = 1, .sequence = 9, .level = 200}));
  EXPECT_EQ(receiver.receive(at_s(0.1), packet_of({.source = 1, .sequence = 10, .options = kTerminated, .level = 11})),
            Verdict::terminated);
  EXPECT_EQ(receiver.sources(3, at_s(0.1)), 0u);
  EXPECT_EQ(first_slot_of_universe(receiver, at_s(0.1)), 200);  // the last look is held
  // It counts as new when it returns: an old number is no longer stale.
  EXPECT_EQ(receiver.receive(at_s(0.2), packet_of({.source = 1, .sequence = 9, .level = 30})), Verdict::accepted);
  EXPECT_EQ(first_slot_of_universe(receiver, at_s(0.2)), 30);
}

TEST(SacnFarEnd, OnlyTheHighestPresentPriorityCounts) {
  SacnReceiver receiver;
  receiver.receive(at_s(0), packet_of({.source = 1, .priority = 100, .level = 200}));
  receiver.receive(at_s(0), packet_of({.source = 2, .priority = 150, .level = 20}));
  EXPECT_EQ(first_slot_of_universe(receiver, at_s(0)), 20);
  receiver.receive(at_s(0.1), packet_of({.source = 2, .priority = 150, .sequence = 1, .options = kTerminated}));
  EXPECT_EQ(first_slot_of_universe(receiver, at_s(0.1)), 200);
}

TEST(SacnFarEnd, MergesEqualPrioritiesByTheHighestSlotValue) {
  SacnReceiver receiver;
  Packet one = packet_of({.source = 1, .level = 200}), other = packet_of({.source = 2, .level = 20});
  other[kSlots + 1] = 77;
  receiver.receive(at_s(0), one);
  receiver.receive(at_s(0), other);
  const auto levels = receiver.levels(3, at_s(0));
  ASSERT_TRUE(levels);
  EXPECT_EQ((*levels)[0], 200);
  EXPECT_EQ((*levels)[1], 77);
  EXPECT_EQ((*levels)[2], 3);
}

TEST(SacnFarEnd, ASourceIsLostAfterTwoAndAHalfSecondsHoldingItsLook) {
  SacnReceiver receiver;
  receiver.receive(at_s(1), packet_of({.sequence = 9, .level = 200}));
  EXPECT_EQ(receiver.sources(3, at_s(1) + 2500ms), 1u);
  EXPECT_EQ(receiver.sources(3, at_s(1) + 2500ms + 1us), 0u);
  EXPECT_EQ(first_slot_of_universe(receiver, at_s(1000)), 200);
  EXPECT_EQ(receiver.receive(at_s(1001), packet_of({.sequence = 9, .level = 30})), Verdict::accepted);
  EXPECT_EQ(first_slot_of_universe(receiver, at_s(1001)), 30);
}

TEST(SacnFarEnd, AStalePacketDoesNotKeepASourceAlive) {
  SacnReceiver receiver;
  receiver.receive(at_s(0), packet_of({.sequence = 9}));
  EXPECT_EQ(receiver.receive(at_s(2), packet_of({.sequence = 9})), Verdict::out_of_order);
  EXPECT_EQ(receiver.sources(3, at_s(2.6)), 0u);
}

TEST(SacnFarEnd, SourcesLostTogetherDoNotHandOverToEachOther) {
  SacnReceiver receiver;
  receiver.receive(at_s(0), packet_of({.source = 1, .priority = 50, .level = 255}));
  receiver.receive(at_s(0), packet_of({.source = 2, .priority = 100, .level = 40}));
  for (double seconds = 0; seconds < 4; seconds += 0.01)
    EXPECT_EQ(first_slot_of_universe(receiver, at_s(seconds)), 40) << seconds;
}

TEST(SacnFarEnd, DataForAnotherStartCodeChangesNothing) {
  SacnReceiver receiver;
  Packet packet = three_slots();
  packet[125] = 0xdd;
  EXPECT_EQ(receiver.receive(at_s(0), packet), Verdict::ignored);
  EXPECT_FALSE(receiver.levels(3, at_s(0)));
}

TEST(SacnFarEnd, KeepsSlotsThatAPacketDoesNotCarry) {
  SacnReceiver receiver;
  receiver.receive(at_s(0), packet_of({.sequence = 0, .level = 9}));
  Packet shorter = packet_of({.sequence = 1, .level = 8});
  shorter.resize(127);
  shorter[17] = 0x6f, shorter[39] = 0x59, shorter[116] = 0x0c, shorter[124] = 0x02;  // lengths and count less two
  ASSERT_EQ(receiver.receive(at_s(0), shorter), Verdict::accepted);
  const auto levels = receiver.levels(3, at_s(0));
  EXPECT_EQ((*levels)[0], 8);
  EXPECT_EQ((*levels)[1], 2);
}

TEST(SacnFarEnd, SynchronisedDataWaitsOnlyOnceASynchronisationWasHeard) {
  SacnReceiver receiver;
  receiver.receive(at_s(0), packet_of({.sequence = 0, .level = 10, .sync_universe = 9000}));
  EXPECT_EQ(first_slot_of_universe(receiver, at_s(0)), 10);
  EXPECT_EQ(receiver.receive(at_s(0.1), sync_9000()), Verdict::accepted);
  receiver.receive(at_s(0.2), packet_of({.sequence = 1, .level = 20, .sync_universe = 9000}));
  EXPECT_EQ(first_slot_of_universe(receiver, at_s(0.2)), 10);
  receiver.receive(at_s(0.25), packet_of({.sequence = 2, .level = 30, .sync_universe = 9000}));
  EXPECT_EQ(first_slot_of_universe(receiver, at_s(0.25)), 10);
  receiver.receive(at_s(0.3), sync_9000());
  EXPECT_EQ(first_slot_of_universe(receiver, at_s(0.3)), 30);
}

TEST(SacnFarEnd, ASynchronisationForAnotherUniverseReleasesNothing) {
  SacnReceiver receiver;
  Packet other = sync_9000();
  other[46] = 0x29;  // 9001
  receiver.receive(at_s(0), sync_9000());
  receiver.receive(at_s(0.1), packet_of({.sequence = 1, .level = 20, .sync_universe = 9000}));
  receiver.receive(at_s(0.2), other);
  EXPECT_EQ(first_slot_of_universe(receiver, at_s(0.2)), -1);
  other[45] = 0, other[46] = 0;
  EXPECT_EQ(receiver.receive(at_s(0.2), other), Verdict::not_sacn);  // E1.31 6.3.3: universe 0 synchronises nothing
}

TEST(SacnFarEnd, ForceSyncDecidesToContinueOrFreezeWhenSynchronisationStops) {
  for (const bool go_on : {true, false}) {
    SacnReceiver receiver;
    const std::uint8_t options = go_on ? kForceSync : 0;
    receiver.receive(at_s(0), packet_of({.sequence = 0, .options = options, .level = 10, .sync_universe = 9000}));
    receiver.receive(at_s(0), sync_9000());
    receiver.receive(at_s(2.5), packet_of({.sequence = 1, .options = options, .level = 20, .sync_universe = 9000}));
    EXPECT_EQ(first_slot_of_universe(receiver, at_s(2.5)), 10);
    receiver.receive(at_s(2.6), packet_of({.sequence = 2, .options = options, .level = 30, .sync_universe = 9000}));
    EXPECT_EQ(first_slot_of_universe(receiver, at_s(2.6)), go_on ? 30 : 10);
  }
}

TEST(SacnFarEnd, AFloodOfForgedSourcesAndUniversesIsBounded) {
  SacnReceiver receiver;
  for (int source = 0; source < 256; ++source) {
    const Verdict verdict = receiver.receive(at_s(0), packet_of({.source = static_cast<std::uint8_t>(source)}));
    EXPECT_EQ(verdict, source < 16 ? Verdict::accepted : Verdict::ignored) << source;
  }
  int taken = 0;
  for (int universe = 100; universe < 1100; ++universe) {
    Packet packet = three_slots();
    packet[113] = static_cast<std::uint8_t>(universe >> 8);
    packet[114] = static_cast<std::uint8_t>(universe & 0xff);
    taken += receiver.receive(at_s(0), packet) == Verdict::accepted ? 1 : 0;
  }
  EXPECT_EQ(taken, 255);  // and universe 3
}

}  // namespace
}  // namespace luxrig::sim
