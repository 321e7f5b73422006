#include <fmt/format.h>

#include "core/rig/reading/rig_reader.h"
#include "core/rig/register_map/register_map_file.h"
#include "core/rig/register_map/register_value.h"
#include "core/text/nearest.h"

namespace luxrig {
namespace {

std::vector<std::string_view> names_in(const RegisterMap& map, const std::vector<std::size_t>& indices) {
  std::vector<std::string_view> names;
  for (const std::size_t i : indices) names.push_back(map.registers[i].name);
  return names;
}

/// The register in `of` that `key` names; without the key, the only one.
std::optional<std::size_t> named_register(Section& s, std::string_view key, std::string_view kind,
                                          const RegisterMap& map, const std::vector<std::size_t>& of) {
  std::string wanted;
  if (!s.has(key)) {
    if (of.size() == 1) return of.front();
    s.problems().add(s.place_of("register_map"),
                     fmt::format("{} has {} {}s, and none is chosen", in_quotes(map.name), of.size(), kind),
                     of.empty() ? std::string("use another register map")
                                : fmt::format("add {} = with the name of one, such as {}", key,
                                              in_quotes(map.registers[of.front()].name)));
    return std::nullopt;
  }
  if (!s.read(key, wanted)) return std::nullopt;
  for (const std::size_t i : of) {
    if (map.registers[i].name == wanted) return i;
  }
  s.problems().add(s.place_of(key), fmt::format("{} has no {} {}", in_quotes(map.name), kind, in_quotes(wanted)),
                   mend_for_unknown(wanted, names_in(map, of), "use another register map"));
  return std::nullopt;
}

std::optional<std::size_t> level_of(Section& s, const RegisterMap& map) {
  const std::vector<std::size_t> levels = map.with_role(RegisterRole::level);
  if (!s.has("channel")) return named_register(s, "output", "level", map, levels);
  s.refuse("output", "output has no effect beside channel", "keep one of the two");
  int channel = 1;
  if (!s.read("channel", channel)) return std::nullopt;
  if (static_cast<std::size_t>(channel) <= levels.size()) return levels[static_cast<std::size_t>(channel) - 1];
  s.problems().add(s.place_of("channel"),
                   fmt::format("{} has {} levels, and no channel {}", in_quotes(map.name), levels.size(), channel),
                   levels.empty() ? std::string("use another register map")
                                  : fmt::format("choose a channel in 1…{}", levels.size()));
  return std::nullopt;
}

void refuse_beside_map(Section& s, std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) {
    s.refuse(key, fmt::format("{} has no effect: the register map says it", key), "keep one of the two");
  }
}

void refuse_without_map(Section& s, std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) {
    s.refuse(key, fmt::format("{} has no effect without a register map", key),
             "add register_map, a file as in rigs/register-maps");
  }
}

}  // namespace

std::shared_ptr<const RegisterMap> RigReader::read_register_map(Section& s) {
  const auto path = read_file(s, "register_map");
  if (!path) return nullptr;
  const auto [at, is_new] = register_maps.try_emplace(path->string(), nullptr);
  if (is_new) {
    Checked<RegisterMap> map = load_register_map(*path);
    if (map) {
      at->second = std::make_shared<const RegisterMap>(std::move(*map));
    } else {
      problems.add(s.place_of("register_map"), fmt::format("{} cannot be used", in_quotes(path->filename().string())),
                   "mend what is listed for it, or use another file");
      for (const Problem& problem : map.error()) problems.add(problem);
    }
  }
  return at->second;
}

bool RigReader::read_modbus(Section& s, const std::optional<SlotOwner>& owner, Fixture& fixture) {
  ModbusPatch patch;
  if (owner && !owner->emitters.empty()) {
    s.problems().add(s.place_of(s.has("register_map") ? "register_map" : "register"),
                     fmt::format("luminaire {} has {} emitters, and a Modbus register holds one level",
                                 in_quotes(owner->luminaire), owner->emitters.size()),
                     fmt::format("make each emitter a [[fixture]] of its own, as luminaire = {}",
                                 in_quotes(owner->luminaire + "/" + owner->emitters.front())));
    return false;
  }
  bool good = s.read("unit", patch.unit) || !s.has("unit");
  if (s.has("register_map")) {
    refuse_beside_map(s, {"register", "full_scale"});
    patch.map = read_register_map(s);
    const auto level = patch.map ? level_of(s, *patch.map) : std::nullopt;
    if (level) {
      const MappedRegister& reg = patch.map->registers[*level];
      patch.holding_register = reg.address;
      patch.coil = reg.table == RegisterTable::coil;
      patch.format = reg.format;
      patch.dark_raw = static_cast<int>(reg.range_raw->first);
      patch.full_scale_raw = static_cast<int>(reg.range_raw->second);
    }
    good &= level.has_value();
  } else {
    refuse_without_map(s, {"channel", "output"});
    if (!s.has("register")) s.require("register", "which a Modbus dimmer needs");
    good &= s.read("register", patch.holding_register);
    s.read("full_scale", patch.full_scale_raw);
  }
  fixture.patch = patch;
  return good;
}

bool RigReader::read_modbus_meter(Section& s, Luxmeter& meter) {
  ModbusMeterPatch& patch = meter.patch;
  bool good = s.read("unit", patch.unit) || !s.has("unit");
  if (s.has("register_map")) {
    refuse_beside_map(s, {"register", "registers", "register_kind", "word_order", "lux_per_count"});
    patch.map = read_register_map(s);
    if (!patch.map) return false;
    const auto reading =
        named_register(s, "reading", "illuminance", *patch.map, patch.map->with_role(RegisterRole::illuminance));
    if (!reading) return false;
    const MappedRegister& reg = patch.map->registers[*reading];
    patch.input_registers = reg.table == RegisterTable::input;
    patch.first_register = reg.address;
    patch.registers = reg.format.registers;
    patch.number = reg.format.number;
    patch.low_word_first = reg.format.low_word_first;
    patch.low_byte_first = reg.format.low_byte_first;
    patch.lux_per_count = reg.scale;
    if (!s.has("range_lx") && reg.range_raw) meter.range_lx = reg.range_raw->second * reg.scale;
    return good;
  }
  refuse_without_map(s, {"reading"});
  good &= s.read("register", patch.first_register) || !s.has("register");
  good &= s.read("registers", patch.registers) || !s.has("registers");
  good &= s.read_choice("register_kind", patch.input_registers) || !s.has("register_kind");
  s.read_choice("word_order", patch.low_word_first);
  s.read("lux_per_count", patch.lux_per_count);
  if (good && patch.first_register + patch.registers > 65536) {
    problems.add(s.place_of("register"),
                 fmt::format("{} registers from {} end past register 65535", patch.registers, patch.first_register),
                 "use a lower register");
    good = false;
  }
  return good;
}

}  // namespace luxrig
