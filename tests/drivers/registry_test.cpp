#include "drivers/registry.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <string>

#include "drivers/options.h"
#include "tests/drivers/test_rig.h"
#include "tests/folders.h"

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

TEST(Registry, EveryDefaultOfAnOptionIsGoodItself) {
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

/// The rows of the options table under `### driver = "name"` in the rig-file reference.
std::vector<std::string> reference_rows(std::string_view name) {
  std::ifstream in(test::source_folder() / "rigs/REFERENCE.md");
  const std::string heading = "### driver = \"" + std::string(name) + "\"";
  std::vector<std::string> rows;
  bool inside = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("#")) inside = line == heading;
    if (inside && line.starts_with("| `")) rows.push_back(line);
  }
  return rows;
}

TEST(Registry, IsDocumentedOptionByOptionInTheReference) {
  for (const DriverEntry& entry : drivers()) {
    std::vector<std::string> wanted;
    for (const OptionDoc& doc : entry.options) {
      const std::string fallback = doc.fallback == "required" ? "required" : "`" + std::string(doc.fallback) + "`";
      wanted.push_back("| `" + std::string(doc.key) + "` | " + std::string(doc.type) + " | " + std::string(doc.unit) +
                       " | " + fallback + " | " + std::string(doc.range) + " | " + std::string(doc.summary) + " |");
    }
    EXPECT_EQ(reference_rows(entry.name), wanted) << "rigs/REFERENCE.md, ### driver = \"" << entry.name << "\"";
  }
}

}  // namespace
}  // namespace luxrig
