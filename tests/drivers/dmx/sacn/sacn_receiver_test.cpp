#include "drivers/dmx/sacn/sacn_receiver.h"

#include <gtest/gtest.h>

#include "tests/drivers/test_rig.h"

namespace luxrig::sacn {
namespace {

/// A desk that sends one universe, packet by packet.
struct HandDesk {
  explicit HandDesk(int id, int priority = 100) {
    packet.cid[15] = static_cast<std::uint8_t>(id);
    packet.source_name = "desk " + std::to_string(id);
    packet.priority = static_cast<std::uint8_t>(priority);
    packet.universe = 1;
    packet.slots.assign(512, 0);
  }
  Receiver::Verdict send(Receiver& to, double ms, int level) {
    packet.slots[0] = static_cast<std::uint8_t>(level);
    const auto verdict = to.receive(at_ms(ms), encode(packet));
    ++packet.sequence;
    return verdict;
  }
  DataPacket packet;
};

using Verdict = Receiver::Verdict;

ReceiverSettings hearing(std::vector<int> universes = {1}) {
  ReceiverSettings settings;
  settings.universes = std::move(universes);
  return settings;
}

int level(Receiver& receiver, double ms) { return receiver.heard(at_ms(ms), 1).levels.slots[0]; }
DeskPresence presence(Receiver& receiver, double ms) { return receiver.heard(at_ms(ms), 1).presence; }

TEST(SacnInput, IsUnknownWhileSamplingAndThenShowsTheHighestPriority) {
  Receiver receiver(hearing());
  HandDesk low(1, 100), high(2, 101);
  for (int ms = 0; ms < 1500; ms += 25) {
    EXPECT_EQ(presence(receiver, ms), DeskPresence::unknown) << ms;
    low.send(receiver, ms, 250);
    high.send(receiver, ms + 1, 10);
  }
  EXPECT_EQ(presence(receiver, 1502), DeskPresence::present);
  EXPECT_EQ(level(receiver, 1502), 10);
  EXPECT_EQ(receiver.heard(at_ms(1502), 1).source, "desk 2 and 1 more");
}

TEST(SacnInput, IsAbsentWithoutAnySource) {
  Receiver receiver(hearing());
  EXPECT_EQ(presence(receiver, 0), DeskPresence::unknown);
  EXPECT_EQ(presence(receiver, 2499), DeskPresence::unknown);  // a source that is not lost may be silent that long
  EXPECT_EQ(presence(receiver, 2500), DeskPresence::absent);
  EXPECT_EQ(receiver.heard(at_ms(2500), 77).presence, DeskPresence::unknown);  // not one of its universes
}

/// Sends every 25 ms from 0 to the end, beyond sampling.
void warm_up(Receiver& receiver, std::vector<std::pair<HandDesk*, int>> desks, double until_ms = 2000) {
  for (double ms = 0; ms <= until_ms; ms += 25) {
    for (auto& [desk, level] : desks) desk->send(receiver, ms, level);
  }
}

TEST(SacnInput, DropsOnlyPacketsUpToNineteenBehind) {  // 6.7.2
  Receiver receiver(hearing());
  HandDesk desk(1);
  warm_up(receiver, {{&desk, 5}});
  for (int behind = 0; behind < 256; ++behind) {
    Receiver copy = receiver;
    DataPacket packet = desk.packet;
    packet.sequence = static_cast<std::uint8_t>(desk.packet.sequence - 1 - behind);
    const auto ahead = static_cast<std::int8_t>(-behind);
    EXPECT_EQ(copy.receive(at_ms(2010), encode(packet)),
              ahead <= 0 && ahead > -20 ? Verdict::out_of_order : Verdict::taken)
        << behind;
  }
}

TEST(SacnInput, KeepsSourcesWhosePacketsAreReadLate) {
  Receiver receiver(hearing());
  HandDesk one(1, 100), two(2, 100);
  warm_up(receiver, {{&one, 77}, {&two, 10}});
  EXPECT_EQ(presence(receiver, 2000), DeskPresence::present);
  // Four seconds without a read; then the packets kept by the kernel are read one by one.
  two.send(receiver, 6000, 12);
  one.send(receiver, 6000, 78);
  EXPECT_EQ(presence(receiver, 6000), DeskPresence::present);
  EXPECT_EQ(level(receiver, 6000), 78);
  EXPECT_EQ(receiver.sources(at_ms(6000), 1), 2u);
  EXPECT_EQ(presence(receiver, 8501), DeskPresence::absent) << "one that is silent is lost all the same";
}

TEST(SacnInput, LosesASourceAfterTwoAndAHalfSecondsButKeepsItsLevels) {  // 6.7.1
  Receiver receiver(hearing());
  HandDesk desk(1);
  warm_up(receiver, {{&desk, 77}});
  EXPECT_EQ(presence(receiver, 4500), DeskPresence::present);
  EXPECT_EQ(presence(receiver, 4501), DeskPresence::absent);
  EXPECT_EQ(level(receiver, 4501), 77);
  desk.packet.sequence = static_cast<std::uint8_t>(desk.packet.sequence - 5);
  EXPECT_EQ(desk.send(receiver, 4600, 9), Verdict::taken);  // a new source: its sequence starts over
}

TEST(SacnInput, ReleasesATerminatedSourceAtOnceWithoutItsLevels) {  // 6.2.6
  Receiver receiver(hearing());
  HandDesk desk(1);
  warm_up(receiver, {{&desk, 77}});
  EXPECT_EQ(level(receiver, 2010), 77);
  desk.packet.terminated = true;
  EXPECT_EQ(desk.send(receiver, 2020, 200), Verdict::terminated);
  EXPECT_EQ(presence(receiver, 2021), DeskPresence::absent);
  EXPECT_EQ(level(receiver, 2021), 77);
  EXPECT_EQ(desk.send(receiver, 2040, 200), Verdict::terminated);  // the second of three creates no source
  EXPECT_EQ(receiver.sources(at_ms(2041), 1), 0u);
}

TEST(SacnInput, IgnoresPreviewDataTestCodesAndItsOwnPackets) {
  ReceiverSettings settings = hearing();
  HandDesk desk(1), own(9);
  settings.own = own.packet.cid;
  Receiver receiver(settings);
  EXPECT_EQ(presence(receiver, 0), DeskPresence::unknown);
  desk.packet.preview = true;
  EXPECT_EQ(desk.send(receiver, 0, 1), Verdict::preview);
  desk.packet.preview = false;
  desk.packet.start_code = 0x55;
  EXPECT_EQ(desk.send(receiver, 10, 1), Verdict::ignored);
  EXPECT_EQ(own.send(receiver, 20, 1), Verdict::ignored);
  EXPECT_EQ(receiver.receive(at_ms(30), std::vector<std::uint8_t>(638, 0)), Verdict::not_sacn);
  EXPECT_EQ(presence(receiver, 2500), DeskPresence::absent);
}

/// A new source counts only after 1.5 s (6.6). Between "sampled" and then, the state is never absent.
TEST(SacnInput, IsNeverAbsentWhileARareOrLateSourceIsPresent) {
  for (const int period_ms : {25, 900, 2400}) {
    for (int first_ms = 0; first_ms < period_ms; first_ms += 45) {
      Receiver receiver(hearing());
      HandDesk desk(1);
      int present_at_ms = -1;
      for (int ms = 0; ms <= 4500; ++ms) {
        if (ms >= first_ms && (ms - first_ms) % period_ms == 0) desk.send(receiver, ms, 9);
        const DeskPresence now = presence(receiver, ms);
        ASSERT_NE(now, DeskPresence::absent) << "every " << period_ms << " from " << first_ms << ": at " << ms;
        if (present_at_ms < 0 && now == DeskPresence::present) present_at_ms = ms;
      }
      EXPECT_LE(present_at_ms, std::max(1500, first_ms + 1500)) << period_ms << ", " << first_ms;
      EXPECT_GE(present_at_ms, 1500);
    }
  }
}

TEST(SacnInput, IsAbsentWithinFourSecondsDespiteBriefSources) {
  Receiver receiver(hearing());
  for (int ms = 0; ms < 4000; ms += 100) {  // sources that are gone before they count
    HandDesk passing(1 + ms / 1000);
    passing.send(receiver, ms, 9);
    if (ms % 1000 == 900) {
      passing.packet.terminated = true;
      passing.send(receiver, ms + 1, 9);
    }
    EXPECT_NE(presence(receiver, ms + 2), DeskPresence::present) << ms;
  }
  EXPECT_EQ(presence(receiver, 4001), DeskPresence::absent);
}

TEST(SacnInput, IgnoresSourcesBelowTheLowestPriority) {
  ReceiverSettings settings = hearing();
  settings.lowest_priority = 100;
  Receiver receiver(settings);
  HandDesk below(1, 99), desk(2, 100);
  EXPECT_EQ(below.send(receiver, 0, 9), Verdict::ignored);
  EXPECT_EQ(desk.send(receiver, 0, 9), Verdict::taken);
}

TEST(SacnInput, MergesEqualPrioritiesByHighestOrByLatest) {
  for (const MergeRule rule : {MergeRule::htp, MergeRule::ltp}) {
    ReceiverSettings settings = hearing();
    settings.rule = rule;
    Receiver receiver(settings);
    HandDesk one(1), two(2);
    warm_up(receiver, {{&one, 200}, {&two, 50}});
    EXPECT_EQ(level(receiver, 2001), rule == MergeRule::htp ? 200 : 50);
    one.send(receiver, 2002, 60);
    EXPECT_EQ(level(receiver, 2002), 60);
    two.send(receiver, 2003, 50);  // unchanged: not the latest
    EXPECT_EQ(level(receiver, 2003), 60);
    two.send(receiver, 2004, 40);
    EXPECT_EQ(level(receiver, 2004), rule == MergeRule::htp ? 60 : 40);
  }
}

TEST(SacnInput, NeverFallsBackToASourceThatMayBeLostToo) {
  Receiver receiver(hearing());
  HandDesk main(1, 150), backup(2, 100);
  for (double ms = 0; ms <= 3000; ms += 25) {
    main.send(receiver, ms, 10);
    backup.send(receiver, ms + 20, 255);  // at full
  }
  // The cable is pulled: both are silent from here on, the backup from 20 ms later.
  for (double ms = 3025; ms < 8000; ms += 1) ASSERT_EQ(level(receiver, ms), 10) << ms;
  EXPECT_EQ(presence(receiver, 8000), DeskPresence::absent);
}

TEST(SacnInput, FallsBackToABackupOnceItIsKnownToBeAlive) {
  Receiver receiver(hearing());
  HandDesk main(1, 150), backup(2, 100);
  for (double ms = 0; ms <= 3000; ms += 25) {
    main.send(receiver, ms, 10);
    backup.send(receiver, ms, 90);
  }
  for (double ms = 3025; ms <= 5500; ms += 25) {
    backup.send(receiver, ms, 90);
    ASSERT_EQ(level(receiver, ms), 10) << ms;
  }
  backup.send(receiver, 5525, 90);
  EXPECT_EQ(level(receiver, 5526), 90);
}

TEST(SacnInput, FollowsSlotPrioritiesAndIgnoresSlotsAtZero) {
  Receiver receiver(hearing());
  HandDesk one(1, 100), two(2, 150);
  DataPacket priorities = one.packet;
  priorities.start_code = kSlotPriority;
  priorities.slots[0] = 200;  // above the other's 150; elsewhere 0 = no value
  for (double ms = 0; ms <= 2000; ms += 25) {
    priorities.sequence = one.packet.sequence++;
    receiver.receive(at_ms(ms), encode(priorities));
    one.packet.slots[1] = 222;
    one.send(receiver, ms, 11);
    two.packet.slots[1] = 33;
    two.send(receiver, ms, 99);
  }
  const HeardUniverse heard = receiver.heard(at_ms(2001), 1);
  EXPECT_EQ(heard.levels.slots[0], 11);
  EXPECT_EQ(heard.levels.slots[1], 33);
  two.packet.terminated = true;
  two.send(receiver, 2005, 0);
  const HeardUniverse alone = receiver.heard(at_ms(2006), 1);
  EXPECT_TRUE(alone.levels.given[0]);
  EXPECT_FALSE(alone.levels.given[1]);
  // The priorities stop: back to the packets' priority after 2.5 s.
  for (double ms = 2025; ms <= 4600; ms += 25) one.send(receiver, ms, 11);
  EXPECT_TRUE(receiver.heard(at_ms(4601), 1).levels.given[1]);
}

TEST(SacnInput, IgnoresANewSourceUntilItsPrioritiesArrive) {
  Receiver receiver(hearing());
  HandDesk desk(1, 100), late(2, 150);
  warm_up(receiver, {{&desk, 20}});
  for (double ms = 2025; ms < 3500; ms += 25) {
    desk.send(receiver, ms, 20);
    late.send(receiver, ms, 200);
    EXPECT_EQ(level(receiver, ms + 1), 20) << ms;
  }
  late.send(receiver, 3525, 200);
  EXPECT_EQ(level(receiver, 3526), 200);
}

std::vector<std::uint8_t> sync(std::uint8_t sequence, std::uint16_t universe = 9) {
  return encode(SyncPacket{HandDesk(1).packet.cid, sequence, universe});
}

TEST(SacnInput, HoldsSynchronisedDataOnlyAfterTheFirstSynchronisation) {  // 11.1
  Receiver receiver(hearing());
  HandDesk desk(1);
  desk.packet.sync_universe = 9;
  warm_up(receiver, {{&desk, 5}});
  EXPECT_EQ(level(receiver, 2001), 5);
  EXPECT_TRUE(receiver.groups().contains(9));
  receiver.receive(at_ms(2002), sync(0));
  desk.send(receiver, 2025, 60);
  EXPECT_EQ(level(receiver, 2026), 5);
  receiver.receive(at_ms(2027), sync(1, 10));  // another universe's
  EXPECT_EQ(level(receiver, 2027), 5);
  EXPECT_EQ(receiver.receive(at_ms(2028), sync(0)), Verdict::out_of_order);
  EXPECT_EQ(level(receiver, 2028), 5);
  EXPECT_EQ(receiver.receive(at_ms(2029), sync(1)), Verdict::taken);
  EXPECT_EQ(level(receiver, 2029), 60);
}

TEST(SacnInput, FreezesOrContinuesAfterLostSynchronisationByForceSync) {
  for (const bool force : {false, true}) {
    Receiver receiver(hearing());
    HandDesk desk(1);
    desk.packet.sync_universe = 9;
    desk.packet.force_sync = force;
    warm_up(receiver, {{&desk, 5}});
    receiver.receive(at_ms(2002), sync(0));
    for (double ms = 2025; ms <= 4500; ms += 25) {
      desk.send(receiver, ms, 60);
      ASSERT_EQ(level(receiver, ms), 5) << ms;
    }
    desk.send(receiver, 4525, 61);
    EXPECT_EQ(level(receiver, 4526), force ? 61 : 5);
    receiver.receive(at_ms(4600), sync(0));  // it is back: its sequence starts over
    EXPECT_EQ(level(receiver, 4600), 61);
  }
}

TEST(SacnInput, KeepsABoundedNumberOfSourcesUnderAFlood) {
  Receiver receiver(hearing());
  for (int i = 0; i < 200; ++i) HandDesk(i).send(receiver, i, 1);
  EXPECT_EQ(receiver.sources(at_ms(200), 1), 16u);
  HandDesk flood(1);
  for (int universe = 1; universe < 5000; ++universe) {
    flood.packet.sync_universe = static_cast<std::uint16_t>(universe);
    flood.send(receiver, 300, 1);
  }
  EXPECT_LE(receiver.groups().size(), 66u);
}

}  // namespace
}  // namespace luxrig::sacn
