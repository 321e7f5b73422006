#pragma once
/// From a rig file to something that can be computed with; what every command starts from.

#include <filesystem>
#include <memory>
#include <string>

#include "core/control/plan.h"
#include "core/control/show_controller.h"
#include "core/rig/rig.h"
#include "core/scene/ray_scene.h"
#include "core/scene/scene.h"
#include "core/transport/evaluator.h"

namespace luxrig {

struct Session {
  Rig rig;
  Scene scene;
  std::unique_ptr<RayScene> rays;
};

/// Reads and checks everything: rig, photometry, buses, meshes, where lights may hang. All problems, or a Session.
[[nodiscard]] Checked<Session> open_session(const std::filesystem::path& rig_path);

enum class Model { automatic, direct, gather, path, cache };

struct ComputeOptions {
  Model model = Model::automatic;
  double max_error = 0.01;
  std::uint64_t seed = 1;
  int threads = 0;
  Watch watch;
};

/// Which evaluator did it, and why that one.
struct ModelUsed {
  std::string name, reason;
};

/// T of the rig's points (first) and luxmeters at its aims: a column per fixture, then daylight's
/// (rig_transport.h, all_emitters_of). `levels`: of the fixtures, as in EvaluateOptions.
[[nodiscard]] Result<TransportMatrix> compute_transport(const Session& session, const ComputeOptions& options,
                                                        const std::vector<double>& levels = {},
                                                        ModelUsed* used = nullptr);

/// The same for a rig in a scene, with lights hung that the session's rig does not have.
[[nodiscard]] Result<TransportMatrix> compute_transport(const Rig& rig, const Scene& scene, const RayScene& rays,
                                                        const ComputeOptions& options,
                                                        const std::vector<double>& levels = {},
                                                        ModelUsed* used = nullptr);

/// The controller's share of a transport.
[[nodiscard]] LightModel light_model(const Rig& rig, const TransportMatrix& transport);

/// What the rig's points get at given levels of the fixtures, daylight included. With a transport by primary, also in
/// which colour.
[[nodiscard]] std::vector<PlannedPoint> predicted_points(const Rig& rig, const TransportMatrix& transport,
                                                         const Eigen::VectorXd& levels);

}  // namespace luxrig
