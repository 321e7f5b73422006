#include "core/rig/register_map/register_map_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/core/rig/kitchen_sink.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

const std::filesystem::path kMaps = test::source_folder() / "rigs/register-maps";

RegisterMap map_named(const char* name) {
  const auto map = load_register_map(kMaps / name);
  if (!map) {
    for (const Problem& problem : map.error()) ADD_FAILURE() << problem.text();
    return {};
  }
  return *map;
}

TEST(RegisterMapFile, EveryShippedMapIsValidAndNamesItsSource) {
  std::size_t maps = 0;
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kMaps)) {
    if (entry.path().extension() != ".toml") continue;
    ++maps;
    const RegisterMap map = map_named(entry.path().filename().c_str());
    EXPECT_TRUE(names.insert(map.name).second) << map.name;
    EXPECT_FALSE(map.source.empty());
    EXPECT_FALSE(map.with_role(RegisterRole::level).empty() && map.with_role(RegisterRole::illuminance).empty())
        << map.name;
  }
  EXPECT_GE(maps, 4u);
}

TEST(RegisterMapFile, DescribesTheEightOutputsOfAnAnalogueModule) {
  const RegisterMap map = map_named("waveshare-analog-output-8ch-b.toml");
  const auto levels = map.with_role(RegisterRole::level);
  ASSERT_EQ(levels.size(), 8u);
  EXPECT_EQ(map.registers[levels[0]].name, "output1");
  EXPECT_EQ(map.registers[levels[7]].name, "output8");
  EXPECT_EQ(map.registers[levels[7]].address, 7);
  EXPECT_EQ(map.registers[levels[7]].range_raw->second, 10000);
  EXPECT_EQ(map.when_data_stops, DataLoss::hold);
  EXPECT_EQ(told_when_data_stops(map), "holds its last level for ever");
}

TEST(RegisterMapFile, DescribesRelaysAndInputsOfOneBit) {
  const RegisterMap map = map_named("waveshare-modbus-rtu-relay-d.toml");
  const auto levels = map.with_role(RegisterRole::level);
  ASSERT_EQ(levels.size(), 8u);
  EXPECT_EQ(map.registers[levels[7]].table, RegisterTable::coil);
  EXPECT_EQ(map.registers[levels[7]].address, 7);
  EXPECT_EQ(map.registers[levels[7]].range_raw, std::pair(0.0, 1.0));
  const auto input = map.find("input8");
  ASSERT_TRUE(input);
  EXPECT_EQ(map.registers[*input].table, RegisterTable::discrete);
  EXPECT_EQ(map.registers[*input].access, RegisterAccess::read_only);
}

TEST(RegisterMapFile, ReportsSettingsThatABitCannotHave) {
  const std::string device = "[device]\nname = \"a\"\nsource = \"b\"\n[[register]]\nname = \"r\"\naddress = 1\n";
  const auto what_of = [&](const std::string& lines) {
    const auto map = parse_register_map(device + lines, "map.toml");
    return map ? std::string() : map.error().front().text();
  };
  EXPECT_EQ(what_of("kind = \"coil\"\nwhat = \"level\"\n"), "");
  EXPECT_EQ(what_of("kind = \"discrete\"\nwhat = \"failure\"\n"), "");
  EXPECT_NE(what_of("kind = \"coil\"\nrange = [0, 1]\n").find("range has no effect: a coil is one bit"),
            std::string::npos);
  EXPECT_NE(what_of("kind = \"discrete\"\ntype = \"u32\"\n").find("type has no effect"), std::string::npos);
  EXPECT_NE(what_of("kind = \"discrete\"\naccess = \"write\"\n").find("a discrete input can only be read"),
            std::string::npos);
  EXPECT_NE(what_of("kind = \"discrete\"\nwhat = \"level\"\n").find("a level that cannot be written"),
            std::string::npos);
  EXPECT_NE(what_of("kind = \"input\"\nwhat = \"failure\"\n").find("a failure that is no bit"), std::string::npos);
  EXPECT_NE(what_of("kind = \"coil\"\nwhat = \"illuminance\"\n").find("an illuminance of one bit"), std::string::npos);
  EXPECT_NE(what_of("kind = \"coil\"\npower_on = 2\n").find("power_on 2 of one bit"), std::string::npos);
  // A coil and a register with the same address are different things.
  EXPECT_EQ(what_of("kind = \"coil\"\n[[register]]\nname = \"s\"\naddress = 1\n"), "");
  EXPECT_NE(what_of("kind = \"coil\"\n[[register]]\nname = \"s\"\naddress = 1\nkind = \"coil\"\n")
                .find("share coil register 1"),
            std::string::npos);
}

