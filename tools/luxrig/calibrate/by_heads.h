#pragma once
/// How a daemon's pan-tilt heads hang and turn, measured by one of its cameras.

#include <cstddef>
#include <stop_token>
#include <string>
#include <vector>

#include "core/calibration/head_fit.h"
#include "core/calibration/head_motion.h"
#include "core/estimation/calibration.h"
#include "core/picture/picture.h"
#include "core/tasks/session.h"
#include "tools/luxrig/calibrate/daemon_rig.h"

namespace luxrig {

struct MeasuredHead {
  std::size_t fixture = 0;  ///< of the rig; the first of its housing
  HeadResult result;
  double seconds = 0;  ///< of rig time
  HeadMotion motion{};  ///< as far as it was measured
};

/// The heads of a rig, each by the first fixture of its housing.
[[nodiscard]] std::vector<std::size_t> heads_of(const Rig& rig);

/// How dim heads are while they are turned, in words; empty = no point has a limit, or there are none.
[[nodiscard]] std::string limited_light_of(const Rig& rig);

/// One head after the other, all else dark. A head whose beam is not found is refused in its result; a fault is of the
/// daemon or the camera. view: the camera as it is known best.
[[nodiscard]] Result<std::vector<MeasuredHead>> measure_heads(const Session& stated, std::size_t camera,
                                                              const Camera& view, DaemonRig& daemon,
                                                              const std::stop_token& stop);

/// Puts the heads that were found into the calibration, with all lamps of their housings. Of a head that was not, what
/// `before` says of it stays.
void put_heads(const Rig& rig, const std::vector<MeasuredHead>& heads, const Calibration* before, Calibration& found);

/// A line for a person.
[[nodiscard]] std::string words_of(const Rig& rig, const MeasuredHead& head);

}  // namespace luxrig
