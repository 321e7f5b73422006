#pragma once
/// The one entry to transport: chooses the evaluator, computes to the wanted error, and only what is not known already.

#include <optional>
#include <span>
#include <string>

#include "core/plan/look.h"
#include "core/rig/rig.h"
#include "core/run.h"
#include "core/scene/ray_scene.h"
#include "core/transport/evaluator.h"

namespace luxrig {

enum class Model { automatic, direct, gather, path };

struct ComputeOptions : Run {
  Model model = Model::automatic;
  double max_error = 0.01;               ///< wanted root mean square of the points' standard errors
  std::optional<double> worst_error;     ///< instead: wanted error of each point (EvaluateOptions::kStopMargin)
  std::optional<double> error_floor_lx;  ///< standard error that is small enough at any point; none = by the goals
  double max_seconds = 120;              ///< of a call of light_of or compute_transport; 0 = no limit
  bool strict = false;                   ///< a command fails when the wanted error is not reached
  std::string stage = "transport";       ///< name of a computation of transport for `watch.tell`
};

/// The evaluator used, the reason, and the error reached.
struct ModelUsed {
  std::string name, reason;
  double wanted = 0;
  bool of_worst = false;                     ///< `wanted` is for each point, not for their rms
  double relative_error = 0, rms_error = 0;  ///< standard errors: largest over the points, and root mean square
  double error_floor_lx = 0;                 ///< standard error that was small enough at any point; 0: exact
  bool time_was_up = false;                  ///< it ended by ComputeOptions::max_seconds
  double max_seconds = 0;

  /// The error to compare with `wanted`: the rms; with of_worst, two standard errors of the worst point.
  [[nodiscard]] double error() const { return of_worst ? 2 * relative_error : rms_error; }
  [[nodiscard]] bool reached() const { return error() <= wanted; }
  /// Warning for a person if the wanted error was not reached, with a remedy; else empty.
  [[nodiscard]] std::string warning() const;
};

/// T of emitters at receivers. Without emitters it has no columns.
/// wanted   levels, colour and the floor of errors (rig_transport.h, set_error_floor); the rest comes from `options`
[[nodiscard]] Result<TransportMatrix> light_of(const RayScene& scene, std::span<const Receiver> receivers,
                                               std::span<const Emitter> emitters, EvaluateOptions wanted,
                                               const ComputeOptions& options, ModelUsed* used = nullptr);

/// Computed light, and the aims it was computed for.
struct KeptTransport {
  std::span<const Joints> joints;  ///< per fixture
  const TransportMatrix& transport;
};

/// T of the rig's points (first) and luxmeters: a column per fixture, then daylight's
/// (rig_transport.h, all_emitters_of).
/// look     joints: empty = as in the rig file; levels: as in EvaluateOptions, empty = all count alike
/// before   made with the same rig, or its first fixtures, in the same scene, with the same options. Fixtures whose
///          aim is unchanged, and daylight, are not computed again. If the joined result is less exact than wanted (an
///          error weighs more where other lamps have turned away), it is averaged with a second estimate, as coarse as
///          will do. If the error is far too large, or still too large, all is computed again.
[[nodiscard]] Result<TransportMatrix> compute_transport(const Rig& rig, const RayScene& rays,
                                                        const ComputeOptions& options, const Look& look = {},
                                                        ModelUsed* used = nullptr,
                                                        const KeptTransport* before = nullptr);

}  // namespace luxrig
