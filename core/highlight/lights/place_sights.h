#pragma once
/// What of an object can be lit from each of many places: found once by rays, so that every light there, wherever it
/// shines, is arithmetic.

#include <cstdint>

#include "core/highlight/aim/head_sight.h"
#include "core/highlight/shadow/surroundings.h"
#include "core/highlight/shadow/target_rays.h"

namespace luxrig {

struct PlaceSights {
  std::size_t words = 0;            ///< per receiver
  std::vector<std::uint64_t> rows;  ///< bit p of a receiver: it faces place p, and nothing stands between
  std::uint64_t rays = 0;           ///< cast at the target
  [[nodiscard]] bool sees(std::size_t receiver, std::size_t place) const {
    return rows[receiver * words + place / 64] >> (place % 64) & 1u;
  }
};

/// As `relief_contrast` of mounted beams has it. Without a normal a receiver sees nothing. The same for any number of
/// threads.
[[nodiscard]] PlaceSights sights_of_places(const TargetRays& target, const Surroundings& surroundings,
                                           std::span<const OrientedPoint> receivers,
                                           std::span<const Vec3> places_world_m, double lift_m, int threads);

/// Of one of the places.
[[nodiscard]] HeadSight sight_from(const PlaceSights& sights, std::size_t place, const Vec3& place_world_m,
                                   std::span<const OrientedPoint> receivers);

}  // namespace luxrig
