#pragma once
/// A rig and its scene, and the light in it.

#include <memory>
#include <string>

#include "core/estimation/light_model.h"
#include "core/plan/plan.h"
#include "core/rig/rig.h"
#include "core/scene/ray_scene.h"
#include "core/scene/scene.h"
#include "core/tasks/light.h"
#include "core/tasks/stage.h"

namespace luxrig {

struct Session {
  Rig rig;
  Scene scene;
  std::unique_ptr<RayScene> rays;
};

/// Builds the scene. Checks where lights may hang, and that no point lies in a lamp. All problems, or a Session.
[[nodiscard]] Checked<Session> session_of(Rig rig);

/// For the session's rig in its scene (light.h).
[[nodiscard]] Result<TransportMatrix> compute_transport(const Session& session, const ComputeOptions& options,
                                                        const Look& look = {}, ModelUsed* used = nullptr,
                                                        const KeptTransport* before = nullptr);

/// The part of a transport that the controller needs.
[[nodiscard]] LightModel light_model(const Rig& rig, const TransportMatrix& transport);
/// The same with what heads may give wherever they are aimed.
[[nodiscard]] LightModel light_model(const Session& session, const TransportMatrix& transport);
/// Adds to a model what is not traced: how sure a calibration is of each fixture, and what heads may give wherever they
/// are aimed. Models that are read from a file have none of it.
void add_untraced(const Session& session, LightModel& model);

/// Light at the rig's points for given levels of the fixtures, daylight included; with colours if the transport has
/// primaries.
[[nodiscard]] std::vector<PlannedPoint> predicted_points(const Rig& rig, const TransportMatrix& transport,
                                                         const Eigen::VectorXd& levels);

}  // namespace luxrig
