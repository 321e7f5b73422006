#pragma once
/// The simulator's control port: HTTP on loopback, through which a test reads the truth and switches faults on. Routes:
/// API.md.

#include <functional>
#include <memory>
#include <mutex>

#include "core/rig/rig.h"
#include "sim/faults/faults.h"
#include "sim/world/world.h"
#include "tools/luxrig-sim/simulated_cameras.h"

namespace luxrig::sim {

class ControlHttp {
 public:
  /// Serves on its own threads until the destructor. `world_mutex` guards `world`; all arguments outlive this.
  /// seed   of the noise of its cameras' sensors
  static Result<std::unique_ptr<ControlHttp>> open(const Rig& rig, World& world, Faults& faults,
                                                   std::mutex& world_mutex, int port, std::uint64_t seed);
  virtual ~ControlHttp() = default;
  [[nodiscard]] virtual int port() const = 0;
};

/// The body of GET /truth.
[[nodiscard]] std::string truth_json(const Rig& rig, const World& world);

}  // namespace luxrig::sim
