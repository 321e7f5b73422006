#include "drivers/dmx/sacn/sacn_source.h"

#include <gtest/gtest.h>

#include "tests/drivers/test_rig.h"

namespace luxrig::sacn {
namespace {

DataPacket decoded(const std::optional<std::vector<std::uint8_t>>& bytes) {
  EXPECT_TRUE(bytes);
  const auto packet = decode(bytes.value());
  EXPECT_TRUE(packet);
  return packet.value();
}

TEST(SacnSource, SendsEveryCycleWhenContinuous) {
  Source source({});
  const DmxSlots slots{};
  int packets = 0;
  for (int cycle = 0; cycle < 440; ++cycle) packets += source.due(at_ms(cycle * 1000.0 / 44), 1, slots) ? 1 : 0;
  EXPECT_EQ(packets, 440);
}

TEST(SacnSource, KeepsToTheDmxRateHoweverOftenItIsCalled) {
  Source source({});
  DmxSlots slots{};
  int packets = 0;
  for (int ms = 0; ms < 10000; ++ms) {
    slots[0] = static_cast<std::uint8_t>(ms);
    packets += source.due(at_ms(ms), 1, slots) ? 1 : 0;
  }
  EXPECT_LE(packets, 442);  // 44.1 Hz
  EXPECT_GE(packets, 438);
}

TEST(SacnSource, KeepsItsRateForACallerThatIsSometimesEarly) {
  Source source({});
  const DmxSlots slots{};
  int packets = 0;
  for (int cycle = 0; cycle < 440; ++cycle) {
    const double jitter_ms = (cycle * 37 % 11 - 5) * 0.5;  // ±2.5 ms
    packets += source.due(at_ms(100 + cycle * 1000.0 / 44 + jitter_ms), 1, slots) ? 1 : 0;
  }
  EXPECT_EQ(packets, 440);
}

TEST(SacnSource, SuppressesUnchangedDataAfterThreeRepeatsAndKeepsAlive) {
  SourceSettings settings;
  settings.continuous = false;
  Source source(settings);
  DmxSlots slots{};
  slots[4] = 9;
  std::vector<double> sent_ms;
  for (int cycle = 0; cycle < 44 * 4; ++cycle) {
    const double ms = cycle * 1000.0 / 44;
    if (source.due(at_ms(ms), 1, slots)) sent_ms.push_back(ms);
  }
  ASSERT_GE(sent_ms.size(), 7u);
  EXPECT_LT(sent_ms[3], 100);  // the change and three identical packets
  for (std::size_t i = 4; i < sent_ms.size(); ++i) {
    EXPECT_GE(sent_ms[i] - sent_ms[i - 1], 800);
    EXPECT_LE(sent_ms[i] - sent_ms[i - 1], 1000);
  }
  slots[4] = 10;  // a change goes out at once
  EXPECT_TRUE(source.due(at_ms(4001), 1, slots));
}

TEST(SacnSource, CountsSequencesPerUniverseAndWrapsAround) {
  Source source({});
  const DmxSlots slots{};
  int last = -1;
  for (int cycle = 0; cycle < 300; ++cycle) {
    const Time now = at_ms(cycle * 23.0);
    const int sequence = decoded(source.due(now, 1, slots)).sequence;
    if (cycle >= 2) {
      EXPECT_EQ(sequence, (last + 1) % 256);
    }
    last = sequence;
    if (cycle == 100) {
      EXPECT_EQ(decoded(source.due(now, 2, slots)).sequence, 0);
    }
  }
}

TEST(SacnSource, IsHeardByItsSecondPacketAfterARestart) {
  // The receiver's rule of clause 6.7.2, with the sequence it remembers from before the restart.
  for (int remembered = 0; remembered < 256; ++remembered) {
    Source source({});
    const DmxSlots slots{};
    int last = remembered;
    int heard = 0;
    for (int cycle = 0; cycle < 2; ++cycle) {
      const int sequence = decoded(source.due(at_ms(cycle * 23.0), 1, slots)).sequence;
      const int ahead = static_cast<std::int8_t>(sequence - last);
      if (ahead <= 0 && ahead > -20) continue;
      last = sequence;
      ++heard;
    }
    EXPECT_GE(heard, 1) << remembered;
  }
}

TEST(SacnSource, SendsGoodbyesWithTheTerminatedBitAndKeepsCounting) {
  Source source({});
  DmxSlots slots{};
  slots[0] = 77;
  EXPECT_FALSE(source.goodbye(1));  // never sent
  (void)source.due(at_ms(0), 1, slots);
  const int before = decoded(source.due(at_ms(23), 1, slots)).sequence;
  const DataPacket goodbye = decoded(source.goodbye(1));
  EXPECT_TRUE(goodbye.terminated);
  EXPECT_EQ(goodbye.sequence, before + 1);
  EXPECT_EQ(goodbye.slots[0], 77);
  source.rest();
  EXPECT_FALSE(source.goodbye(1));
  const DataPacket again = decoded(source.due(at_ms(500), 1, slots));
  EXPECT_FALSE(again.terminated);
  EXPECT_EQ(again.sequence, before + 2);
}

TEST(SacnSource, DerivesItsCidFromHostRigAndBus) {
  const Cid cid = derive_cid("host", "gallery", "dmx");
  EXPECT_EQ(cid, derive_cid("host", "gallery", "dmx"));
  EXPECT_NE(cid, derive_cid("other", "gallery", "dmx"));
  EXPECT_NE(cid, derive_cid("host", "studio", "dmx"));
  EXPECT_NE(cid, derive_cid("host", "gallery", "dmx2"));
  EXPECT_NE(derive_cid("ab", "c", "d"), derive_cid("a", "bc", "d"));
  EXPECT_EQ(cid[6] >> 4, 8);  // UUID version
  EXPECT_EQ(cid[8] >> 6, 2);  // UUID variant
}

TEST(SacnSource, ReadsACidAsUuidgenPrintsIt) {
  const auto cid = parse_cid("6ba7b810-9dad-11d1-80B4-00c04fd430c8");
  ASSERT_TRUE(cid);
  EXPECT_EQ((*cid)[0], 0x6b);
  EXPECT_EQ((*cid)[8], 0x80);
  EXPECT_EQ((*cid)[15], 0xc8);
  for (const char* bad : {"", "6ba7b810", "6ba7b810-9dad-11d1-80b4-00c04fd430cg",
                          "6ba7b810x9dad-11d1-80b4-00c04fd430c8", "6ba7b810-9dad-11d1-80b4-00c04fd430c88"}) {
    EXPECT_FALSE(parse_cid(bad)) << bad;
  }
}

// This acknowledges a blackout.
TEST(SacnSource, LevelsCountAsSentOnlyAfterTheirPacket) {
  for (const bool continuous : {false, true}) {
    for (const bool with_priorities : {false, true}) {
      SourceSettings settings;
      settings.continuous = continuous;
      Source source(settings);
      if (with_priorities) source.set_slot_priorities(1, DmxSlots{});
      DmxSlots lit{};
      lit[4] = 200;
      const DmxSlots dark{};
      EXPECT_FALSE(source.is_sent(1, lit)) << "nothing was";
      double ms = 0;
      if (with_priorities) {
        ASSERT_TRUE(source.due(at_ms(ms), 1, lit));
        EXPECT_FALSE(source.is_sent(1, lit)) << "the packet was of priorities";
        ms += 25;
      }
      ASSERT_TRUE(source.due(at_ms(ms), 1, lit));
      EXPECT_TRUE(source.is_sent(1, lit));
      EXPECT_FALSE(source.is_sent(1, dark));
      EXPECT_FALSE(source.is_sent(2, lit)) << "of another universe";
      ASSERT_FALSE(source.due(at_ms(ms + 5), 1, dark)) << "the rate of a DMX line";
      EXPECT_FALSE(source.is_sent(1, dark));
      ASSERT_TRUE(source.due(at_ms(ms + 25), 1, dark));
      EXPECT_TRUE(source.is_sent(1, dark));
      EXPECT_FALSE(source.is_sent(1, lit));
      source.rest();
      EXPECT_FALSE(source.is_sent(1, dark)) << "each universe starts afresh";
    }
  }
}

TEST(SacnSource, LevelsWaitForDuePriorities) {
  Source source({});
  source.set_slot_priorities(1, DmxSlots{});
  DmxSlots lit{};
  lit[4] = 200;
  double ms = 0;
  for (; ms < 875; ms += 25) (void)source.due(at_ms(ms), 1, lit);
  ASSERT_TRUE(source.is_sent(1, lit));
  ms = 885;
  const auto packet = source.due(at_ms(ms), 1, DmxSlots{});
  ASSERT_TRUE(packet);
  ASSERT_EQ(decode(*packet)->start_code, kSlotPriority);
  EXPECT_FALSE(source.is_sent(1, DmxSlots{}));
  ASSERT_TRUE(source.due(at_ms(ms + 25), 1, DmxSlots{}));
  EXPECT_TRUE(source.is_sent(1, DmxSlots{}));
}

}  // namespace
}  // namespace luxrig::sacn
