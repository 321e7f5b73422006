#pragma once
/// A simulated rig with its daemon, to be measured: `luxrig run --sim` as a child.

#include <filesystem>
#include <optional>
#include <stop_token>

#include "core/result.h"
#include "tools/luxrigd/run.h"
#include "tools/process/child_process.h"
#include "tools/process/temporary_folder.h"

namespace luxrig {

/// Both end with it.
class SimulatedRun {
 public:
  /// Returns when the daemon answers on that port and holds its look. A fault if another daemon is there.
  [[nodiscard]] static Result<SimulatedRun> start(const std::filesystem::path& rig, const SimArguments& sim, int port,
                                                  const std::stop_token& stop);

 private:
  SimulatedRun() = default;
  [[nodiscard]] Result<void> wait_held(int port, const std::stop_token& stop);

  TemporaryFolder folder_{};  ///< the daemon's log
  std::optional<ChildProcess> child_{};
};

}  // namespace luxrig
