#pragma once
/// The simulator's control port: HTTP on loopback, through which a test reads the truth and switches faults on. Routes:
/// API.md.

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/rig/rig.h"
#include "sim/faults/faults.h"
#include "sim/wire/bus_endpoint.h"
#include "sim/world/world.h"
#include "tools/luxrig-sim/simulated_cameras.h"

namespace luxrig::sim {

/// All outlive the server.
struct ControlParts {
  const Rig& rig;
  World& world;
  Faults& faults;
  std::mutex& world_mutex;  ///< guards `world`
  Deviations deviations;    ///< of that world, for what cameras see
  std::string rig_json;     ///< the body of GET /rig
};

class ControlHttp {
 public:
  /// Serves on its own threads until the destructor.
  static Result<std::unique_ptr<ControlHttp>> open(const ControlParts& parts, int port);
  virtual ~ControlHttp() = default;
  [[nodiscard]] virtual int port() const = 0;
};

/// What stands in the light, as set at the control port: 1 = nothing.
struct InTheLight {
  std::vector<double> shade, cover;  ///< of each point, of each luxmeter
  double daylight = 1;
};

/// The body of GET /truth.
[[nodiscard]] std::string truth_json(const Rig& rig, const World& world, Faults& faults,
                                     const InTheLight& in_the_light);
/// The body of GET /rig: what never changes while the simulator runs. `places`: where each bus listens. world: which of
/// all truths this is, in words.
[[nodiscard]] std::string rig_json(const Rig& rig, const std::map<std::string, EndpointPlace>& places,
                                   const std::string& world, std::uint64_t seed);

}  // namespace luxrig::sim
