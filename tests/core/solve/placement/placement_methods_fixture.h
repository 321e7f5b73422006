#pragma once
/// Shared by the tests of placement_methods.

#include <string>

#include "core/solve/placement/methods/placement_method.h"
#include "tests/core/solve/placement/lit_hall.h"

namespace luxrig::placement_methods_fixture {

inline constexpr double kHallLattice_m = 0.4;

inline PlacementProblem problem_of(const LitHall& hall, const LightingGoal& goal) {
  return {hall.light.get(), &goal, hall.view(), hall.poses, kHallLattice_m};
}

inline PlacementOptions options_of(const PlacementMethod& method, std::size_t lights) {
  PlacementOptions options;
  options.lights = method.takes_number ? lights : 0;
  options.max_lights = 8;
  options.max_columns = 20'000;
  if (std::string(method.name) == "annealing") options.iterations = 20'000;
  return options;
}

}  // namespace luxrig::placement_methods_fixture
