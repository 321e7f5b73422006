#include "drivers/dmx/sacn/sacn_driver.h"

#include <gtest/gtest.h>

#include <limits>

#include "drivers/dmx/sacn/sacn_codec.h"
#include "tests/drivers/io/scripted_datagram.h"
#include "tests/drivers/test_rig.h"

namespace luxrig {
namespace {

struct SacnBench {
  explicit SacnBench(std::vector<std::pair<std::string, OptionValue>> options = {},
                     std::optional<Redirect> redirect = std::nullopt) {
    rig = rig_with(bus_of("sacn", std::move(options)));
    add_dmx(rig, "spot", 1, 5);
    add_dmx(rig, "far", 300, 1);
    std::vector<std::unique_ptr<DatagramChannel>> channels;
    channels.push_back(std::make_unique<ScriptedDatagram>(net));
    driver = make_sacn_over(std::move(channels), rig, 0, redirect);
  }
  Result<void> write(double ms, double drive) {
    const LevelCommand commands[] = {{0, drive}, {1, drive}};
    return driver->level_output()->write(at_ms(ms), commands);
  }
  [[nodiscard]] Health health(double ms) const { return driver->health(at_ms(ms)).at(0); }
  [[nodiscard]] sacn::DataPacket packet(std::size_t index) const {
    return sacn::decode(net->sent.at(index).bytes).value();
  }

