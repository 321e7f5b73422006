#pragma once
/// What a head can light, wherever it looks: the lamp sits in the pivot, so what is hidden from it does not depend on
/// its aim, and every aim after that is arithmetic without a ray.

#include <span>
#include <vector>

#include "core/highlight/shadow/shadow_edges.h"
#include "core/photometry/intensity.h"

namespace luxrig {

struct HeadSight {
  std::vector<Vec3> direction;     ///< unit, from the head to each receiver; zero where it hangs on it
  std::vector<double> lux_per_cd;  ///< cosθ / d² [1/m²]; 0 where it is hidden or faces away
};

/// receivers   a normal of zero: faces the head whatever its place (an eye, a camera)
/// room        all that stands in the way, the target too
[[nodiscard]] HeadSight sight_of(const RayScene& room, const Vec3& head_world_m,
                                 std::span<const OrientedPoint> receivers, int threads);

/// Lux at every receiver [lx], full level. lux: one per receiver.
void lux_of_aim(const HeadSight& sight, const IntensityDistribution& intensity, const Pose& world_from_lamp,
                std::span<double> lux);

}  // namespace luxrig
