#include "tools/luxrig-sim/simulated_cameras.h"

#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <utility>

#include "core/picture/pfm.h"
#include "core/tasks/scene_builder.h"

namespace luxrig::sim {
namespace {

/// Lamps warm up, and their light moves by less than this while a bracket is taken.
constexpr double kSameLight = 1e-3, kSameAngle_rad = 1e-6;

bool same(const LightNow& a, const LightNow& b) {
  for (std::size_t f = 0; f < a.levels.size(); ++f) {
    const Joints &at = a.joints[f], &then = b.joints[f];
    if (std::abs(a.levels[f] - b.levels[f]) > kSameLight * b.levels[f] ||
        std::abs(at.pan_rad - then.pan_rad) > kSameAngle_rad ||
        std::abs(at.tilt_rad - then.tilt_rad) > kSameAngle_rad ||
        std::abs(at.beam_rad - then.beam_rad) > kSameAngle_rad)
      return false;
  }
  return true;
}

}  // namespace

Result<void> SimulatedCameras::trace_light(std::size_t camera, const Shot& shot) {
  if (!rays_) {
    const auto scene = build_scene(rig_);
    if (!scene) return refusal(scene.error().front().text());
    rays_ = std::make_unique<RayScene>(true_scene(*scene, rig_, deviations_));
  }
  LightNow light;
  {
    const std::lock_guard lock(world_mutex_);
    light = {world_.levels(), world_.joints()};
  }
  if (last_ && last_->camera == camera && same(last_->light, light)) return {};
  auto on_sensor = light_on_sensor(*rays_, rig_, world_.fixtures(), light,
                                   draw_camera(rig_, rig_.cameras[camera], camera, deviations_, rays_.get()), shot);
  if (!on_sensor) return tl::unexpected(on_sensor.error());
  last_ = Taken{camera, std::move(light), std::move(*on_sensor)};
  return {};
}

Result<std::string> SimulatedCameras::take(std::size_t camera, double underexposed, int passes) {
  const std::lock_guard one_at_a_time(mutex_);
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), 10);  // of this thread, and of threads that it starts
  Shot shot;
  shot.seed = deviations_.seed;
  shot.number = shots_++;
  shot.underexposed = underexposed;
  shot.passes = passes;
  if (auto traced = trace_light(camera, shot); !traced) return tl::unexpected(traced.error());
  return to_pfm(exposed(last_->on_sensor, Sensor{}, shot));
}

}  // namespace luxrig::sim
