#pragma once
/// The simulated rig as a child process, and the truth that it reports.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "core/run.h"
#include "drivers/registry.h"
#include "tools/http/client.h"
#include "tools/process/child_process.h"
#include "tools/process/sim_ports.h"
#include "tools/process/temporary_folder.h"

namespace luxrig {

struct PointTruthSeen {
  std::string name;
  double lux = 0, max_lux_seen = 0;
};
struct SimTruth {
  std::vector<PointTruthSeen> points;
  std::size_t violations = 0;
};

/// Ends the simulator with it.
class SimProcess {
 public:
  /// Starts luxrig-sim from the folder of this program. `seed`: of its deviations.
  /// deviations: as luxrig-sim --deviations.
  [[nodiscard]] static Result<SimProcess> start(const std::filesystem::path& rig, std::uint64_t seed,
                                                const std::string& deviations = "mild");
  /// Waits until it answers (it computes its own truth first).
  [[nodiscard]] Result<SimPorts> wait_ready(const Watch& watch);

 private:
  SimProcess() = default;
  TemporaryFolder folder_{};  ///< its ports file and log
  std::optional<ChildProcess> child_{};
};

/// Asks the simulator for the true light; nothing if it does not answer.
[[nodiscard]] std::optional<SimTruth> ask_truth(const Redirect& control);
/// Which simulated rig this is of all: "real, seed 1". The same words, the same truth. Empty if it does not say.
[[nodiscard]] std::string ask_world(const HttpPeer& control);

}  // namespace luxrig
