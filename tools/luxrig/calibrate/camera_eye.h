#pragma once
/// Pictures for a calibration, by a camera of the rig: the simulated one of a daemon that runs with --sim or --sim-ports,
/// or the real one by its driver.

#include <memory>
#include <optional>
#include <stop_token>

#include "core/calibration/exposures.h"
#include "core/rig/rig.h"
#include "tools/http/client.h"

namespace luxrig {

class CameraEye {
 public:
  virtual ~CameraEye() = default;
  /// The light now: exposures long to short, merged. Linear, in cd/m² if the camera's scale is known.
  [[nodiscard]] virtual Result<MergedPicture> look(const std::stop_token& stop) = 0;
};

/// sim_control: where the simulated rig of the daemon gives pictures; none = the real camera.
/// Cause::invalid for a real camera without a source.
[[nodiscard]] Result<std::unique_ptr<CameraEye>> camera_eye(const Rig& rig, std::size_t camera,
                                                            const std::optional<HttpPeer>& sim_control);

}  // namespace luxrig
