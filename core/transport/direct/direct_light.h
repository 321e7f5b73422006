#pragma once
/// The direct part of a transport matrix, which every evaluator shares.

#include "core/transport/direct/lamps.h"

namespace luxrig {

struct DirectLight {
  Eigen::MatrixXd lux_per_level;  ///< receivers × emitters
  /// Independent unbiased estimates whose mean it is, equal where an entry is exact; empty when all are.
  std::vector<Eigen::MatrixXd> replicates;
  double relative_error = 0;  ///< standard error reached at the options' levels, largest over receivers; 0 when exact
  double rms_error = 0;       ///< the same, root mean square over receivers
  double floor_lx = 0;        ///< of a dimmer receiver, relative to this; 0 when exact
  std::uint64_t rays = 0;
};

/// Point luminaires: the distance law and one shadow ray per place from which light could come; exact.
/// Luminaires with size: where nothing can stand in between (RayScene::surely_clear), the quadrature of shape_light.h
/// to 1e-5 without a ray. Elsewhere, and for skies, sampled with 16 replicates of Owen-scrambled Sobol points (a sky by
/// multiple importance sampling between its own directions, cosine-weighted ones and those through openings) until the
/// error of the receiver's illuminance is as options want it, samples going where the error is. No ray is cast for what
/// lies behind the receiver, whose emission cone misses it, or that sends nothing there. The inputs must have passed
/// check_evaluation(). Cause::cancelled when stopped. Progress goes from 0 to `progress_end`.
///
/// openings   through which skies are seen, as found before; null: they are looked for when a sky must be sampled
[[nodiscard]] Result<DirectLight> direct_light(const RayScene& scene, std::span<const Receiver> receivers,
                                               std::span<const Emitter> emitters, const EvaluateOptions& options,
                                               double progress_end = 1.0, const SkyOpenings* openings = nullptr);

/// Point luminaires only. `watch.progress` goes from 0 to `progress_end`.
[[nodiscard]] Result<DirectLight> direct_light(const RayScene& scene, std::span<const Receiver> receivers,
                                               const Lamps& lamps, std::size_t emitters, int threads,
                                               const Watch& watch, double progress_end = 1.0);

/// Null when the scene has no triangle: nothing stands in the way, and no ray need be cast to know it.
[[nodiscard]] const RayScene* obstacles_in(const RayScene& scene);

}  // namespace luxrig
