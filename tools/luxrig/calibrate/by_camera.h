#pragma once
/// Measures a daemon's rig by its cameras.

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

/// What a camera of the rig sees from where it is looked for.
struct CameraView {
  std::size_t camera = 0;  ///< of the rig
  CameraStart start;
  std::vector<SeenPlace> places;
  std::size_t first_point = 0;  ///< of its places, in CameraViews::session
  CameraInstrument instrument;
};

/// The places of all cameras are points of `session`, after the rig's own.
struct CameraViews {
  std::vector<CameraView> each;
  std::unique_ptr<const Session> session;  ///< stays where it is: a RigLight of it points there

  /// The points that are places.
  [[nodiscard]] std::vector<std::size_t> points() const;
  [[nodiscard]] std::vector<const CameraInstrument*> instruments() const;
};

/// Adds the cameras' unknowns to the priors. before: an earlier calibration of this rig, if there is one; a camera is
/// looked for from where it was then. Refused if the rig has no such camera, or one sees no matt surface, or is named
/// twice.
[[nodiscard]] Result<CameraViews> camera_views(const Session& stated, std::span<const std::string> names,
                                               const Calibration* before, LightPriors& priors);

struct MeasuredByCamera {
  FoundCamera found;
  CameraOverflow overflow;
};
struct MeasuredByCameras {
  std::vector<LightReading> readings;                 ///< for a RigLight of the views' session
  std::vector<std::optional<MeasuredByCamera>> each;  ///< in the order of the views; none = the camera was not found
};

/// Lights the lamps one by one, and photographs each with the cameras that see light of it; adds curves that are not known
/// yet. A camera that cannot be found in the room is left out, in words. Refused if that is so of all.
/// stated_lux: RigLight::stated_lux() of the views' session.
[[nodiscard]] Result<MeasuredByCameras> measure_by_cameras(const Session& stated, const CameraViews& views,
                                                           const Eigen::MatrixXd& stated_lux, DaemonRig& daemon,
                                                           std::span<const double> brightest,
                                                           std::vector<LampCurve>& curves, const std::stop_token& stop);

/// Puts what was found of the cameras into the calibration, and of all other cameras what `before` says of them.
void put_cameras(const Rig& rig, const CameraViews& views, const MeasuredByCameras& measured, const RigLight& light,
                 const Calibration* before, Calibration& found);

/// Why the light at the goals is not better known, for a person: "response to each kind of lamp 40 %, …".
[[nodiscard]] std::string budget_words(const std::optional<CameraBudget>& budget);

/// The light where each camera that was found sees it, with both pictures. level: of the lamps, as sent. found: the
/// calibration.
[[nodiscard]] Result<std::vector<LuxMap>> lux_maps_of(const Session& stated, const CameraViews& views,
                                                      const MeasuredByCameras& measured, const RigLight& light,
                                                      std::span<const LampCurve> curves, std::span<const double> level,
                                                      const Calibration& found, const ComputeOptions& compute);

}  // namespace luxrig
