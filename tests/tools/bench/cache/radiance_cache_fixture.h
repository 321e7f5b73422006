#pragma once
/// Shared by the tests of radiance_cache.

#include "tests/tools/bench/cache/cache_rooms.h"

namespace luxrig::radiance_cache_fixture {

inline std::vector<Receiver> receivers_of(const std::vector<WallPoint>& points) {
  std::vector<Receiver> receivers;
  for (const WallPoint& p : points) receivers.push_back({p.position_m, p.normal});
  return receivers;
}

/// Both ways to store light, and the second also with all improvements on the thesis.
inline std::vector<CacheSettings> all_kinds() {
  CacheSettings improved = quick_directions();
  improved.first_visibility = improved.link_traversal = Traversal::rays;
  improved.link_surface = LinkSurface::met;
  improved.open_places = true;
  improved.reconstruction = Reconstruction::gather;
  improved.first_reflection = FirstReflection::exact;
  improved.gather_rays = 64;
  return {quick_sides(), quick_directions(), improved};
}

}  // namespace luxrig::radiance_cache_fixture
