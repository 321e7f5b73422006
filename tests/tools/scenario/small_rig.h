#pragma once
/// A rig by values, for scenarios that are only read or judged: twelve lamps, 36 points, six luxmeters; two heads.

#include "tests/scenarios/hall.h"

namespace luxrig::scenario {

inline Rig small_rig() {
  Rig rig = scenarios::make_hall(1).rig;
  rig.file = "hall/rig.toml";
  for (const std::size_t head : {4U, 5U}) rig.fixtures[head].moves = true;
  return rig;
}

}  // namespace luxrig::scenario
