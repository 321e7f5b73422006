#include "core/rig/register_map/register_map.h"

#include <fmt/format.h>

namespace luxrig {

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
