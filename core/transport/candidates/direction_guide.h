#pragma once
/// Directions drawn where the light matters: through the doorway more than at the walls about it.
///
/// A histogram over the sphere, of equal solid angles, that is filled with what earlier rays were worth and then drawn
/// from. Only where samples are spent depends on it, not what they add up to: every direction keeps a density above 0,
/// and estimates divide by the density of all strategies together (balance heuristic, E. Veach, 1997, §9.2.2).

#include <array>

#include "core/photometry/intensity.h"

namespace luxrig {

class DirectionGuide {
 public:
  static constexpr std::size_t kRings = 16, kSectors = 32;

  /// Worth ≥ 0 of a direction, spread over its bin and, less, over those about it.
  void add(const Vec3& direction, double worth);
  /// To be called once, after the last add(). Without any worth: even over the sphere.
  void finish();

  /// For a point of the unit square; nearby points give nearby directions.
  [[nodiscard]] DirectionSample sample(double u, double v) const;
  [[nodiscard]] double density_per_sr(const Vec3& direction) const;
  [[nodiscard]] bool empty() const { return empty_; }

 private:
  [[nodiscard]] static std::size_t ring_of(const Vec3& direction);
  [[nodiscard]] static std::size_t sector_of(const Vec3& direction);

  std::array<float, kRings * kSectors> share_{};  ///< probability of each bin, rings first
  std::array<float, kRings * kSectors> up_to_{};  ///< cumulative within each ring, the bin included
  std::array<float, kRings> up_to_ring_{};        ///< cumulative
  bool empty_ = true;
};

}  // namespace luxrig
