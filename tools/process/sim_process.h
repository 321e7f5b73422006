#pragma once
/// The simulated rig as a child process, and the truth that it reports.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "core/run.h"
#include "drivers/registry.h"
#include "tools/process/child_process.h"
#include "tools/process/sim_ports.h"

namespace luxrig {

struct PointTruthSeen {
  std::string name;
  double lux = 0, max_lux_seen = 0;
};
struct SimTruth {
  std::vector<PointTruthSeen> points;
  std::size_t violations = 0;
};

class SimProcess {
 public:
  /// Starts luxrig-sim from the folder of this program. `seed`: of its deviations.
  /// deviations: as luxrig-sim --deviations.
  [[nodiscard]] static Result<SimProcess> start(const std::filesystem::path& rig, std::uint64_t seed,
                                                const std::string& deviations = "mild");
  ~SimProcess();  ///< ends the child
  SimProcess(SimProcess&& other) noexcept;
  SimProcess& operator=(SimProcess&&) = delete;

  /// Waits until it answers (it computes its own truth first).
  [[nodiscard]] Result<SimPorts> wait_ready(const Watch& watch);

 private:
  explicit SimProcess(std::filesystem::path folder) : folder_(std::move(folder)) {}
  std::filesystem::path folder_;  ///< its ports file and log
  std::optional<ChildProcess> child_;
};

/// Asks the simulator for the true light; nothing if it does not answer.
[[nodiscard]] std::optional<SimTruth> ask_truth(const Redirect& control);

}  // namespace luxrig
