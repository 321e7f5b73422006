#pragma once
/// Draws directions where the light matters: more through the doorway than at the walls around it.
///
/// A histogram over the sphere with bins of equal solid angle. Earlier rays fill it with their worth; new directions
/// are drawn from it. It affects only where samples go, not the expected result: every direction keeps a density above
/// 0, and estimates divide by the density of all strategies together (balance heuristic, E. Veach, 1997, §9.2.2).

#include <array>

#include "core/photometry/intensity.h"

namespace luxrig {

class DirectionGuide {
 public:
  static constexpr std::size_t kRings = 16, kSectors = 32;

  /// Adds the worth ≥ 0 of a direction to its bin and, less, to neighbouring bins.
  void add(const Vec3& direction, double worth);
  /// Call once, after the last add(). Without any worth: even over the sphere.
  void finish();

  /// From a point of the unit square; nearby points give nearby directions.
  [[nodiscard]] DirectionSample sample(double u, double v) const;
  [[nodiscard]] double density_per_sr(const Vec3& direction) const;
  [[nodiscard]] bool empty() const { return empty_; }

 private:
  [[nodiscard]] static std::size_t ring_of(const Vec3& direction);
  [[nodiscard]] static std::size_t sector_of(const Vec3& direction);

  std::array<float, kRings * kSectors> share_{};  ///< probability of each bin, rings first
  std::array<float, kRings * kSectors> up_to_{};  ///< cumulative within each ring, including the bin
  std::array<float, kRings> up_to_ring_{};        ///< cumulative
  bool empty_ = true;
};

}  // namespace luxrig
