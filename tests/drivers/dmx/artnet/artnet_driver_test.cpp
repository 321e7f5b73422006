#include "drivers/dmx/artnet/artnet_driver.h"

#include <gtest/gtest.h>

#include <limits>

#include "drivers/dmx/artnet/artnet_codec.h"
#include "tests/drivers/hex.h"
#include "tests/drivers/io/scripted_datagram.h"
#include "tests/drivers/test_rig.h"

namespace luxrig {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes reply_of(const std::string& name, std::uint8_t universe) {
  Bytes bytes(239, 0);
  const Bytes head = from_hex("4172742d4e657400 0021");
  std::copy(head.begin(), head.end(), bytes.begin());
  std::copy(name.begin(), name.end(), bytes.begin() + 26);
  bytes[173] = 1;
  bytes[174] = 0x80;
  bytes[190] = universe;
  return bytes;
}

struct Bench {
  explicit Bench(std::vector<std::pair<std::string, OptionValue>> options = {},
                 std::optional<Redirect> redirect = std::nullopt) {
    rig = rig_with(bus_of("artnet", std::move(options)));
    add_dmx(rig, "spot", 1, 5);
    driver = make_artnet_over(std::make_unique<ScriptedDatagram>(net), rig, 0, redirect);
  }
  Result<void> write(double ms, double drive) {
    const LevelCommand command{0, drive};
    return driver->level_output()->write(at_ms(ms), {&command, 1});
  }
  void hear(const char* ip, const Bytes& bytes) { net->incoming.push_back({{*parse_ipv4(ip), 6454}, bytes}); }
  /// Sent since the last call: "poll" or the level of slot 5, with the address.
  std::vector<std::string> sent() {
    std::vector<std::string> all;
    for (const auto& [to, bytes] : net->sent) {
      const auto dmx = artnet::decode_dmx(bytes);
      const std::string other = artnet::is_sync(bytes) ? "sync" : artnet::decode_poll(bytes) ? "poll" : "other";
      all.push_back((dmx ? std::to_string(dmx->slots.at(4)) : other) + " to " + text_of(to));
    }
    net->sent.clear();
    return all;
  }
  [[nodiscard]] Health health(std::size_t index = 0) const { return driver->health(at_ms(0)).at(index); }

