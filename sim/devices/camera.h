#pragma once
/// A camera in the simulated world: the true light, through its lens, on a noisy sensor.

#include <vector>

#include "core/picture/picture.h"
#include "core/rig/rig.h"
#include "core/scene/ray_scene.h"
#include "sim/devices/lens.h"
#include "sim/world/world.h"

namespace luxrig::sim {

/// Exposed so that the brightest hundredth of the picture is nearly full. Each sample has shot noise, read noise and
/// the converter's number of steps.
/// Source: EMVA 1288 (linear model of a sensor).
struct Sensor {
  double full_well_electrons = 20000, read_noise_electrons = 5;
  int bits = 12;
};

/// True state of the fixtures at one instant.
struct LightNow {
  std::vector<double> levels;  ///< true output over rated (World::levels)
  std::vector<Joints> joints;  ///< World::joints
};

struct Shot {
  int passes = 24;  ///< samples per pixel
  int threads = 0;
  std::uint64_t seed = 1;
  std::uint64_t number = 0;  ///< of the shot: each has its own noise
  double underexposed = 1;   ///< full scale is this many times what Sensor says: highlights are kept, shadows lost
};

/// scene   of the rig
/// truths  World::fixtures
/// The light on the sensor at one instant, as luminance: as the lens shows it, each lamp as this camera sees its kind.
/// illuminance_lx stays empty.
[[nodiscard]] Result<Picture> light_on_sensor(const RayScene& scene, const Rig& rig,
                                              const std::vector<FixtureTruth>& truths, const LightNow& light,
                                              const CameraTruth& camera, const Shot& shot);

/// That light as the sensor has it. Calibrated: samples are cd/m² again; clipped or noise-buried detail is lost.
[[nodiscard]] Picture exposed(Picture on_sensor, const Sensor& sensor, const Shot& shot);

/// Both.
[[nodiscard]] Result<Picture> photograph(const RayScene& scene, const Rig& rig, const std::vector<FixtureTruth>& truths,
                                         const LightNow& light, const CameraTruth& camera, const Sensor& sensor,
                                         const Shot& shot);

}  // namespace luxrig::sim