  std::shared_ptr<DatagramScript> net = std::make_shared<DatagramScript>();
  Rig rig;
  std::unique_ptr<Driver> driver;
};

const Fault kRefused{Cause::network, {}, "a packet to 127.0.0.1:5568: Connection refused", {}};

TEST(SacnDriver, SendsEachUniverseToItsGroup) {
  SacnBench bench;
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  EXPECT_TRUE(bench.net->sent.empty());
  ASSERT_TRUE(bench.write(10, 1.0));
  ASSERT_EQ(bench.net->sent.size(), 2u);
  EXPECT_EQ(text_of(bench.net->sent[0].to), "239.255.0.1:5568");
  EXPECT_EQ(text_of(bench.net->sent[1].to), "239.255.1.44:5568");
  EXPECT_EQ(bench.packet(0).slots[4], 255);
  EXPECT_EQ(bench.packet(0).source_name, "Luxrig test");
  EXPECT_EQ(bench.packet(0).priority, 100);
  EXPECT_FALSE(bench.driver->bounds().notices_loss);
}

TEST(SacnDriver, AppliesItsOptions) {
  SacnBench bench({{"destination", std::string("10.1.2.3")},
                   {"port", std::int64_t{7777}},
                   {"priority", std::int64_t{150}},
                   {"source_name", std::string("north wall")},
                   {"cid", std::string("6ba7b810-9dad-11d1-80b4-00c04fd430c8")}});
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  ASSERT_TRUE(bench.write(0, 0.5));
  EXPECT_EQ(text_of(bench.net->sent.at(1).to), "10.1.2.3:7777");
  EXPECT_EQ(bench.packet(0).priority, 150);
  EXPECT_EQ(bench.packet(0).source_name, "north wall");
  EXPECT_EQ(bench.packet(0).cid[0], 0x6b);
  EXPECT_TRUE(bench.driver->bounds().notices_loss);
}

TEST(SacnDriver, SendsDataAndSynchronisationToEachListedReceiver) {
  SacnBench bench({{"destination", std::string("10.0.0.1, 10.0.0.2")}, {"sync_universe", std::int64_t{50}}});
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  ASSERT_TRUE(bench.write(0, 0.5));
  ASSERT_EQ(bench.net->sent.size(), 6u);  // two universes and the synchronisation packet, to two receivers
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(text_of(bench.net->sent[i].to), i % 2 == 0 ? "10.0.0.1:5568" : "10.0.0.2:5568");
    EXPECT_EQ(sacn::decode_sync(bench.net->sent[i].bytes).has_value(), i >= 4);
  }
  SacnBench multicast({{"sync_universe", std::int64_t{50}}});
  ASSERT_TRUE(multicast.driver->activate(at_ms(0)));
  ASSERT_TRUE(multicast.write(0, 0.5));
  EXPECT_EQ(text_of(multicast.net->sent.at(2).to), "239.255.0.50:5568");
}

TEST(SacnDriver, MarksPreviewDataAndSendsPrioritiesOfUsedSlots) {
  SacnBench bench({{"preview", true}, {"slot_priority", true}, {"priority", std::int64_t{0}}});
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  ASSERT_TRUE(bench.write(0, 0.5));
  const sacn::DataPacket first = bench.packet(0);
  EXPECT_TRUE(first.preview);
  EXPECT_EQ(first.start_code, sacn::kSlotPriority);
  EXPECT_EQ(first.slots[4], 1);  // 0 would mean: no value
  EXPECT_EQ(first.slots[5], 0);
  ASSERT_TRUE(bench.write(23, 0.5));
  EXPECT_EQ(bench.packet(2).start_code, sacn::kLevels);
}

TEST(SacnDriver, SendsTheSamePacketsOverEveryInterface) {
  Rig rig = rig_with(bus_of("sacn"));
  add_dmx(rig, "spot", 1, 5);
  const auto left = std::make_shared<DatagramScript>(), right = std::make_shared<DatagramScript>();
  std::vector<std::unique_ptr<DatagramChannel>> channels;
  channels.push_back(std::make_unique<ScriptedDatagram>(left));
  channels.push_back(std::make_unique<ScriptedDatagram>(right));
  const auto driver = make_sacn_over(std::move(channels), rig, 0, std::nullopt);
  ASSERT_TRUE(driver->activate(at_ms(0)));
  const LevelCommand command{0, 0.5};
  ASSERT_TRUE(driver->level_output()->write(at_ms(0), {&command, 1}));
  right->send_fails = Fault{Cause::network, {}, "sending: Network is unreachable", {}};
  EXPECT_FALSE(driver->level_output()->write(at_ms(23), {&command, 1}));
  driver->deactivate(at_ms(46));
  ASSERT_EQ(left->sent.size(), 5u);  // two cycles, three goodbyes
  ASSERT_EQ(right->sent.size(), 1u);
  EXPECT_EQ(left->sent[0].bytes, right->sent[0].bytes);
}

TEST(SacnDriver, SendsEverythingToTheRedirectedAddress) {
  SacnBench bench({{"interface", std::string("no-such-0")}}, Redirect{"127.0.0.1", 4444});
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  ASSERT_TRUE(bench.write(0, 0.5));
  EXPECT_EQ(text_of(bench.net->sent.at(0).to), "127.0.0.1:4444");
  EXPECT_EQ(text_of(bench.net->sent.at(1).to), "127.0.0.1:4444");
}

TEST(SacnDriver, SendsThreeGoodbyesPerUniverseOnlyOnce) {
  SacnBench bench;
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  ASSERT_TRUE(bench.write(0, 1.0));
  bench.net->sent.clear();
  bench.driver->deactivate(at_ms(30));
  ASSERT_EQ(bench.net->sent.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_TRUE(bench.packet(i).terminated);
    EXPECT_EQ(bench.packet(i).universe, i % 2 == 0 ? 1 : 300);
  }
  EXPECT_FALSE(bench.net->open);
  bench.driver->deactivate(at_ms(40));
  bench.driver.reset();
  EXPECT_EQ(bench.net->sent.size(), 6u);
}

TEST(SacnDriver, SendsGoodbyesWhenDestroyedWhileActive) {
  SacnBench bench;
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  ASSERT_TRUE(bench.write(0, 1.0));
  bench.driver.reset();
  EXPECT_EQ(bench.net->sent.size(), 2u + 6u);
  EXPECT_FALSE(bench.net->open);
}

TEST(SacnDriver, WritesNothingWhileInactive) {
  SacnBench bench;
  EXPECT_EQ(bench.write(0, 1.0).error().cause, Cause::inactive);
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  bench.driver->deactivate(at_ms(1));
  EXPECT_EQ(bench.write(2, 1.0).error().cause, Cause::inactive);
  EXPECT_TRUE(bench.net->sent.empty());
}

TEST(SacnDriver, SendsNothingForAnInvalidSetpoint) {
  SacnBench bench;
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  EXPECT_EQ(bench.write(0, std::numeric_limits<double>::quiet_NaN()).error().cause, Cause::invalid);
  EXPECT_EQ(bench.write(0, 1.01).error().cause, Cause::invalid);
  EXPECT_TRUE(bench.net->sent.empty());
  EXPECT_EQ(bench.health(1).life, Life::active);
}

TEST(SacnDriver, IsFaultedWhileTheReceiversPortIsClosedAndKeepsSending) {
  SacnBench bench({{"destination", std::string("127.0.0.1")}});
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  ASSERT_TRUE(bench.write(0, 0.1));
  bench.net->errors.push_back(kRefused);
  const auto result = bench.write(23, 0.1);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().cause, Cause::network);
  EXPECT_EQ(result.error().device, "the-bus");
  EXPECT_EQ(bench.health(23).life, Life::faulted);
  EXPECT_NE(bench.health(23).detail.find("Connection refused (1 errors, 2 packets)"), std::string::npos)
      << bench.health(23).detail;
  EXPECT_EQ(bench.health(23).since, at_ms(23));
  EXPECT_EQ(bench.net->sent.size(), 4u);
}

