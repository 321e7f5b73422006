#include "drivers/modbus/modbus_schedule.h"

#include <gtest/gtest.h>

#include <set>

#include "core/rig/register_map/register_map.h"
#include "drivers/modbus/modbus_registers.h"
#include "tests/drivers/test_rig.h"

namespace luxrig::modbus {
namespace {

using std::chrono::milliseconds;

std::map<int, UnitRules> rules_of(const Rig& rig) { return unit_rules(rig, 0, milliseconds(200), false); }

TEST(ModbusReadSchedule, ReadsNeighboursOfAUnitTogether) {
  Rig rig = rig_with(bus_of("modbus_tcp"));
  add_meter(rig, "b", 1, 4);
  add_meter(rig, "a", 1, 2);
  add_meter(rig, "far", 1, 10);
  add_meter(rig, "input", 1, 6).patch.input_registers = true;
  add_meter(rig, "other", 2, 6);
  const ReadSchedule schedule(rig, 0, milliseconds(200), rules_of(rig));
  const auto due = schedule.due(at_ms(0), {});
  ASSERT_EQ(due.size(), 4u);
  EXPECT_EQ(due[0].request.first_register, 2);
  EXPECT_EQ(due[0].request.count, 4u);
  EXPECT_EQ(schedule.meters()[due[0].begin], 1u);  // "a"
  EXPECT_EQ(due[1].request.first_register, 10);
  EXPECT_EQ(due[2].request.function, Function::read_input);
  EXPECT_EQ(due[3].request.unit, 2);
}

TEST(ModbusReadSchedule, KeepsToTheLargestReadAndToSingleReadsOnceRefused) {
  Rig rig = rig_with(bus_of("modbus_tcp"));
  auto map = std::make_shared<RegisterMap>();
  map->largest_read = 4;
  for (int i = 0; i < 5; ++i) add_meter(rig, "meter-" + std::to_string(i), 1, 2 * i).patch.map = map;
  ReadSchedule schedule(rig, 0, milliseconds(200), rules_of(rig));
  auto due = schedule.due(at_ms(0), {});
  ASSERT_EQ(due.size(), 3u);
  EXPECT_EQ(due[0].request.count, 4u);
  EXPECT_EQ(due[2].request.count, 2u);
  schedule.asked(due[0], at_ms(0));
  due = schedule.due(at_ms(100), {});
  ASSERT_EQ(due.size(), 2u) << "two have just been asked";
  EXPECT_EQ(due[0].request.first_register, 4);
  schedule.read_singly(1);
  EXPECT_EQ(schedule.due(at_ms(200), {}).size(), 5u);
}

TEST(ModbusWriteSchedule, SwitchesNeighbouringCoilsTogetherAndNeverWithRegisters) {
  Rig rig = rig_with(bus_of("modbus_tcp"));
  add_modbus(rig, "dimmer", 1, 2);
  for (int i = 0; i < 3; ++i) std::get<ModbusPatch>(add_modbus(rig, "relay", 1, i, 1).patch).coil = true;
  std::get<ModbusPatch>(add_modbus(rig, "apart", 1, 7, 1).patch).coil = true;
  WriteSchedule schedule(rig, 0, milliseconds(400), rules_of(rig));
  for (Channel& channel : schedule.channels()) channel.wanted = words_from_drive(1, channel.patch);
  const auto runs = schedule.due(at_ms(0), {});
  ASSERT_EQ(runs.size(), 3u);
  EXPECT_EQ(schedule.request_for(runs[0]).function, Function::write_single);
  EXPECT_EQ(schedule.request_for(runs[1]).function, Function::write_coils);
  EXPECT_EQ(schedule.request_for(runs[1]).values, (std::vector<std::uint16_t>{1, 1, 1}));
  EXPECT_EQ(schedule.request_for(runs[2]).function, Function::write_coil);
  EXPECT_EQ(schedule.request_for(runs[2]).first_register, 7);
}

TEST(ModbusRegisters, ARelayTurnsOnAtHalfWithoutChattering) {
  ModbusPatch relay;
  relay.coil = true;
  const auto on = words_from_drive(0.5, relay), off = words_from_drive(0.49, relay);
  EXPECT_EQ(on.word[0], 1);
  EXPECT_EQ(off.word[0], 0);
  EXPECT_EQ(words_from_drive(0.45, relay, on), on);
  EXPECT_EQ(words_from_drive(0.45, relay, off), off);
  EXPECT_EQ(words_from_drive(0.39, relay, on), off);
  EXPECT_EQ(words_from_drive(0, relay, on), off);
}

TEST(ModbusWriteSchedule, KeepsToTheLargestWriteCountingBothRegistersOfANumber) {
  Rig rig = rig_with(bus_of("modbus_tcp"));
  auto map = std::make_shared<RegisterMap>();
  map->largest_write = 5;
  for (int i = 0; i < 4; ++i) {
    auto& patch = std::get<ModbusPatch>(add_modbus(rig, "lamp-" + std::to_string(i), 1, 2 * i, 1).patch);
    patch.format = {2, RegisterNumber::floating, false, false};
    patch.map = map;
  }
  WriteSchedule schedule(rig, 0, milliseconds(400), rules_of(rig));
  for (Channel& channel : schedule.channels()) channel.wanted = words_of(0.5, channel.patch.format);
  const auto runs = schedule.due(at_ms(0), {});
  ASSERT_EQ(runs.size(), 2u);
  const Request request = schedule.request_for(runs[0]);
  EXPECT_EQ(request.function, Function::write_multiple);
  EXPECT_EQ(request.values, (std::vector<std::uint16_t>{0x3F00, 0, 0x3F00, 0}));
}

TEST(ModbusUnitRules, AnAnswerTimeSetsTheLineTimeoutAndTheGatewayMinimum) {
  Rig rig = rig_with(bus_of("modbus_rtu"));
  auto quick = std::make_shared<RegisterMap>();
  quick->answer_time = milliseconds(50);
  auto slow = std::make_shared<RegisterMap>();
  slow->answer_time = milliseconds(900);
  add_meter(rig, "quick", 1, 2).patch.map = quick;
  add_meter(rig, "slow", 2, 2).patch.map = slow;
  add_meter(rig, "unknown", 3, 2);
  const auto line = unit_rules(rig, 0, milliseconds(200), false), gateway = unit_rules(rig, 0, milliseconds(200), true);
  EXPECT_EQ(line.at(1).timeout, milliseconds(80));
  EXPECT_EQ(line.at(2).timeout, milliseconds(930));
  EXPECT_EQ(line.at(3).timeout, milliseconds(200));
  EXPECT_EQ(gateway.at(1).timeout, milliseconds(200));
  EXPECT_EQ(gateway.at(2).timeout, milliseconds(930));
}

TEST(ModbusReadSchedule, KeepsItsRateWithSlightlyEarlyOrLateCalls) {
  Rig rig = rig_with(bus_of("modbus_tcp"));
  add_meter(rig, "a", 1, 4);
  for (const double every_ms : {100.0, 115.0, 130.0}) {
    ReadSchedule schedule(rig, 0, milliseconds(200), rules_of(rig));
    int reads = 0;
    double last_ms = 0, longest_ms = 0;
    for (int call = 0; call * every_ms < 20000; ++call) {
      const double ms = call * every_ms + (call % 3 - 1) * 8;
      for (const ReadSchedule::Batch& batch : schedule.due(at_ms(ms), {})) {
        schedule.asked(batch, at_ms(ms));
        ++reads;
        longest_ms = std::max(longest_ms, ms - last_ms);
        last_ms = ms;
      }
    }
    EXPECT_NEAR(reads, 100, 3) << every_ms;
    EXPECT_LE(longest_ms, 200 + every_ms) << every_ms;
  }
}

TEST(ModbusUnitBackoff, PollsASilentUnitLessAndLess) {
  UnitBackoff units;
  EXPECT_TRUE(units.may_ask(1, at_ms(0)));
  units.silent(1, at_ms(0), milliseconds(400), {});
  EXPECT_FALSE(units.may_ask(1, at_ms(399)));
  EXPECT_TRUE(units.may_ask(1, at_ms(400)));
  EXPECT_TRUE(units.may_ask(2, at_ms(0)));
  units.silent(1, at_ms(400), milliseconds(400), {});
  EXPECT_FALSE(units.may_ask(1, at_ms(1399)));
  units.silent(1, at_ms(1400), milliseconds(400), {});
  units.silent(1, at_ms(3400), milliseconds(400), {});
  EXPECT_FALSE(units.may_ask(1, at_ms(5399)));
  EXPECT_TRUE(units.may_ask(1, at_ms(5400)));
  units.answered(1);
  EXPECT_TRUE(units.may_ask(1, at_ms(0)));
  EXPECT_FALSE(units.is_silent(1));
}

TEST(ModbusUnitBackoff, SilentUnitsShareATwentiethOfTheTimeInTurn) {
  constexpr int kDead = 10;
  constexpr Duration kTimeout = milliseconds(200);
  Rig rig = rig_with(bus_of("modbus_tcp"));
  for (int unit = 1; unit <= kDead + 2; ++unit) add_meter(rig, std::to_string(unit), unit, 2);
  ReadSchedule schedule(rig, 0, milliseconds(200), rules_of(rig));
  UnitBackoff units;
  Time now = at_ms(0);
  for (int unit = 1; unit <= kDead; ++unit) units.silent(unit, now, milliseconds(1000), kTimeout);

  std::map<int, Time> asked;
  Duration longest{}, in_vain{};
  const Time end = now + std::chrono::minutes(10);
  for (; now < end; now += milliseconds(100)) {
    for (const ReadSchedule::Batch& batch : schedule.due(now, units)) {
      schedule.asked(batch, now);
      if (batch.request.unit > kDead) continue;  // answers
      if (asked.contains(batch.request.unit)) longest = std::max(longest, now - asked[batch.request.unit]);
      asked[batch.request.unit] = now;
      units.silent(batch.request.unit, now, milliseconds(1000), kTimeout);
      in_vain += kTimeout;
      now += kTimeout;
      break;
    }
  }
  EXPECT_EQ(asked.size(), static_cast<std::size_t>(kDead));
  EXPECT_LE(to_seconds(in_vain), 600 / UnitBackoff::kProbeShare + to_seconds(UnitBackoff::kProbeCredit) + 0.2);
  EXPECT_GE(to_seconds(in_vain), 0.9 * 600 / UnitBackoff::kProbeShare);
  EXPECT_LE(longest, std::chrono::seconds(2) + UnitBackoff::kProbeShare * kDead * kTimeout);

  // Power is back: the others do not wait for their share.
  now += std::chrono::seconds(5);
  units.answered(3);
  std::set<int> next;
  for (const ReadSchedule::Batch& batch : schedule.due(now, units)) next.insert(batch.request.unit);
  EXPECT_GE(next.size(), static_cast<std::size_t>(kDead)) << "all but those asked within 2 s";
}

// This acknowledges a blackout.
TEST(ModbusWriteSchedule, IsConfirmedOnceEveryDeviceHasAcknowledgedTheLatestLevels) {
  Rig rig = rig_with(bus_of("modbus_tcp"));
  add_modbus(rig, "near", 1, 2);
  add_modbus(rig, "far", 2, 2);
  WriteSchedule schedule(rig, 0, milliseconds(400), rules_of(rig));
  const auto want = [&](double drive) {
    for (Channel& channel : schedule.channels()) channel.wanted = words_from_drive(drive, channel.patch);
  };
  want(0.5);
  EXPECT_FALSE(schedule.all_confirmed());
  auto runs = schedule.due(at_ms(0), {});
  ASSERT_EQ(runs.size(), 2u) << "a request for each unit";
  for (const auto& run : runs) schedule.tried(run, at_ms(0));
  EXPECT_FALSE(schedule.all_confirmed()) << "sent is not confirmed";
  schedule.confirmed(runs[0]);
  EXPECT_FALSE(schedule.all_confirmed()) << "one of two";
  schedule.confirmed(runs[1]);
  EXPECT_TRUE(schedule.all_confirmed());

  want(0);
  EXPECT_FALSE(schedule.all_confirmed());
  ASSERT_TRUE(schedule.due(at_ms(10), {}).empty()) << "not rewritten so soon";
  EXPECT_FALSE(schedule.all_confirmed());
  runs = schedule.due(at_ms(60), {});
  ASSERT_EQ(runs.size(), 2u);
  for (const auto& run : runs) schedule.confirmed(run);
  EXPECT_TRUE(schedule.all_confirmed());
  schedule.forget();
  EXPECT_FALSE(schedule.all_confirmed()) << "after a lost connection nothing is known";
}

}  // namespace
}  // namespace luxrig::modbus
