#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/rig/null_bus.h"
#include "core/rig/reading/rig_reader.h"

namespace luxrig {
namespace {

/// A driver's own option, as written; nullopt and a problem if no driver could use it.
std::optional<Option> option_from(const Member& member, ProblemList& problems) {
  const Node& node = member.node;
  const auto refuse = [&](std::string what, std::string mend) {
    problems.add(node.in_file, std::move(what), std::move(mend));
    return std::nullopt;
  };
  if (const auto* yes_no = std::get_if<bool>(&node.value)) return Option{*yes_no, node.in_file};
  if (const auto* whole = std::get_if<std::int64_t>(&node.value)) return Option{*whole, node.in_file};
  if (const auto* number = std::get_if<double>(&node.value)) {
    if (std::isfinite(*number)) return Option{*number, node.in_file};
    return refuse(fmt::format("{} is not a finite number", in_quotes(member.key)), "write a finite number");
  }
  if (const auto* text = std::get_if<std::string>(&node.value)) {
    if (is_plain_text(*text)) return Option{*text, node.in_file};
    return refuse(fmt::format("{} has a control character", in_quotes(member.key)), "use printable characters only");
  }
  return refuse(fmt::format("{} is {}", in_quotes(member.key), kind_of(node)),
                "an option of a bus is a number, text in quotes, or true or false");
}

}  // namespace

void RigReader::read_buses() {
  const std::span<const KeySpec> known = keys_of("bus");
  each(root, "bus", [&](Section& s) {
    Bus bus;
    bus.in_file = s.in_file();
    if (s.read("name", bus.name)) buses.add(bus.name, rig.buses.size(), s.place_of("name"), problems);
    s.read("driver", bus.driver);
    if (s.read("safe_level", bus.safe_level) && *bus.safe_level > rig.limits.max_level) {
      problems.add(
          s.place_of("safe_level"),
          fmt::format("safe_level {} is above max_level {} of [limits]", *bus.safe_level, rig.limits.max_level),
          "lower it, or raise that limit");
    }
    for (const Member& member : s.table()) {
      if (std::any_of(known.begin(), known.end(), [&](const KeySpec& key) { return key.key == member.key; })) continue;
      if (auto option = option_from(member, problems)) bus.options.emplace(member.key, std::move(*option));
    }
    rig.buses.push_back(std::move(bus));
  });
}

void RigReader::read_luxmeters() {
  NameIndex luxmeters("luxmeter");
  each(root, "luxmeter", [&](Section& s) {
    Luxmeter meter;
    meter.in_file = s.in_file();
    if (s.read("name", meter.name)) luxmeters.add(meter.name, rig.luxmeters.size(), s.place_of("name"), problems);

    if (s.has("point") == s.has("position_m")) {
      problems.add(s.in_file(),
                   fmt::format("[[luxmeter]] has {}",
                               s.has("point") ? "both a point and a position_m" : "neither a point nor a position_m"),
                   "say where it stands by one of the two");
    } else if (s.has("point")) {
      s.refuse("normal", "normal has no effect: the meter takes that of its point", "remove it, or use position_m");
      if ((meter.point = points.read_reference(s, "point"))) {
        meter.position_world_m = rig.points[*meter.point].position_world_m;
        meter.normal_world = rig.points[*meter.point].normal_world;
      }
    } else {
      s.read("position_m", meter.position_world_m);
      s.read_normal("normal", meter.normal_world);
    }
    s.read("tolerance", meter.tolerance);
    s.read("range_lx", meter.range_lx);

    const bool good = read_modbus_meter(s, meter);
    if (const auto bus = buses.read_reference(s, "bus")) {
      meter.bus = *bus;
      if (good && !is_null_bus(rig.buses[*bus])) {
        const ModbusMeterPatch& patch = meter.patch;
        const FilePosition in_file = s.place_of(s.has("register")       ? "register"
                                                : s.has("register_map") ? "register_map"
                                                : s.has("unit")         ? "unit"
                                                                        : "name");
        patches.claim_registers(*bus, patch.unit, patch.input_registers ? RegisterTable::input : RegisterTable::holding,
                                patch.first_register, patch.registers, {"luxmeter " + in_quotes(meter.name), in_file});
      }
    }
    rig.luxmeters.push_back(std::move(meter));
  });
}

}  // namespace luxrig
