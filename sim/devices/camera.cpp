#include "sim/devices/camera.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/tasks/rig_transport.h"
#include "sim/world/random.h"

namespace luxrig::sim {
namespace {

constexpr double kBrightestShare = 0.01, kExposedTo = 0.8;

/// The luminance that fills a pixel: the brightest hundredth of all samples reaches four fifths of it.
double full_cd_m2(const Picture& picture) {
  std::vector<float> brightest;
  for (const Vec3f& pixel : picture.luminance_cd_m2) brightest.push_back(pixel.maxCoeff());
  const auto at = static_cast<std::ptrdiff_t>((1 - kBrightestShare) * static_cast<double>(brightest.size() - 1));
  std::nth_element(brightest.begin(), brightest.begin() + at, brightest.end());
  return brightest[static_cast<std::size_t>(at)] / kExposedTo;
}

}  // namespace

Result<Picture> light_on_sensor(const RayScene& scene, const Rig& rig, const std::vector<FixtureTruth>& truths,
                                const LightNow& light, const CameraTruth& camera, const Shot& shot) {
  const auto seen_as = [&](std::size_t luminaire) { return camera.response.empty() ? 1 : camera.response[luminaire]; };
  std::vector<Emitter> emitters;
  std::vector<double> levels;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    if (!(light.levels[f] > 0)) continue;
    const Fixture& fixture = rig.fixtures[f];
    emitters.push_back(emitter_of(rig.luminaires[fixture.luminaire],
                                  true_lamp(truths[f], light.joints[f], fixture.roll_rad), light.joints[f].beam_rad));
    levels.push_back(light.levels[f] * seen_as(fixture.luminaire));
  }
  for (Emitter& day : daylight_emitters_of(rig)) {
    emitters.push_back(std::move(day));
    levels.push_back(seen_as(rig.luminaires.size()));
  }
  PictureOptions how;
  how.max_passes = shot.passes;
  how.wanted_relative_error = 0;
  how.seed = shot.seed;
  how.threads = shot.threads;
  auto seen = render_picture(scene, emitters, levels, camera.view, how);
  if (!seen) return seen;
  seen->illuminance_lx.clear();
  through_lens(camera, *seen);
  return seen;
}

Picture exposed(Picture on_sensor, const Sensor& sensor, const Shot& shot) {
  const double full = full_cd_m2(on_sensor) * shot.underexposed;
  if (!(full > 0)) return on_sensor;  // a dark room
  const double steps = std::exp2(sensor.bits) - 1;
  std::uint64_t sample = shot.number << 32;
  for (Vec3f& pixel : on_sensor.luminance_cd_m2)
    for (float& value : pixel) {
      const double electrons = std::min(static_cast<double>(value) / full, 1.0) * sensor.full_well_electrons;
      const double noise = std::sqrt(electrons + sensor.read_noise_electrons * sensor.read_noise_electrons) *
                           random_normal(shot.seed, Draw::picture_noise, 0, sample++);
      const double share = std::clamp((electrons + noise) / sensor.full_well_electrons, 0.0, 1.0);
      value = static_cast<float>(std::round(share * steps) / steps * full);
    }
  return on_sensor;
}

Result<Picture> photograph(const RayScene& scene, const Rig& rig, const std::vector<FixtureTruth>& truths,
                           const LightNow& light, const CameraTruth& camera, const Sensor& sensor, const Shot& shot) {
  auto seen = light_on_sensor(scene, rig, truths, light, camera, shot);
  if (!seen) return seen;
  return exposed(std::move(*seen), sensor, shot);
}

}  // namespace luxrig::sim
