#include <fmt/format.h>

#include <algorithm>

#include "drivers/can/canopen_driver.h"
#include "drivers/options.h"

namespace luxrig {
namespace {

constexpr OptionDoc kCanopenOptions[] = {
    {"interface", "text", "", "required", "1 to 15 characters", "the CAN interface of the system, \"can0\""},
    {"cycle_ms", "whole number", "ms", "20", "5 to 100",
     "time between two SYNC messages; every axis is heard and told once in it"},
    {"heartbeat_ms", "whole number", "ms", "100", "20 to 1000",
     "how often the nodes and Luxrig say that they live; each acts when three are missing"},
    {"master_node", "whole number", "", "127", "1 to 127", "node number that Luxrig has itself; no drive's"},
    {"home", "text", "", "\"at start\"", "at start, when needed or never",
     "when an axis that does not know its position looks for its home: as soon as it can, also after every loss of "
     "power; before the first aim only; or never, for drives that know it by themselves"},
    {"homing_method", "whole number", "", "17", "-128 to 37",
     "as CiA 402 numbers them, that the drives have: 1 and 2 limit switch and index, 17 and 18 limit switch, 33 and 34 "
     "index, 35 and 37 where it stands; below 0 a maker's own"},
    {"homing_speed_percent", "whole number", "%", "10", "1 to 100", "of the axis's speed, on the way to its home"},
    {"homing_timeout_s", "whole number", "s", "60", "1 to 600", "after which homing has failed"},
    {"on_stop", "text", "", "\"hold\"", "hold or release",
     "what an axis does when Luxrig stops or dies, after it has slowed down: hold its place under current, or switch "
     "off (the brake falls in, where it has one)"},
    {"fault_resets", "whole number", "", "3", "0 to 100",
     "faults of an axis in a row that are reset; after one more a person must see to it"},
};

template <std::size_t N>
void check_choice(const Rig& rig, const Bus& bus, std::string_view key, const char* const (&choices)[N],
                  std::vector<Problem>& problems) {
  const std::string value = string_option(bus, kCanopenOptions, key);
  if (std::find(std::begin(choices), std::end(choices), value) != std::end(choices)) return;
  std::string known;
  for (const char* choice : choices) known += fmt::format("{}\"{}\"", known.empty() ? "" : ", ", choice);
  problems.push_back(
      problem_at(rig, bus, key, fmt::format("{} = \"{}\" is none of its values", key, value), "use one of " + known));
}

}  // namespace

std::span<const OptionDoc> canopen_options() { return kCanopenOptions; }

std::vector<Problem> check_canopen(const Rig& rig, std::size_t bus) {
  const Bus& entry = rig.buses[bus];
  std::vector<Problem> problems = check_options(rig, entry, kCanopenOptions);
  const auto report = [&](const FilePosition& in_file, std::string what, std::string mend) {
    problems.push_back({rig.file.string(), in_file.line, in_file.column, std::move(what), std::move(mend)});
  };
  int master = 0;
  if (problems.empty()) {
    check_choice(rig, entry, "home", {"at start", "when needed", "never"}, problems);
    check_choice(rig, entry, "on_stop", {"hold", "release"}, problems);
    master = static_cast<int>(integer_option(entry, kCanopenOptions, "master_node"));
    const std::string interface_name = string_option(entry, kCanopenOptions, "interface");
    if (interface_name.empty() || interface_name.size() > 15 ||
        interface_name.find_first_of("/ \t") != std::string::npos) {
      problems.push_back(problem_at(rig, entry, "interface",
                                    fmt::format("\"{}\" cannot be the name of an interface", interface_name),
                                    "write it as `ip link` shows it, such as \"can0\""));
    }
  }
  for (const Fixture& fixture : rig.fixtures) {
    if (fixture.bus == bus) {
      report(fixture.in_file,
             fmt::format("fixture \"{}\" has its dimmer on the bus \"{}\", which only turns heads", fixture.name,
                         entry.name),
             "give it a DMX or Modbus bus, and name this one as its axes_bus");
    }
    if (!fixture.axes || fixture.axes->bus != bus) continue;
    for (const AxisPatch& axis : {fixture.axes->pan, fixture.axes->tilt}) {
      if (axis.node < 1 || axis.node > 127 || axis.node == master) {
        report(fixture.in_file,
               axis.node == master ? fmt::format("fixture \"{}\": node {} is Luxrig's own", fixture.name, axis.node)
                                   : fmt::format("fixture \"{}\": there is no node {}", fixture.name, axis.node),
               axis.node == master ? "give the drive another node number, or the bus another master_node"
                                   : "choose a node in 1…127");
      }
      const double travel = std::max(std::abs(axis.counts_at(fixture.sent_range().pan_max_rad)),
                                     std::abs(axis.counts_at(fixture.sent_range().pan_min_rad)));
      if (!(travel < 2e9)) {
        report(fixture.in_file,
               fmt::format("fixture \"{}\": its travel is {:.3g} counts, more than a position of 32 bit holds",
                           fixture.name, travel),
               "correct counts_per_degree, or set the drive to a coarser unit");
      }
    }
  }
  for (const Luxmeter& meter : rig.luxmeters) {
    if (meter.bus != bus) continue;
    report(meter.in_file,
           fmt::format("luxmeter \"{}\" is on the bus \"{}\", which only turns heads", meter.name, entry.name),
           "put it on a bus with driver = \"modbus_tcp\"");
  }
  return problems;
}

}  // namespace luxrig
