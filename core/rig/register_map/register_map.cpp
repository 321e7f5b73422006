#include "core/rig/register_map/register_map.h"

#include <fmt/format.h>

namespace luxrig {

const char* name_of(RegisterTable table) {
  switch (table) {
    case RegisterTable::holding:
      return "holding";
    case RegisterTable::input:
      return "input";
    case RegisterTable::coil:
      return "coil";
    case RegisterTable::discrete:
      return "discrete";
  }
  return "unknown";
}

bool RegisterMap::concerns(std::size_t failure, std::size_t level) const {
  const int bit = registers[failure].of_several;
  if (bit == 0 || bit == registers[level].of_several) return true;
  for (const std::size_t other : with_role(RegisterRole::level)) {
    if (registers[other].of_several > 0) return false;
  }
  return true;
}

std::vector<std::size_t> RegisterMap::with_role(RegisterRole role) const {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < registers.size(); ++i) {
    if (registers[i].role == role) found.push_back(i);
  }
  return found;
}

std::optional<std::size_t> RegisterMap::find(std::string_view register_name) const {
  for (std::size_t i = 0; i < registers.size(); ++i) {
    if (registers[i].name == register_name) return i;
  }
  return std::nullopt;
}

std::string told_when_data_stops(const RegisterMap& map) {
  if (map.when_data_stops == DataLoss::hold || !map.stops_after) return "holds its last level for ever";
  return fmt::format("goes dark after {:g} s by {}", to_seconds(*map.stops_after),
                     map.when_data_stops == DataLoss::dark ? "itself" : "its watchdog, which is armed");
}

}  // namespace luxrig
