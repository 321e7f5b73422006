#pragma once
/// Shared by the tests of candidate_skips.

#include <random>

#include "core/transport/candidates/candidate_transport.h"
#include "tests/core/transport/candidates/box_rooms.h"

namespace luxrig::candidate_skips_fixture {

/// Random places in the box around the scene, inside solids too: an isotropic lamp and a spot.
inline CandidateSet places_in(const RayScene& rays, std::size_t count) {
  std::mt19937_64 random(11);
  const Eigen::AlignedBox3d box = rays.bounds_world_m();
  CandidateSet set{{}, {isotropic_luminaire(), spot_luminaire({0.2, 0.1, -1})}};
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 share;
    for (int k = 0; k < 3; ++k) share[k] = static_cast<double>(random() >> 11) * 0x1p-53;
    set.positions_world_m.push_back(box.min() + share.cwiseProduct(box.sizes()));
  }
  return set;
}

inline constexpr std::array kAll = {&CandidateSkips::other_air, &CandidateSkips::behind, &CandidateSkips::blockers,
                                    &CandidateSkips::reach, &CandidateSkips::unlit};

}  // namespace luxrig::candidate_skips_fixture
