#pragma once
/// The rig's cameras, looking at the simulated world as it is when they are asked. Apart from the HTTP part, whose
/// library's system headers define macros that Eigen does not survive.

#include <memory>
#include <mutex>
#include <string>

#include "core/rig/rig.h"
#include "core/scene/ray_scene.h"
#include "sim/world/world.h"

namespace luxrig::sim {

class SimulatedCameras {
 public:
  /// All outlive this; world_mutex guards world.
  SimulatedCameras(const Rig& rig, const World& world, std::mutex& world_mutex, std::uint64_t seed)
      : rig_(rig), world_(world), world_mutex_(world_mutex), seed_(seed) {}

  /// A picture in the format PFM. Takes seconds, one at a time, at low priority: the wires are served meanwhile.
  [[nodiscard]] Result<std::string> take(const PictureCamera& camera);

 private:
  const Rig& rig_;
  const World& world_;
  std::mutex& world_mutex_;
  std::uint64_t seed_;
  std::mutex mutex_;  ///< guards the two below
  std::unique_ptr<RayScene> rays_;
  std::uint64_t shots_ = 0;
};

}  // namespace luxrig::sim
