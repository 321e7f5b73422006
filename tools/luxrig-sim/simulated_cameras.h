#pragma once
/// The rig's cameras, which see the simulated world as it is at that moment. Separate from the HTTP part: its library's
/// system headers define macros that break Eigen.

#include <memory>
#include <mutex>
#include <string>

#include "core/rig/rig.h"
#include "core/scene/ray_scene.h"
#include "sim/world/world.h"

namespace luxrig::sim {

class SimulatedCameras {
 public:
  /// All arguments outlive this; world_mutex guards world.
  SimulatedCameras(const Rig& rig, const World& world, std::mutex& world_mutex, const Deviations& deviations)
      : rig_(rig), world_(world), world_mutex_(world_mutex), deviations_(deviations) {}

  /// A picture in the format PFM. Takes seconds, at low priority, one picture at a time. The wires are served all the
  /// while.
  [[nodiscard]] Result<std::string> take(const PictureCamera& camera);

 private:
  const Rig& rig_;
  const World& world_;
  std::mutex& world_mutex_;
  Deviations deviations_;  ///< of the room; their seed is that of the noise, too
  std::mutex mutex_;  ///< guards the two members below
  std::unique_ptr<RayScene> rays_;
  std::uint64_t shots_ = 0;
};

}  // namespace luxrig::sim
