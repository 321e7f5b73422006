// Any bytes as a plan: never a throw, and an accepted plan is written and read back the same.
#include <cstdint>
#include <string>

#include "core/check.h"
#include "core/plan/plan.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto plan = luxrig::plan_from_json(std::string(reinterpret_cast<const char*>(data), size), "fuzz.json");
  if (!plan) {
    LUXRIG_CHECK(!plan.error().empty(), "refused without a problem");
    for (const luxrig::Problem& problem : plan.error()) {
      LUXRIG_CHECK(!problem.what.empty() && !problem.mend.empty(), "a problem without text");
    }
    return 0;
  }
  const std::string written = luxrig::to_json(*plan);
  const auto again = luxrig::plan_from_json(written, "again.json");
  LUXRIG_CHECK(again.has_value(), "own output refused: {}", again.error()[0].text());
  LUXRIG_CHECK(luxrig::to_json(*again) == written, "not the same when written again");

  luxrig::Rig rig;
  rig.name = plan->rig;
  for (const luxrig::PlannedTask& task : plan->tasks) {
    for (const luxrig::PlannedLight& light : task.lights) {
      rig.fixtures.emplace_back();
      rig.fixtures.back().name = light.name;
      rig.fixtures.back().moves = true;
    }
  }
  if (const auto look = luxrig::look_for(*plan, rig, "fuzz.json")) {
    for (const double level : look->levels) LUXRIG_CHECK(level >= 0 && level <= 1, "level {}", level);
    const luxrig::JointRange range;
    for (const luxrig::Joints& joints : look->joints) {
      LUXRIG_CHECK(joints.pan_rad >= range.pan_min_rad && joints.pan_rad <= range.pan_max_rad, "{}", joints.pan_rad);
      LUXRIG_CHECK(joints.tilt_rad >= range.tilt_min_rad && joints.tilt_rad <= range.tilt_max_rad, "{}",
                   joints.tilt_rad);
    }
  }
  return 0;
}
