#pragma once
/// Parts of an object that can be lit from each of many places: found once by rays, so that any light there, with any
/// aim, is arithmetic.

#include <cstdint>

#include "core/highlight/aim/head_sight.h"
#include "core/highlight/shadow/surroundings.h"
#include "core/highlight/shadow/target_rays.h"

namespace luxrig {

struct PlaceSights {
  std::size_t words = 0;            ///< per receiver
  std::vector<std::uint64_t> rows;  ///< bit p of a receiver: it faces place p, and nothing is in between
  std::uint64_t rays = 0;           ///< cast at the target
  [[nodiscard]] bool sees(std::size_t receiver, std::size_t place) const {
    return rows[receiver * words + place / 64] >> (place % 64) & 1u;
  }
};

/// Visibility as in `relief_contrast` of mounted beams. A receiver without a normal sees nothing. The result does not
/// depend on the number of threads.
[[nodiscard]] PlaceSights sights_of_places(const TargetRays& target, const Surroundings& surroundings,
                                           std::span<const OrientedPoint> receivers,
                                           std::span<const Vec3> places_world_m, double lift_m, int threads);

/// Sight from one of the places.
[[nodiscard]] HeadSight sight_from(const PlaceSights& sights, std::size_t place, const Vec3& place_world_m,
                                   std::span<const OrientedPoint> receivers);

}  // namespace luxrig
