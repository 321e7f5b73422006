#pragma once
/// A rig and its scene, and what its light is.

#include <memory>
#include <optional>
#include <string>

#include "core/estimation/light_model.h"
#include "core/plan/plan.h"
#include "core/rig/rig.h"
#include "core/run.h"
#include "core/scene/ray_scene.h"
#include "core/scene/scene.h"
#include "core/tasks/stage.h"
#include "core/transport/evaluator.h"

namespace luxrig {

struct Session {
  Rig rig;
  Scene scene;
  std::unique_ptr<RayScene> rays;
};

/// Builds the scene and checks where lights may hang and whether a point lies in a lamp. All problems, or a Session.
[[nodiscard]] Checked<Session> session_of(Rig rig);

enum class Model { automatic, direct, gather, path };

struct ComputeOptions : Run {
  Model model = Model::automatic;
  double max_error = 0.01;               ///< wanted root mean square of the points' standard errors
  std::optional<double> worst_error;     ///< in its place: wanted error of each point (EvaluateOptions::kStopMargin)
  std::optional<double> error_floor_lx;  ///< standard error that is small enough at any point; none: by the goals
  double max_seconds = 120;              ///< of each computation of transport; 0: without an end
  bool strict = false;                   ///< a command fails when the wanted error is not reached
  std::string stage = "transport";       ///< what `watch.tell` hears a computation of transport called

  /// Asks an evaluator for that error.
  void want_error(EvaluateOptions& evaluate) const;
};

/// Which evaluator did it, why that one, and how close it came.
struct ModelUsed {
  std::string name, reason;
  double wanted = 0;
  bool of_worst = false;                     ///< wanted of each point, not of their rms
  double relative_error = 0, rms_error = 0;  ///< standard errors: largest over the points, and root mean square
  double error_floor_lx = 0;                 ///< standard error that was small enough at any point; 0: exact
  bool time_was_up = false;                  ///< it ended by ComputeOptions::max_seconds
  double max_seconds = 0;

  /// Whether the rms is as wanted; of the worst, whether two of its standard errors are.
  [[nodiscard]] bool reached() const { return (of_worst ? 2 * relative_error : rms_error) <= wanted; }
  /// What a person should know when the wanted error was not reached, and what would mend it; else empty.
  [[nodiscard]] std::string warning() const;
};

/// T of the rig's points (first) and luxmeters: a column per fixture, then daylight's
/// (rig_transport.h, all_emitters_of).
/// look   joints: empty = as the rig file says; levels: as in EvaluateOptions, empty = all count alike
[[nodiscard]] Result<TransportMatrix> compute_transport(const Session& session, const ComputeOptions& options,
                                                        const Look& look = {}, ModelUsed* used = nullptr);

/// The same for a rig in a scene, with lights hung that the session's rig does not have.
[[nodiscard]] Result<TransportMatrix> compute_transport(const Rig& rig, const RayScene& rays,
                                                        const ComputeOptions& options, const Look& look = {},
                                                        ModelUsed* used = nullptr);

/// The controller's share of a transport.
[[nodiscard]] LightModel light_model(const Rig& rig, const TransportMatrix& transport);

/// What the rig's points get at given levels of the fixtures, daylight included. With a transport by primary, also in
/// which colour.
[[nodiscard]] std::vector<PlannedPoint> predicted_points(const Rig& rig, const TransportMatrix& transport,
                                                         const Eigen::VectorXd& levels);

}  // namespace luxrig
