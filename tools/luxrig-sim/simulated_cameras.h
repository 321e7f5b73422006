#pragma once
/// The rig's cameras, which see the simulated world as it is at that moment. Separate from the HTTP part: its library's
/// system headers define macros that break Eigen.

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "core/rig/rig.h"
#include "core/scene/ray_scene.h"
#include "sim/devices/camera.h"
#include "sim/world/world.h"

namespace luxrig::sim {

class SimulatedCameras {
 public:
  /// All arguments outlive this; world_mutex guards world.
  SimulatedCameras(const Rig& rig, const World& world, std::mutex& world_mutex, const Deviations& deviations)
      : rig_(rig), world_(world), world_mutex_(world_mutex), deviations_(deviations) {}

  /// A picture in the format PFM. Takes seconds, at low priority, one picture at a time. The wires are served all the
  /// while. camera: of the rig. passes: samples per pixel. Another exposure of the same light takes no time.
  [[nodiscard]] Result<std::string> take(std::size_t camera, double underexposed, int passes);

 private:
  /// The light of the last picture.
  struct Taken {
    std::size_t camera = 0;
    LightNow light;
    Picture on_sensor;
  };
  [[nodiscard]] Result<void> trace_light(std::size_t camera, const Shot& shot);

  const Rig& rig_;
  const World& world_;
  std::mutex& world_mutex_;
  Deviations deviations_;  ///< of the room; their seed is that of the noise, too
  std::mutex mutex_;       ///< guards the members below
  std::unique_ptr<RayScene> rays_;
  std::optional<Taken> last_;
  std::uint64_t shots_ = 0;
};

}  // namespace luxrig::sim