TEST(RegisterMapFile, DescribesHowToArmTheCouplersWatchdog) {
  const RegisterMap map = map_named("wago-750-559.toml");
  ASSERT_EQ(map.setup.size(), 4u);
  EXPECT_EQ(map.registers[map.setup[0].index].address, 0x1008);
  EXPECT_EQ(map.setup[0].value_raw, 0xAA55);
  EXPECT_EQ(map.setup[1].value_raw, 20);
  EXPECT_EQ(map.stops_after, from_seconds(2));
  EXPECT_EQ(told_when_data_stops(map), "goes dark after 2 s by its watchdog, which is armed");
}

TEST(RegisterMapFile, DescribesTheLuxmetersTwoRegisters) {
  const RegisterMap map = map_named("dfrobot-sen0644.toml");
  const auto readings = map.with_role(RegisterRole::illuminance);
  ASSERT_EQ(readings.size(), 1u);
  const MappedRegister& reg = map.registers[readings[0]];
  EXPECT_EQ(reg.address, 2);
  EXPECT_EQ(reg.format.registers, 2);
  EXPECT_EQ(reg.scale, 0.001);
  EXPECT_EQ(map.largest_write, 1);
  EXPECT_EQ(map.baud_rates.size(), 7u);
}

const std::string kHead = "[device]\nname = \"a\"\nsource = \"b\"\n";  // three lines

TEST(RegisterMapFile, RefusesInvalidMaps) {
  const std::vector<std::pair<std::string, std::string>> bad = {
      {"", "map.toml:1:1: there is no [device]"},
      {"[device]\nname = \"a\"\n", "map.toml:1:1: [device] has no \"source\""},
      {kHead + "[[registre]]\n", "map.toml:4:3: unknown section \"registre\""},
      {kHead + "largest_read = 126\n", "map.toml:4:16: largest_read is 126, which is out of range"},
      {kHead + "baud_rates = [9600, \"fast\"]\n", "map.toml:4:21: baud_rates must hold whole numbers"},
      {kHead + "when_data_stops = \"dark\"\n", "map.toml:1:1: [device] has no \"stops_after_s\""},
      {kHead + "stops_after_s = 2\n", "map.toml:4:1: stops_after_s has no effect"},
      {kHead + "when_data_stops = \"watchdog\"\nstops_after_s = 2\n", "map.toml:4:19: nothing arms the watchdog"},
      {kHead + "[[register]]\nname = \"x\"\n", "map.toml:4:1: [[register]] has no \"address\""},
      {kHead + "[[register]]\nname = \"x\"\naddress = 0\nwhat = \"level\"\n",
       "map.toml:4:1: [[register]] has no \"range\""},
      {kHead + "[[register]]\nname = \"x\"\naddress = 0\nwhat = \"level\"\nkind = \"input\"\nrange = [0, 1]\n",
       "map.toml:7:8: a level that cannot be written"},
      {kHead + "[[register]]\nname = \"x\"\naddress = 0\nkind = \"input\"\naccess = \"write\"\n",
       "map.toml:8:10: an input register can only be read"},
      {kHead + "[[register]]\nname = \"x\"\naddress = 0\nrange = [0, 70000]\n",
       "map.toml:7:9: range 0 to 70000 does not fit its type"},
      {kHead + "[[register]]\nname = \"x\"\naddress = 0\nword_order = \"low-first\"\n",
       "map.toml:7:14: word_order has no effect"},
      {kHead + "[[register]]\nname = \"x\"\naddress = 65535\ntype = \"u32\"\n",
       "map.toml:6:11: its registers end past register 65535"},
      {kHead + "[[register]]\nname = \"x\"\naddress = 0\ntype = \"u32\"\ncount = 2\nstep = 1\n",
       "map.toml:9:8: step 1 is less than the registers of one"},
      {kHead + "[[register]]\nname = \"x\"\naddress = 0\n[[register]]\nname = \"x\"\naddress = 1\n",
       "map.toml:8:8: a second register is called \"x\""},
      {kHead + "[[register]]\nname = \"x\"\naddress = 0\ntype = \"u32\"\n[[register]]\nname = \"y\"\naddress = 1\n",
       "map.toml:8:1: \"y\" and \"x\" (line 4) share holding register 1"},
      {kHead + "[[register]]\nname = \"lux\"\naddress = 0\nwhat = \"illuminance\"\nunit = \"fc\"\n",
       "map.toml:8:8: an illuminance in \"fc\""},
      {kHead + "[[register]]\nname = \"time\"\naddress = 0\n[[setup]]\nregister = \"tine\"\nvalue = 1\n",
       "map.toml:8:12: there is no register \"tine\": did you mean \"time\"?"},
      {kHead + "[[register]]\nname = \"x\"\naddress = 0\naccess = \"read\"\n[[setup]]\nregister = \"x\"\nvalue = 1\n",
       "map.toml:9:12: \"x\" cannot be written"},
      {kHead + "[[register]]\nname = \"x\"\naddress = 0\n[[setup]]\nregister = \"x\"\nvalue = 65536\n",
       "map.toml:9:9: \"x\" cannot hold 65536"},
  };
  for (const auto& [text, expected] : bad) {
    const auto map = parse_register_map(text, "map.toml");
    ASSERT_FALSE(map) << text;
    EXPECT_TRUE(map.error().front().text().starts_with(expected))
        << text << "gave: " << map.error().front().text() << "\nnot:  " << expected;
  }
}

