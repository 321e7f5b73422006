// Any bytes as a register map: never a crash; a map that keeps its promises, or problems that can be shown to a person.
#include <cmath>
#include <cstdint>
#include <set>

#include "core/check.h"
#include "core/rig/register_map/register_map_file.h"
#include "core/rig/register_map/register_value.h"
#include "core/text/plain_text.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto map = luxrig::parse_register_map(text, "map.toml");
  if (!map) {
    LUXRIG_CHECK(!map.error().empty(), "refused without a problem");
    for (const luxrig::Problem& problem : map.error()) {
      LUXRIG_CHECK(!problem.what.empty() && !problem.mend.empty(), "{}", problem.text());
      LUXRIG_CHECK(luxrig::is_plain_text(problem.text()), "{}", problem.text());
    }
    return 0;
  }
  LUXRIG_CHECK(!map->name.empty() && !map->source.empty(), "a map without a name or source");
  LUXRIG_CHECK(map->stops_after.has_value() == (map->when_data_stops != luxrig::DataLoss::hold), "{}", map->name);
  std::set<std::pair<luxrig::RegisterTable, int>> taken;
  for (const luxrig::MappedRegister& reg : map->registers) {
    LUXRIG_CHECK(reg.address >= 0 && reg.address + reg.format.registers <= 65536, "{}", reg.address);
    for (int word = 0; word < reg.format.registers; ++word) {
      LUXRIG_CHECK(taken.emplace(reg.table, reg.address + word).second, "{} is shared", reg.address + word);
    }
    const auto [least, most] = luxrig::register_limits(reg.format);
    if (reg.range_raw) LUXRIG_CHECK(reg.range_raw->first >= least && reg.range_raw->second <= most, "{}", reg.name);
    if (reg.role == luxrig::RegisterRole::level) {
      LUXRIG_CHECK(reg.range_raw && reg.access != luxrig::RegisterAccess::read_only, "{}", reg.name);
    }
    if (luxrig::is_bit(reg.table))
      LUXRIG_CHECK(reg.format.registers == 1 && reg.range_raw == std::pair(0.0, 1.0), "{}", reg.name);
    LUXRIG_CHECK(reg.role != luxrig::RegisterRole::failure || luxrig::is_bit(reg.table), "{}", reg.name);
    const luxrig::RegisterWords words = luxrig::words_of(reg.power_on_raw, reg.format);
    LUXRIG_CHECK(std::abs(luxrig::value_of(std::span(words.word).first(words.count), reg.format) - reg.power_on_raw) <=
                     (reg.format.number == luxrig::RegisterNumber::floating ? 256 : 0),
                 "{}", reg.name);
  }
  for (const luxrig::SetupWrite& write : map->setup) {
    LUXRIG_CHECK(write.index < map->registers.size(), "{}", write.index);
  }
  return 0;
}
