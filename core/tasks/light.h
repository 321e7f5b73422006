#pragma once
/// The one door to light: by the evaluator that fits, to the wanted error, and of nothing that is known already.

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
  std::optional<double> worst_error;     ///< in its place: wanted error of each point (EvaluateOptions::kStopMargin)
  std::optional<double> error_floor_lx;  ///< standard error that is small enough at any point; none: by the goals
  double max_seconds = 120;              ///< of each computation of transport; 0: without an end
  bool strict = false;                   ///< a command fails when the wanted error is not reached
  std::string stage = "transport";       ///< what `watch.tell` hears a computation of transport called
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

  /// What is compared with `wanted`: the rms; of the worst, two of its standard errors.
  [[nodiscard]] double error() const { return of_worst ? 2 * relative_error : rms_error; }
  [[nodiscard]] bool reached() const { return error() <= wanted; }
  /// What a person should know when the wanted error was not reached, and what would mend it; else empty.
  [[nodiscard]] std::string warning() const;
};

/// T of emitters at receivers. Without emitters it has no columns.
/// wanted   levels, colour and the floor of errors (rig_transport.h, set_error_floor); all else is by `options`
[[nodiscard]] Result<TransportMatrix> light_of(const RayScene& scene, std::span<const Receiver> receivers,
                                               std::span<const Emitter> emitters, EvaluateOptions wanted,
                                               const ComputeOptions& options, ModelUsed* used = nullptr);

/// Light that was worked out, and where the fixtures looked.
struct KeptTransport {
  std::span<const Joints> joints;  ///< per fixture
  const TransportMatrix& transport;
};

/// T of the rig's points (first) and luxmeters: a column per fixture, then daylight's
/// (rig_transport.h, all_emitters_of).
/// look     joints: empty = as the rig file says; levels: as in EvaluateOptions, empty = all count alike
/// before   by the same rig, or its first fixtures, in the same scene, with the same options. Fixtures that look as they
///          did, and daylight, are not computed again. Where the whole is then less exact than wanted (an error counts
///          for more where other lamps have turned away), a second estimate is made, as coarse as will do, and the mean
///          is the answer.
[[nodiscard]] Result<TransportMatrix> compute_transport(const Rig& rig, const RayScene& rays,
                                                        const ComputeOptions& options, const Look& look = {},
                                                        ModelUsed* used = nullptr,
                                                        const KeptTransport* before = nullptr);

}  // namespace luxrig
