#pragma once
/// Measures a daemon's rig by one of its cameras.

#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "core/calibration/camera_instrument.h"
#include "core/calibration/camera_run.h"
#include "core/calibration/lamp_steps.h"
#include "core/calibration/lux_map.h"
#include "core/calibration/rig_light.h"
#include "core/calibration/seen_places.h"
#include "core/estimation/calibration.h"
#include "core/tasks/session.h"
#include "tools/luxrig/calibrate/daemon_rig.h"

namespace luxrig {

/// What a camera of the rig sees from where it is looked for. Its places are points of `session`, after the rig's own.
struct CameraView {
  std::size_t camera = 0;  ///< of the rig
  CameraStart start;
  std::vector<SeenPlace> places;
  std::unique_ptr<const Session> session;  ///< stays where it is: a RigLight of it points there
  CameraInstrument instrument;

  /// The points that are places.
  [[nodiscard]] std::vector<std::size_t> points() const;
};

/// Adds the camera's unknowns to the priors. before: an earlier calibration of this rig, if there is one; the camera is
/// looked for from where it was then. Refused if the rig has no such camera, or it sees no matt surface.
[[nodiscard]] Result<CameraView> camera_view(const Session& stated, const std::string& name, const Calibration* before,
                                             LightPriors& priors);

struct MeasuredByCamera {
  std::vector<LightReading> readings;  ///< for a RigLight of the view's session
  FoundCamera found;
  CameraOverflow overflow;
};

/// Lights the lamps one by one and photographs them; adds curves that are not known yet.
[[nodiscard]] Result<MeasuredByCamera> measure_by_camera(const Session& stated, const CameraView& view,
                                                         DaemonRig& daemon, std::span<const double> brightest,
                                                         std::vector<LampCurve>& curves, const std::stop_token& stop);

/// Puts what was found of the camera into the calibration, and of all other cameras what `before` says of them.
void put_cameras(const Rig& rig, const CameraView* view, const MeasuredByCamera* measured, const RigLight& light,
                 const Calibration* before, Calibration& found);

/// Why the light at the goals is not better known, for a person: "response to each kind of lamp 40 %, …".
[[nodiscard]] std::string budget_words(const Rig& rig, const CameraView& view, const RigLight& light,
                                       const Eigen::VectorXd& level);

/// The light where the camera sees it, with both pictures. level: of the lamps, as sent. found: the calibration.
[[nodiscard]] Result<LuxMap> lux_map_of(const Session& stated, const CameraView& view, const Camera& camera,
                                        const RigLight& light, std::span<const LampCurve> curves,
                                        std::span<const double> level, const Calibration& found,
                                        const ComputeOptions& compute);

}  // namespace luxrig
