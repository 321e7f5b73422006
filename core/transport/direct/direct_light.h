#pragma once
/// The direct part of a transport matrix, shared by all evaluators.

#include "core/transport/direct/emitter_sampler.h"

namespace luxrig {

struct DirectLight {
  Eigen::MatrixXd lux_per_level;  ///< receivers × emitters
  /// Independent unbiased estimates with this mean; all equal where an entry is exact; empty if all are exact.
  std::vector<Eigen::MatrixXd> replicates;
  double relative_error = 0;  ///< standard error reached at the options' levels, largest over receivers; 0 when exact
  double rms_error = 0;       ///< the same, root mean square over receivers
  double floor_lx = 0;        ///< relative errors of dimmer receivers are relative to this; 0 when exact
  std::uint64_t rays = 0;
};

/// Point luminaires: the distance law and one shadow ray per possible light position; exact.
/// Luminaires with size: if nothing can be in between (RayScene::surely_clear), the quadrature of shape_light.h to 1e-5
/// without a ray. Otherwise, and for skies: sampling with 16 replicates of Owen-scrambled Sobol points until each
/// receiver's illuminance has the wanted error; samples go where the error is. Skies use multiple importance sampling
/// between the sky's own directions, cosine-weighted ones and those through openings.
/// No ray is cast for light behind the receiver, for an emission cone that misses it, or for zero intensity towards it.
/// The inputs must have passed check_evaluation(). Cause::cancelled when stopped. Progress goes from 0 to
/// `progress_end`.
///
/// openings   through which skies are seen, if known; null = they are searched for if a sky must be sampled
[[nodiscard]] Result<DirectLight> direct_light(const RayScene& scene, std::span<const Receiver> receivers,
                                               std::span<const Emitter> emitters, const EvaluateOptions& options,
                                               double progress_end = 1.0, const SkyOpenings* openings = nullptr);

/// Point luminaires only. `watch.progress` goes from 0 to `progress_end`.
[[nodiscard]] Result<DirectLight> direct_light(const RayScene& scene, std::span<const Receiver> receivers,
                                               const EmitterSampler& lamps, std::size_t emitters, int threads,
                                               const Watch& watch, double progress_end = 1.0);

/// Null when the scene has no triangle: nothing can block light, so no rays are needed.
[[nodiscard]] const RayScene* obstacles_in(const RayScene& scene);

}  // namespace luxrig
