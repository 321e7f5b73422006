// All keys, in the order of REFERENCE.md.
#include <vector>

#include "core/rig/schema/key_tables.h"

namespace luxrig {

std::span<const KeySpec> keys() {
  static const std::vector<KeySpec> all = [] {
    std::vector<KeySpec> joined;
    for (const std::span<const KeySpec> part :
         {schema::room_keys(), schema::fixture_keys(), schema::task_keys(), schema::control_keys(),
          schema::register_map_keys(), schema::scenario_keys()}) {
      joined.insert(joined.end(), part.begin(), part.end());
    }
    return joined;
  }();
  return all;
}

}  // namespace luxrig
