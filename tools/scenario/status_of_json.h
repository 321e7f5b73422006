#pragma once
/// The daemon's status, read from its own JSON (tools/luxrigd/API.md): what rules and conditions need of it.

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "core/rig/rig.h"
#include "core/show/show_controller.h"

namespace luxrig::scenario {

struct DaemonStatus {
  /// phase, blackout, plan_waits, goals; of points: goal and verdict; of fixtures: level; alarms; by_hand. Its times are
  /// the daemon's, from its start.
  ShowStatus show;
  double time_s = 0;                ///< since the daemon's start
  std::vector<std::uint64_t> sent;  ///< per bus: what its driver has sent
  /// Per bus: frames are to be expected. Its driver knows of no failure, and it is not silent beside a lighting desk.
  std::vector<bool> sends;
};

/// Cause::invalid, saying what is wrong, for any text that is no status of this rig.
[[nodiscard]] Result<DaemonStatus> status_of_json(std::string_view text, const Rig& rig);

}  // namespace luxrig::scenario
