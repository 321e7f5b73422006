#pragma once
/// A rig of two fixtures, and plans for it.

#include "core/plan/plan.h"

namespace luxrig {

inline Checked<std::vector<double>> levels_for(const Plan& plan, const Rig& rig, const std::string& file_name) {
  auto look = look_for(plan, rig, file_name);
  if (!look) return tl::unexpected(look.error());
  return std::move(look->levels);
}

inline Rig two_fixture_rig() {
  Rig rig;
  rig.name = "room";
  rig.fixtures.resize(2);
  rig.fixtures[0].name = "left";
  rig.fixtures[1].name = "right";
  rig.fixtures[1].max_level = 0.9;
  return rig;
}

inline PlannedLight light(const std::string& name, double level) {
  PlannedLight made;
  made.name = name;
  made.level = level;
  return made;
}

inline Plan plan_for_two(double left, double right) {
  Plan plan;
  plan.rig = "room";
  plan.tasks = {{.name = "levels", .kind = "emittance", .lights = {light("left", left), light("right", right)}}};
  return plan;
}

}  // namespace luxrig
