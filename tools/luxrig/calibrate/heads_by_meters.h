#pragma once
/// How a daemon's pan-tilt heads hang and turn, measured by its luxmeters alone.

#include <stop_token>
#include <vector>

#include "core/tasks/session.h"
#include "tools/luxrig/calibrate/by_heads.h"
#include "tools/luxrig/calibrate/daemon_rig.h"

namespace luxrig {

/// One head after the other, all else dark. A head that too few luxmeters see is refused in its result; a fault is of the
/// daemon. The delays of the luxmeters should be known already (DaemonRig::measure).
[[nodiscard]] Result<std::vector<MeasuredHead>> measure_heads_by_meters(const Session& stated, DaemonRig& daemon,
                                                                        const std::stop_token& stop);

}  // namespace luxrig
