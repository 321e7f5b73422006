#include "core/highlight/aim/head_sight.h"

#include <algorithm>

#include "core/check.h"
#include "core/parallel.h"

namespace luxrig {
namespace {

constexpr std::size_t kReceiversPerTask = 512;

}  // namespace

HeadSight sight_of(const RayScene& room, const Vec3& head_world_m, std::span<const OrientedPoint> receivers,
                   int threads) {
  HeadSight sight;
  sight.direction.assign(receivers.size(), Vec3::Zero());
  sight.lux_per_cd.assign(receivers.size(), 0);
  const std::size_t tasks = (receivers.size() + kReceiversPerTask - 1) / kReceiversPerTask;
  parallel_for(tasks, threads, [&](std::size_t task) {
    const std::size_t end = std::min(receivers.size(), (task + 1) * kReceiversPerTask);
    for (std::size_t i = task * kReceiversPerTask; i < end; ++i) {
      const OrientedPoint& at = receivers[i];
      const Vec3 away_m = at.position_world_m - head_world_m;
      const double distance_m = away_m.norm();
      if (!(distance_m > 0)) continue;
      sight.direction[i] = away_m / distance_m;
      const double cosine = at.normal.isZero(0) ? 1 : -at.normal.dot(sight.direction[i]);
      if (cosine <= 0 || room.occluded(at.position_world_m, at.normal, head_world_m)) continue;
      sight.lux_per_cd[i] = cosine / (distance_m * distance_m);
      if (room.has_panes()) sight.lux_per_cd[i] *= room.transmittance(at.position_world_m, head_world_m);
    }
  });
  return sight;
}

void lux_of_aim(const HeadSight& sight, const IntensityDistribution& intensity, const Pose& world_from_lamp,
                std::span<double> lux) {
  LUXRIG_CHECK(lux.size() == sight.lux_per_cd.size(), "{} of {}", lux.size(), sight.lux_per_cd.size());
  for (std::size_t i = 0; i < lux.size(); ++i)
    lux[i] = sight.lux_per_cd[i] > 0
                 ? sight.lux_per_cd[i] * intensity.intensity_cd(world_from_lamp.inverse_direction(sight.direction[i]))
                 : 0;
}

}  // namespace luxrig
