#pragma once
/// The exact direct part of a transport matrix, which every evaluator shares.

#include "core/transport/lamps.h"

namespace luxrig {

struct DirectLight {
  Eigen::MatrixXd lux_per_level;  ///< receivers × emitters
  std::uint64_t rays = 0;
};

/// Cause::cancelled when stopped. `watch.progress` goes from 0 to `progress_end`.
[[nodiscard]] Result<DirectLight> direct_light(const RayScene& scene, std::span<const Receiver> receivers,
                                               const Lamps& lamps, std::size_t emitters, int threads,
                                               const Watch& watch, double progress_end = 1.0);

/// Null when the scene has no triangle: nothing stands in the way, and no ray need be cast to know it.
[[nodiscard]] const RayScene* obstacles_in(const RayScene& scene);

}  // namespace luxrig