/// All of a map except places, as text.
std::string dump_of(const RegisterMap& map) {
  std::string out;
  const auto add = [&](const auto&... values) { ((out += fmt::format("{} ", values)), ...), out += '\n'; };
  add(map.name, map.source, fmt::format("{}", fmt::join(map.assumed, ",")),
      map.answer_time.value_or(Duration{}).count(), map.shortest_gap.count(), map.largest_read, map.largest_write,
      fmt::format("{}", fmt::join(map.baud_rates, ",")), static_cast<int>(map.when_data_stops),
      map.stops_after.value_or(Duration{}).count());
  for (const MappedRegister& reg : map.registers) {
    add(reg.name, static_cast<int>(reg.role), reg.address, static_cast<int>(reg.table), reg.format.registers,
        static_cast<int>(reg.format.number), reg.format.low_word_first, reg.format.low_byte_first, reg.scale, reg.unit,
        static_cast<int>(reg.access), reg.range_raw ? reg.range_raw->first : -1,
        reg.range_raw ? reg.range_raw->second : -1, reg.power_on_raw);
  }
  for (const SetupWrite& write : map.setup) add(write.index, write.value_raw);
  return out;
}

TEST(RegisterMapFile, ChangingAnyKeyChangesTheMap) {
  const auto sink = kitchen_sink::lines(kitchen_sink::kRegisterMap, SectionSpec::File::register_map);
  const auto text_with = [&](std::size_t changed) {
    std::string text;
    for (std::size_t i = 0; i < sink.size(); ++i)
      text += (i == changed ? sink[i].key + " = " + sink[i].other : sink[i].text) + "\n";
    return text;
  };
  const auto before = parse_register_map(text_with(sink.size()), "map.toml");
  ASSERT_TRUE(before) << before.error().front().text();
  std::set<std::pair<std::string, std::string>> tried;
  for (std::size_t i = 0; i < sink.size(); ++i) {
    if (sink[i].other.empty()) continue;
    const auto after = parse_register_map(text_with(i), "map.toml");
    ASSERT_TRUE(after) << sink[i].key << ": " << after.error().front().text();
    EXPECT_NE(dump_of(*after), dump_of(*before)) << sink[i].key << " changes nothing";
    tried.emplace(sink[i].section, sink[i].key);
  }
  for (const KeySpec& key : keys()) {
    if (section_spec(key.section).file != SectionSpec::File::register_map) continue;
    EXPECT_TRUE(tried.contains({std::string(key.section), std::string(key.key)})) << key.section << " " << key.key;
  }
}

TEST(RegisterMapFile, AndRigFileAreNotInterchangeable) {
  const auto map = parse_register_map(kHead + "[[fixture]]\n", "map.toml");
  ASSERT_FALSE(map);
  EXPECT_NE(map.error()[0].what.find("unknown section \"fixture\" in a register map"), std::string::npos);
}

}  // namespace
}  // namespace luxrig
