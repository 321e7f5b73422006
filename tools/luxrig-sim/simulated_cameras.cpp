#include "tools/luxrig-sim/simulated_cameras.h"

#include <sys/resource.h>
#include <unistd.h>

#include "core/picture/pfm.h"
#include "core/tasks/scene_builder.h"
#include "sim/devices/camera.h"

namespace luxrig::sim {

Result<std::string> SimulatedCameras::take(const PictureCamera& camera) {
  const std::lock_guard one_at_a_time(mutex_);
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), 10);  // of this thread, and of threads that it starts
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
  Shot shot;
  shot.seed = deviations_.seed;
  shot.number = shots_++;
  const auto picture = photograph(*rays_, rig_, world_.fixtures(), light, camera, Sensor{}, shot);
  if (!picture) return tl::unexpected(picture.error());
  return to_pfm(*picture);
}

}  // namespace luxrig::sim
