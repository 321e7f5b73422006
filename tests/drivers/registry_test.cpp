#include "drivers/registry.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "drivers/options.h"
#include "tests/drivers/test_rig.h"

namespace luxrig {
namespace {

TEST(Registry, FindsEachDriverByItsNameOnce) {
  std::set<std::string_view> names;
  for (const DriverEntry& entry : drivers()) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    EXPECT_EQ(find_driver(entry.name), &entry);
    EXPECT_FALSE(entry.summary.empty());
    EXPECT_FALSE(entry.options.empty());
  }
  EXPECT_EQ(find_driver("telepathy"), nullptr);
}

TEST(Registry, NamesTheNearestDriverToAnUnknownOne) {
  const Rig rig = rig_with(bus_of("scan"));
  const auto problems = check_buses(rig);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].text(),
            "a/rig.toml:7:1: bus \"the-bus\" has an unknown driver \"scan\": did you mean \"sacn\"?");
}

TEST(Registry, ReportsTheProblemsOfEveryBus) {
  Rig rig = rig_with(bus_of("sacn", {{"ttl", std::int64_t{0}}}));
  rig.buses.push_back(bus_of("modbus_tcp"));
  EXPECT_EQ(check_buses(rig).size(), 2u);
}

TEST(Registry, EveryDefaultOptionIsValid) {
  for (const DriverEntry& entry : drivers()) {
    Bus bus = bus_of(std::string(entry.name));
    for (const OptionDoc& doc : entry.options) {
      EXPECT_FALSE(doc.summary.empty()) << doc.key;
      if (doc.fallback == "required") {
        bus.options[std::string(doc.key)] = {required_value(doc), {}};
      } else if (doc.type == "whole number") {
        bus.options[std::string(doc.key)] = {integer_option(bus, entry.options, doc.key), {}};
      } else if (doc.type == "true or false") {
        bus.options[std::string(doc.key)] = {boolean_option(bus, entry.options, doc.key), {}};
      } else {
        bus.options[std::string(doc.key)] = {string_option(bus, entry.options, doc.key), {}};
      }
    }
    const Rig rig = rig_with(bus);
    for (const Problem& problem : entry.check(rig, 0)) ADD_FAILURE() << problem.text();
  }
}

}  // namespace
}  // namespace luxrig
