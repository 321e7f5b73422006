/// Synchronisation, universe discovery and per-address priority of a source: ANSI E1.31-2018, clauses 6.3, 6.4, 8, 11.
#include <gtest/gtest.h>

#include "drivers/dmx/sacn/sacn_source.h"
#include "tests/drivers/hex.h"
#include "tests/drivers/test_rig.h"

namespace luxrig::sacn {
namespace {

using Bytes = std::vector<std::uint8_t>;

const Cid kSomebody = {0x01, 0x23, 0x45, 0x67, 0x89, 0xAB, 0x4D, 0xEF, 0x81, 0x23, 0x45, 0x67, 0x89, 0xAB, 0xCD, 0xEF};

SourceSettings settings_of(int sync_universe) {
  SourceSettings settings;
  settings.cid = kSomebody;
  settings.source_name = "desk";
  settings.sync_universe = sync_universe;
  return settings;
}

TEST(SacnExtendedCodec, WritesSynchronisationAsTheStandardPrintsIt) {
  // Root layer of table 4-2, framing layer of table 6-2: sequence 5, universe 9000.
  EXPECT_EQ(encode(SyncPacket{kSomebody, 5, 9000}),
            from_hex("0010 0000 4153432d45312e3137000000 7021 00000008 0123456789ab4def8123456789abcdef"
                     "700b 00000001 05 2328 0000"));
}

TEST(SacnExtendedCodec, WritesUniverseDiscoveryAsTheStandardPrintsIt) {
  const Bytes bytes = encode(DiscoveryPacket{kSomebody, "desk", 0, 1, {1, 300, 63999}});
  ASSERT_EQ(bytes.size(), 126u);  // 120 + two each
  EXPECT_EQ(Bytes(bytes.begin() + 16, bytes.begin() + 22), from_hex("706e 00000008"));
  EXPECT_EQ(Bytes(bytes.begin() + 38, bytes.begin() + 44), from_hex("7058 00000002"));
  EXPECT_EQ(Bytes(bytes.begin() + 44, bytes.begin() + 50), from_hex("6465736b 0000"));
  // four reserved bytes, list length, vector, page, last page, universes
  EXPECT_EQ(Bytes(bytes.begin() + 108, bytes.end()), from_hex("00000000 700e 00000001 00 01 0001 012c f9ff"));
}

TEST(SacnExtendedCodec, RoundTripsAndRefusesTruncationsAndChangedFixedFields) {
  const Bytes sync = encode(SyncPacket{kSomebody, 255, 63999});
  const auto back = decode_sync(sync);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->cid, kSomebody);
  EXPECT_EQ(back->sequence, 255);
  EXPECT_EQ(back->sync_universe, 63999);
  const Bytes list = encode(DiscoveryPacket{kSomebody, "desk", 1, 2, {7, 8}});
  const auto listed = decode_discovery(list);
  ASSERT_TRUE(listed);
  EXPECT_EQ(listed->universes, (std::vector<std::uint16_t>{7, 8}));
  EXPECT_EQ(listed->page, 1);
  EXPECT_EQ(listed->last_page, 2);
  for (std::size_t size = 0; size < sync.size(); ++size) EXPECT_FALSE(decode_sync({sync.data(), size}));
  for (std::size_t size = 0; size < list.size(); ++size) EXPECT_FALSE(decode_discovery({list.data(), size}));
  for (std::size_t at = 0; at < 44; ++at) {
    if (at >= 22 && at < 38) continue;  // the CID may be anything
    Bytes bad_sync = sync, bad_list = list;
    bad_sync[at] ^= 0x81;
    bad_list[at] ^= 0x81;
    EXPECT_FALSE(decode_sync(bad_sync)) << at;
    EXPECT_FALSE(decode_discovery(bad_list)) << at;
  }
  Bytes unsorted = list;
  std::swap(unsorted[121], unsorted[123]);
  EXPECT_FALSE(decode_discovery(unsorted));
  EXPECT_FALSE(decode(sync));
  EXPECT_FALSE(decode_sync(list));
}

TEST(SacnExtendedSource, SynchronisesOncePerFrameAfterAllUniverses) {
  Source source(settings_of(7000));
  const DmxSlots slots{};
  int last = -1;
  for (int cycle = 0; cycle < 300; ++cycle) {
    for (const int universe : {1, 2}) {
      const auto bytes = source.due(at_ms(cycle * 23.0), universe, slots);
      ASSERT_TRUE(bytes);
      const auto packet = decode(*bytes);
      ASSERT_TRUE(packet);
      EXPECT_EQ(packet->sync_universe, 7000);
      EXPECT_TRUE(packet->force_sync);  // receivers go on when synchronisation is lost
    }
    const auto bytes = source.sync_due();
    ASSERT_TRUE(bytes);
    const auto sync = decode_sync(*bytes);
    ASSERT_TRUE(sync);
    EXPECT_EQ(sync->sync_universe, 7000);
    if (cycle > 1) {
      EXPECT_EQ(sync->sequence, (last + 1) % 256);
    }
    last = sync->sequence;
    EXPECT_FALSE(source.sync_due());
  }
}

TEST(SacnExtendedSource, DoesNotSynchroniseAFrameWithoutData) {
  SourceSettings settings = settings_of(9);
  settings.continuous = false;
  Source source(settings);
  const DmxSlots slots{};
  int data = 0, syncs = 0;
  for (int cycle = 0; cycle < 44 * 5; ++cycle) {
    data += source.due(at_ms(cycle * 1000.0 / 44), 1, slots) ? 1 : 0;
    syncs += source.sync_due() ? 1 : 0;
  }
  EXPECT_EQ(data, syncs);
  EXPECT_LT(syncs, 12);
}

TEST(SacnExtendedSource, ListsItsUniversesEveryTenSecondsInPagesOf512) {
  Source source(settings_of(0));
  const DmxSlots slots{};
  std::vector<double> listed_s;
  std::size_t pages = 0;
  std::vector<std::uint16_t> all;
  for (int s = 0; s <= 31; ++s) {
    for (int universe = 1; universe <= 600; ++universe) (void)source.due(at_ms(s * 1000.0), universe, slots);
    const auto due = source.discovery_due(at_ms(s * 1000.0));
    if (due.empty()) continue;
    listed_s.push_back(s);
    pages = due.size();
    all.clear();
    for (std::size_t page = 0; page < due.size(); ++page) {
      const auto list = decode_discovery(due[page]);
      ASSERT_TRUE(list);
      EXPECT_EQ(list->page, page);
      EXPECT_EQ(list->last_page, 1);
      all.insert(all.end(), list->universes.begin(), list->universes.end());
    }
  }
  EXPECT_EQ(listed_s, (std::vector<double>{10, 20, 30}));
  EXPECT_EQ(pages, 2u);
  ASSERT_EQ(all.size(), 600u);
  EXPECT_EQ(all.front(), 1);
  EXPECT_EQ(all.back(), 600);
  source.rest();
  EXPECT_TRUE(source.discovery_due(at_ms(60000)).empty());
  EXPECT_TRUE(source.discovery_due(at_ms(90000)).empty());  // nothing is sent
}

TEST(SacnExtendedSource, SendsSlotPrioritiesBeforeLevelsWithinTheRate) {
  Source source(settings_of(0));
  DmxSlots priorities{}, slots{};
  priorities[4] = 120;
  source.set_slot_priorities(1, priorities);
  std::vector<int> start_codes;
  std::vector<double> at;
  int sequence = 0;
  for (int ms = 0; ms < 4000; ++ms) {
    slots[0] = static_cast<std::uint8_t>(ms);
    const auto bytes = source.due(at_ms(ms), 1, slots);
    if (!bytes) continue;
    const auto packet = decode(*bytes);
    ASSERT_TRUE(packet);
    if (packet->start_code == kSlotPriority) {
      EXPECT_EQ(packet->slots[4], 120);
      EXPECT_EQ(packet->slots[5], 0);
      at.push_back(ms);
    }
    if (start_codes.size() > 1) {
      EXPECT_EQ(packet->sequence, (sequence + 1) % 256);  // one count for all start codes
    }
    sequence = packet->sequence;
    start_codes.push_back(packet->start_code);
  }
  EXPECT_EQ(start_codes.front(), kSlotPriority);
  EXPECT_LE(start_codes.size(), 178u);  // 44.1 Hz, all packets together
  ASSERT_GE(at.size(), 4u);
  for (std::size_t i = 1; i < at.size(); ++i) EXPECT_LE(at[i] - at[i - 1], 1000);
}

TEST(SacnExtendedSource, PausesASingleUniverseWhileOthersContinue) {
  Source source(settings_of(0));
  const DmxSlots slots{};
  for (const int universe : {1, 2}) (void)source.due(at_ms(0), universe, slots);
  EXPECT_TRUE(source.goodbye(1));
  source.rest(1);
  EXPECT_FALSE(source.goodbye(1));
  EXPECT_TRUE(source.goodbye(2));
}

}  // namespace
}  // namespace luxrig::sacn