TEST(SacnDriver, RecoversAfterAQuietPeriodWithTheCurrentSetpoint) {
  SacnBench bench({{"destination", std::string("127.0.0.1")}});
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  ASSERT_TRUE(bench.write(0, 0.1));
  bench.net->errors.push_back(kRefused);
  EXPECT_FALSE(bench.write(100, 1.0));
  EXPECT_FALSE(bench.write(1200, 0.5));  // 1.1 s after the error
  EXPECT_EQ(bench.packet(bench.net->sent.size() - 2).slots[4], 128);
  EXPECT_TRUE(bench.write(1400, 0.5));
  EXPECT_EQ(bench.health(1400).life, Life::active);
  EXPECT_EQ(bench.health(1400).detail, "");
  EXPECT_EQ(bench.health(1400).errors, 1u);
}

TEST(SacnDriver, ReportsAnUnreachableNetworkAndRecovers) {
  SacnBench bench;
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  bench.net->send_fails = Fault{Cause::network, {}, "sending: Network is unreachable", {}};
  EXPECT_FALSE(bench.write(0, 1.0));
  EXPECT_EQ(bench.health(0).last_ok, Time{});
  bench.net->send_fails.reset();
  EXPECT_FALSE(bench.write(500, 1.0));
  EXPECT_TRUE(bench.write(1300, 1.0));
  EXPECT_EQ(bench.health(1300).last_ok, at_ms(1300));
}

TEST(SacnDriver, StartsFaultedWithoutItsInterfaceAndRetriesEverySecond) {
  SacnBench bench;
  bench.net->open_fails = Fault{Cause::network, {}, "looking up the interface \"eth9\": No such device", {}};
  ASSERT_TRUE(bench.driver->activate(at_ms(0)));
  EXPECT_EQ(bench.health(0).life, Life::faulted);
  bench.net->open_fails.reset();
  EXPECT_FALSE(bench.write(900, 1.0));
  EXPECT_EQ(bench.net->opened, 0);
  (void)bench.write(1000, 1.0);
  EXPECT_EQ(bench.net->opened, 1);
  EXPECT_EQ(bench.net->sent.size(), 2u);
  EXPECT_TRUE(bench.write(2300, 1.0));
}

TEST(SacnDriver, RefusesInvalidOptions) {
  const auto problem = [](const char* key, OptionValue value) {
    Rig rig = rig_with(bus_of("sacn", {{key, std::move(value)}}));
    const auto problems = check_sacn(rig, 0);
    EXPECT_EQ(problems.size(), 1u) << key;
    return problems.empty() ? std::string() : problems[0].text();
  };
  EXPECT_EQ(problem("prority", std::int64_t{100}),
            "a/rig.toml:8:5: bus \"the-bus\" has an unknown option \"prority\": did you mean \"priority\"?");
  EXPECT_EQ(problem("priority", std::int64_t{201}),
            "a/rig.toml:8:5: priority = 201 is out of range: choose a value in 0 to 200");
  EXPECT_EQ(
      problem("priority", 1.5),
      "a/rig.toml:8:5: priority is a number with a fraction where a whole number is wanted: write priority = 100");
  problem("destination", std::string("node.local"));
  problem("destination", std::string("239.255.0.1"));
  problem("interface", std::string("an interface name"));
  problem("destination", std::string("10.0.0.1, node.local"));
  problem("interface", std::string("eth0,,eth1"));
  problem("cid", std::string("1234"));
  problem("source_name", std::string(64, 'x'));
  problem("continuous", std::string("yes"));
}

}  // namespace
}  // namespace luxrig
