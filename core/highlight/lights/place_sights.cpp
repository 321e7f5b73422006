#include "core/highlight/lights/place_sights.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"

namespace luxrig {
namespace {

constexpr std::size_t kReceiversPerSightTask = 16;

}  // namespace

PlaceSights sights_of_places(const TargetRays& target, const Surroundings& surroundings,
                             std::span<const OrientedPoint> receivers, std::span<const Vec3> places_world_m,
                             double lift_m, int threads) {
  PlaceSights sights;
  sights.words = (places_world_m.size() + 63) / 64;
  sights.rows.assign(receivers.size() * sights.words, 0);
  const std::size_t tasks = (receivers.size() + kReceiversPerSightTask - 1) / kReceiversPerSightTask;
  std::vector<std::uint64_t> rays(tasks, 0);
  parallel_for(tasks, threads, [&](std::size_t task) {
    std::vector<std::uint32_t> asked;
    std::vector<Vec3> to_world_m;
    std::vector<std::uint8_t> shaded;
    std::vector<Blocked> blocked;
    const std::size_t end = std::min(receivers.size(), (task + 1) * kReceiversPerSightTask);
    for (std::size_t r = task * kReceiversPerSightTask; r < end; ++r) {
      const OrientedPoint& at = receivers[r];
      asked.clear();
      to_world_m.clear();
      for (std::uint32_t p = 0; p < places_world_m.size(); ++p) {
        if (!((places_world_m[p] - at.position_world_m).dot(at.normal) > 0)) continue;
        asked.push_back(p);
        to_world_m.push_back(places_world_m[p]);
      }
      shaded.assign(asked.size(), 0);
      blocked.assign(asked.size(), Blocked::by_nothing);
      target.blocked_before(at.position_world_m, at.normal, lift_m, to_world_m, shaded);
      find_blocked(surroundings, at.position_world_m, to_world_m, blocked);
      rays[task] += asked.size();
      for (std::size_t k = 0; k < asked.size(); ++k)
        if (!shaded[k] && blocked[k] == Blocked::by_nothing)
          sights.rows[r * sights.words + asked[k] / 64] |= std::uint64_t{1} << (asked[k] % 64);
    }
  });
  sights.rays = std::accumulate(rays.begin(), rays.end(), std::uint64_t{0});
  return sights;
}

HeadSight sight_from(const PlaceSights& sights, std::size_t place, const Vec3& place_world_m,
                     std::span<const OrientedPoint> receivers) {
  HeadSight sight;
  sight.direction.assign(receivers.size(), Vec3::Zero());
  sight.lux_per_cd.assign(receivers.size(), 0);
  for (std::size_t r = 0; r < receivers.size(); ++r) {
    if (!sights.sees(r, place)) continue;
    const Vec3 way_m = receivers[r].position_world_m - place_world_m;
    const double squared_m2 = way_m.squaredNorm();
    sight.direction[r] = way_m / std::sqrt(squared_m2);
    sight.lux_per_cd[r] = -receivers[r].normal.dot(sight.direction[r]) / squared_m2;
  }
  return sight;
}

}  // namespace luxrig
