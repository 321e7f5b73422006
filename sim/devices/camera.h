#pragma once
/// A camera that looks at the simulated world: what is truly lit, through a sensor with its noise.

#include <vector>

#include "core/picture/picture.h"
#include "core/rig/rig.h"
#include "core/scene/ray_scene.h"
#include "sim/world/world.h"

namespace luxrig::sim {

/// Exposed so that the brightest hundredth of the picture comes near full; each sample then has the noise of its
/// electrons and of the read-out, and as many steps as the converter has.
/// Source: EMVA 1288 (linear model of a sensor).
struct Sensor {
  double full_well_electrons = 20000, read_noise_electrons = 5;
  int bits = 12;
};

/// What the fixtures truly do at one instant.
struct LightNow {
  std::vector<double> levels;  ///< true output over rated (World::levels)
  std::vector<Joints> joints;  ///< World::joints
};

struct Shot {
  int passes = 24;  ///< samples per pixel
  int threads = 0;
  std::uint64_t seed = 1;
  std::uint64_t number = 0;  ///< of the shot: its noise is its own
};

/// scene     of the rig; truths: World::fixtures
/// Calibrated: samples are in cd/m² again, what was clipped or lost in noise is gone. illuminance_lx stays empty.
[[nodiscard]] Result<Picture> photograph(const RayScene& scene, const Rig& rig, const std::vector<FixtureTruth>& truths,
                                         const LightNow& light, const PictureCamera& camera, const Sensor& sensor,
                                         const Shot& shot);

}  // namespace luxrig::sim
