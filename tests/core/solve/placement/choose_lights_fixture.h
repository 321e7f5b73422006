#pragma once
/// Shared by the tests of choose_lights.

#include "core/solve/placement/search/choose_lights.h"

namespace luxrig::choose_lights_fixture {

inline ChooseOptions choose_most(std::size_t lights) {
  ChooseOptions options;
  options.max_lights = lights;
  return options;
}

}  // namespace luxrig::choose_lights_fixture
