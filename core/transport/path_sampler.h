#pragma once
/// Light that reaches a surface after diffuse reflection, by paths that start there.

#include "core/transport/lamps.h"
#include "core/transport/sobol.h"

namespace luxrig {

/// Direction in the hemisphere about `normal_world`, with density cosθ/π, for a point of the unit square (concentric
/// map of P. Shirley and K. Chiu, 1997, which keeps the square's strata).
[[nodiscard]] Vec3 cosine_direction(const Vec3& normal_world, double u, double v);

/// With E(x) the illuminance at x and ρ the luminous reflectance, a diffuse surface has radiance ρE/π, so that
///   E(x) = E_direct(x) + ∫ ρ(y)/π E(y) cosθ dω = E_direct(x) + mean of ρ(y) E(y) over cosine-weighted directions.
/// A path follows that recursion; at each vertex every lamp is asked for its direct light.
class PathSampler {
 public:
  /// No path is longer. Reflectances are at most 0.95 (core/scene/scene.h), so what is cut off is below
  /// 0.95^1000 / 0.05 < 1e-20 of the light.
  static constexpr std::uint32_t kLongestPath = 1000;

  /// A path whose throughput falls below this plays Russian roulette: it goes on with probability
  /// throughput / kRouletteBelow, at throughput kRouletteBelow.
  static constexpr double kRouletteBelow = 0.4;

  PathSampler(const RayScene& scene, const Lamps& lamps) : scene_(scene), lamps_(lamps) {}

  /// Adds one unbiased estimate of the reflected illuminance [lx at level 1] of each emitter to sums[emitter].
  /// Returns the rays cast.
  std::uint64_t add_path(const Receiver& from, const SobolSequence& samples, std::uint32_t index,
                         std::span<double> sums) const;

 private:
  const RayScene& scene_;
  const Lamps& lamps_;
};

}  // namespace luxrig
