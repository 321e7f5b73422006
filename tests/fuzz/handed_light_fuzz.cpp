// Any bytes as the light that a guardian hands over: never a throw; accepted light is whole, within its bounds, has as
// many fixtures as the rig, and is written and read back the same.
#include <cstdint>
#include <string>

#include "core/check.h"
#include "tools/luxrigd/guardian/handed_light.h"

namespace {

void check_levels(const std::vector<double>& levels, std::size_t fixtures) {
  LUXRIG_CHECK(levels.size() == fixtures, "{} levels for {} fixtures", levels.size(), fixtures);
  for (const double level : levels) LUXRIG_CHECK(level >= 0 && level <= 1, "level {}", level);
}

void check_light(const luxrig::LightInForce& light, std::size_t fixtures) {
  check_levels(light.look.levels, fixtures);
  check_levels(light.safe_levels, fixtures);
  LUXRIG_CHECK(light.look.joints.size() == fixtures, "{} joints for {} fixtures", light.look.joints.size(), fixtures);
  for (const luxrig::Joints& joints : light.look.joints) {
    for (const double angle_rad : {joints.pan_rad, joints.tilt_rad, joints.beam_rad})
      LUXRIG_CHECK(angle_rad >= -1e3 && angle_rad <= 1e3, "angle {}", angle_rad);
  }
  LUXRIG_CHECK(light.silent.empty() || light.silent.size() == fixtures, "{} silent of {}", light.silent.size(),
               fixtures);
  for (const std::uint8_t silent : light.silent) LUXRIG_CHECK(silent <= 1, "silent {}", silent);
  // From here on the daemon counts both in nanoseconds.
  for (const double time_s : {light.hold_s, light.fade_s})
    LUXRIG_CHECK(time_s >= 0 && time_s <= 1e6, "a time of {} s", time_s);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  int taken = 0;
  for (std::size_t fixtures = 0; fixtures <= 3; ++fixtures) {
    const auto light = luxrig::handed_light_of(text, fixtures);
    if (!light) continue;
    ++taken;
    check_light(*light, fixtures);
    const std::string written = luxrig::handed_light_text(*light);
    const auto again = luxrig::handed_light_of(written, fixtures);
    LUXRIG_CHECK(again.has_value(), "own text refused: {}", written);
    LUXRIG_CHECK(luxrig::handed_light_text(*again) == written, "not the same when written again: {}", written);
  }
  LUXRIG_CHECK(taken <= 1, "the light of rigs of {} sizes at once", taken);
  return 0;
}