  std::shared_ptr<DatagramScript> net = std::make_shared<DatagramScript>();
  Rig rig;
  std::unique_ptr<Driver> driver;
};

using Strings = std::vector<std::string>;

TEST(ArtnetDriver, SendsOnlyToNodesThatOutputTheUniverse) {
  Bench bench;
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  ASSERT_TRUE(bench.write(0, 1.0));
  EXPECT_EQ(bench.sent(), (Strings{"poll to 255.255.255.255:6454"}));
  bench.hear("10.0.0.7", reply_of("Right", 1));
  bench.hear("10.0.0.8", reply_of("Other", 2));
  ASSERT_TRUE(bench.write(23, 1.0));
  EXPECT_EQ(bench.sent(), (Strings{"255 to 10.0.0.7:6454"}));
  EXPECT_EQ(bench.health(1).device, "the-bus: Right (10.0.0.7)");
  EXPECT_EQ(bench.health(2).device, "the-bus: Other (10.0.0.8)");
}

TEST(ArtnetDriver, LosingAnUnrelatedNodeIsNoFault) {
  Bench bench;
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  bench.hear("10.0.0.7", reply_of("Right", 1));
  bench.hear("10.0.0.8", reply_of("Other", 2));
  for (int ms = 0; ms <= 12000; ms += 23) {
    if (ms % 2300 == 0) bench.hear("10.0.0.7", reply_of("Right", 1));
    (void)bench.write(ms, 0.2);
  }
  EXPECT_EQ(bench.health(1).life, Life::active);
  EXPECT_EQ(bench.health(2).device, "the-bus: Other (10.0.0.8)");
  EXPECT_EQ(bench.health(2).life, Life::configured) << "no light hangs on it";
  EXPECT_NE(bench.health(2).detail, "");
}

TEST(ArtnetDriver, SendsChangesAtOnceAndTheRestEverySecond) {
  Bench bench({{"destination", std::string("10.0.0.7")}});
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  ASSERT_TRUE(bench.write(0, 0.0));
  ASSERT_TRUE(bench.write(23, 0.0));
  EXPECT_EQ(bench.sent(), (Strings{"poll to 10.0.0.7:6454", "0 to 10.0.0.7:6454", "0 to 10.0.0.7:6454"}));
  ASSERT_TRUE(bench.write(46, 0.0));
  EXPECT_EQ(bench.sent(), Strings{});
  ASSERT_TRUE(bench.write(69, 0.2));
  EXPECT_EQ(bench.sent(), (Strings{"51 to 10.0.0.7:6454"}));
  for (double ms = 92; ms < 1069; ms += 23) ASSERT_TRUE(bench.write(ms, 0.2));
  EXPECT_EQ(bench.sent(), Strings{});
  ASSERT_TRUE(bench.write(1070, 0.2));
  EXPECT_EQ(bench.sent(), (Strings{"51 to 10.0.0.7:6454"}));
}

TEST(ArtnetDriver, SynchronisesNodesByBroadcastAfterEachSentFrame) {
  Bench bench({{"sync", true}});
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  bench.hear("10.0.0.7", reply_of("Right", 1));
  ASSERT_TRUE(bench.write(0, 1.0));
  EXPECT_EQ(bench.sent(),
            (Strings{"poll to 255.255.255.255:6454", "255 to 10.0.0.7:6454", "sync to 255.255.255.255:6454"}));
  ASSERT_TRUE(bench.write(23, 1.0));  // the packet after the jump
  bench.sent();
  ASSERT_TRUE(bench.write(46, 1.0));
  EXPECT_EQ(bench.sent(), Strings{});
}

TEST(ArtnetDriver, OmitsSequenceNumbersForNodesThatCannotCount) {
  Bench bench({{"destination", std::string("10.0.0.7")}, {"continuous", true}, {"sequence", false}});
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  int packets = 0;
  for (int cycle = 0; cycle < 40; ++cycle) (void)bench.write(cycle * 23.0, 0.5);
  for (const auto& [to, bytes] : bench.net->sent) {
    const auto dmx = artnet::decode_dmx(bytes);
    if (!dmx) continue;
    EXPECT_EQ(dmx->sequence, 0);
    ++packets;
  }
  EXPECT_EQ(packets, 40);
}

TEST(ArtnetDriver, ReportsANodeThatMergesItsDataWithAnothers) {
  Bench bench;
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  Bytes merging = reply_of("Right", 1);
  merging[182] = 0x88;
  bench.hear("10.0.0.7", merging);
  ASSERT_TRUE(bench.write(0, 1.0));
  EXPECT_EQ(bench.health(1).detail, "merges this bus's data with another sender's");
  bench.hear("10.0.0.7", reply_of("Right", 1));
  ASSERT_TRUE(bench.write(23, 1.0));
  EXPECT_EQ(bench.health(1).detail, "");
}

TEST(ArtnetDriver, PollsEveryTwoAndAHalfToThreeSeconds) {
  Bench bench({{"destination", std::string("10.0.0.7")}, {"continuous", true}});
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  std::vector<double> polls;
  int packets = 0;
  for (int cycle = 0; cycle < 440; ++cycle) {
    const double ms = cycle * 1000.0 / 44;
    (void)bench.write(ms, 0.5);
    for (const std::string& what : bench.sent()) {
      if (what.starts_with("poll")) {
        polls.push_back(ms);
      } else {
        ++packets;
      }
    }
  }
  EXPECT_EQ(packets, 440);
  ASSERT_EQ(polls.size(), 4u);
  for (std::size_t i = 1; i < polls.size(); ++i) {
    EXPECT_GE(polls[i] - polls[i - 1], 2500);
    EXPECT_LE(polls[i] - polls[i - 1], 3000);
  }
}

TEST(ArtnetDriver, CountsSequencesFromOneTo255WithoutZero) {
  Bench bench({{"destination", std::string("10.0.0.7")}, {"continuous", true}});
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  int last = -1;
  for (int cycle = 0; cycle < 600; ++cycle) {
    (void)bench.write(cycle * 23.0, 0.5);
    for (const auto& [to, bytes] : bench.net->sent) {
      const auto dmx = artnet::decode_dmx(bytes);
      if (!dmx) continue;
      EXPECT_NE(dmx->sequence, 0);
      if (cycle == 1) {
        EXPECT_EQ(dmx->sequence, 21);  // past any number a node may remember from before a restart
      }
      if (cycle > 1) {
        EXPECT_EQ(dmx->sequence, last % 255 + 1);
      }
      last = dmx->sequence;
    }
    bench.net->sent.clear();
  }
}

TEST(ArtnetDriver, NamesALostNodeAndSendsItTheCurrentLookOnItsReturn) {
  Bench bench;
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  bench.hear("10.0.0.7", reply_of("Stage left", 1));
  ASSERT_TRUE(bench.write(0, 0.2));
  Time faulted{};
  for (double ms = 23; ms < 12000; ms += 23) {
    if (!bench.write(ms, 0.2) && faulted == Time{}) faulted = at_ms(ms);
  }
  EXPECT_GT(faulted, at_ms(8500));
  EXPECT_LE(faulted, at_ms(0) + bench.driver->bounds().fault_after);
  EXPECT_EQ(bench.health(0).life, Life::faulted);
  EXPECT_NE(bench.health(0).detail.find("node \"Stage left\" at 10.0.0.7:6454 has answered no poll for 12.0 s"),
            std::string::npos)
      << bench.health(0).detail;
  EXPECT_EQ(bench.health(1).life, Life::faulted);
  bench.sent();
  EXPECT_FALSE(bench.write(12000, 0.8));
  EXPECT_EQ(bench.sent(), Strings{});  // no receiver
  bench.hear("10.0.0.7", reply_of("Stage left", 1));
  EXPECT_TRUE(bench.write(12023, 1.0));
  EXPECT_EQ(bench.sent(), (Strings{"255 to 10.0.0.7:6454"}));
  EXPECT_EQ(bench.health(0).life, Life::active);
  EXPECT_EQ(bench.health(1).life, Life::active);
}

TEST(ArtnetDriver, NamesAUniverseThatNoNodeOutputs) {
  Bench bench;
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  for (double ms = 0; ms < 9000; ms += 23) (void)bench.write(ms, 0.2);
  EXPECT_EQ(bench.health().detail, "timeout: no node puts out universe 1 (0:0:1)");
}

TEST(ArtnetDriver, IgnoresSilenceWhereNoReplyIsExpected) {
  Bench bench({{"destination", std::string("10.0.0.7")}, {"expect_reply", false}});
  EXPECT_FALSE(bench.driver->bounds().notices_loss);
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  for (double ms = 0; ms < 12000; ms += 23) EXPECT_TRUE(bench.write(ms, 0.2));
}

TEST(ArtnetDriver, IsFaultedAtOnceWhenThePortIsClosed) {
  Bench bench({}, Redirect{"127.0.0.1", 4444});
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  ASSERT_TRUE(bench.write(0, 0.2));
  EXPECT_EQ(bench.sent(), (Strings{"poll to 127.0.0.1:4444", "51 to 127.0.0.1:4444"}));
  bench.net->errors.push_back({Cause::network, {}, "a packet to 127.0.0.1:4444: Connection refused", {}});
  const auto result = bench.write(23, 0.2);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().cause, Cause::network);
  EXPECT_TRUE(bench.write(1300, 0.2));
}

