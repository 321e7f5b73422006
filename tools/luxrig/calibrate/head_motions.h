#pragma once
/// How fast a daemon's heads turn and how long they take to stand still, by the luxmeter that answers soonest of those
/// that a head lights.

#include <stop_token>
#include <vector>

#include "core/tasks/session.h"
#include "tools/luxrig/calibrate/by_heads.h"
#include "tools/luxrig/calibrate/daemon_rig.h"

namespace luxrig {

/// For the heads that were found; others, those with axes of their own, and those that no luxmeter sees stay as they are.
/// A fault is of the daemon.
[[nodiscard]] Result<void> measure_motions(const Session& stated, DaemonRig& daemon, const std::stop_token& stop,
                                           std::vector<MeasuredHead>& heads);

}  // namespace luxrig
