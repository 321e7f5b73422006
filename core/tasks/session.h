#pragma once
/// A rig and its scene, and what its light is.

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

/// Builds the scene and checks where lights may hang and whether a point lies in a lamp. All problems, or a Session.
[[nodiscard]] Checked<Session> session_of(Rig rig);

/// Of its rig in its scene (light.h).
[[nodiscard]] Result<TransportMatrix> compute_transport(const Session& session, const ComputeOptions& options,
                                                        const Look& look = {}, ModelUsed* used = nullptr,
                                                        const KeptTransport* before = nullptr);

/// The controller's share of a transport.
[[nodiscard]] LightModel light_model(const Rig& rig, const TransportMatrix& transport);

/// What the rig's points get at given levels of the fixtures, daylight included. With a transport by primary, also in
/// which colour.
[[nodiscard]] std::vector<PlannedPoint> predicted_points(const Rig& rig, const TransportMatrix& transport,
                                                         const Eigen::VectorXd& levels);

}  // namespace luxrig