TEST(ArtnetDriver, SendsNothingForAnInvalidSetpointOrWhileInactive) {
  Bench bench({{"destination", std::string("10.0.0.7")}});
  EXPECT_EQ(bench.write(0, 0.5).error().cause, Cause::inactive);
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  EXPECT_EQ(bench.write(0, std::numeric_limits<double>::quiet_NaN()).error().cause, Cause::invalid);
  bench.driver->deactivate(at_ms(1));
  EXPECT_EQ(bench.write(2, 0.5).error().cause, Cause::inactive);
  EXPECT_EQ(bench.sent(), Strings{});
}

TEST(ArtnetDriver, RefusesInvalidOptions) {
  const auto count = [](const char* key, OptionValue value) {
    return check_artnet(rig_with(bus_of("artnet", {{key, std::move(value)}})), 0).size();
  };
  EXPECT_EQ(count("destination", std::string("node")), 1u);
  EXPECT_EQ(count("destination", std::string("239.1.1.1")), 1u);
  EXPECT_EQ(count("broadcast", std::string("everyone")), 1u);
  EXPECT_EQ(count("expect_reply", false), 1u);
  EXPECT_EQ(count("destinatoin", std::string("10.0.0.7")), 1u);
  EXPECT_EQ(count("destination", std::string("10.0.0.7")), 0u);
  Rig rig = rig_with(bus_of("artnet"));
  add_dmx(rig, "spot", 32768, 1);
  EXPECT_EQ(check_artnet(rig, 0).size(), 1u);
}

}  // namespace
}  // namespace luxrig
