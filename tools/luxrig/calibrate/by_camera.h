#pragma once
/// Measures a daemon's rig by one of its cameras.

#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "core/calibration/camera_instrument.h"
#include "core/calibration/lamp_steps.h"
#include "core/calibration/rig_light.h"
#include "core/calibration/seen_places.h"
#include "core/tasks/session.h"
#include "tools/luxrig/calibrate/daemon_rig.h"

namespace luxrig {

/// What a camera of the rig sees as stated. Its places are points of `session`, after the rig's own.
struct CameraView {
  std::size_t camera = 0;  ///< of the rig
  std::vector<SeenPlace> places;
  std::unique_ptr<const Session> session;  ///< stays where it is: a RigLight of it points there
  CameraInstrument instrument;

  /// The points that are places.
  [[nodiscard]] std::vector<std::size_t> points() const;
};

/// Adds the camera's unknowns to the priors. Refused if the rig has no such camera, or it sees no matt surface.
[[nodiscard]] Result<CameraView> camera_view(const Session& stated, const std::string& name, LightPriors& priors);

/// Lights the lamps one by one and photographs them; adds curves that are not known yet. The readings are for a RigLight
/// of the view's session.
[[nodiscard]] Result<std::vector<LightReading>> measure_by_camera(const Session& stated, const CameraView& view,
                                                                  DaemonRig& daemon, std::span<const double> brightest,
                                                                  std::vector<LampCurve>& curves,
                                                                  const std::stop_token& stop);

/// Why the light at the goals is not better known, for a person: "response to each kind of lamp 40 %, …".
[[nodiscard]] std::string budget_words(const Rig& rig, const CameraView& view, const RigLight& light,
                                       const Eigen::VectorXd& level);

}  // namespace luxrig
