#pragma once
/// Direct light of a block of candidates at all receivers.

#include "core/transport/candidates/visible_points.h"

namespace luxrig {

/// Prepared luminaire prototype: the data that do not depend on its place.
struct CandidateLuminaire {
  Mat3 lamp_from_world;
  Vec3 offset_world_m;  ///< of the prototype's own pose
  Vec3 axis_world;      ///< -Z of the lamp
  double cos_half_cone;
  const IntensityDistribution* intensity;
  double peak_cd;
};
[[nodiscard]] std::vector<CandidateLuminaire> luminaires_ready(std::span<const Emitter> luminaires);

/// I(ω) cosθ / d² [lx at emittance 1] of a luminaire, unobstructed; 0 behind the receiver, outside its cone, or at the
/// receiver itself.
[[nodiscard]] double unobstructed_lux(const CandidateLuminaire& luminaire, const Vec3& lamp_world_m,
                                      const Receiver& receiver);

/// Dense: lux[(r · positions + p) · luminaires + l], positions counted within the block. Positions with `use` false
/// stay 0. Adds to statistics.pairs_… and rays. False when stopped.
[[nodiscard]] bool direct_of_block(const VisibilityScene& scene, std::span<const Receiver> receivers,
                                   std::span<const Vec3> positions_world_m, const std::vector<std::uint8_t>& use,
                                   std::span<const CandidateLuminaire> luminaires, const CandidateOptions& options,
                                   std::vector<float>& lux, CandidateStatistics& statistics);

}  // namespace luxrig
