#pragma once
/// The places that a head can light with any aim. The lamp is at the pivot, so visibility does not depend on the aim,
/// and any aim is then arithmetic without rays.

#include <span>
#include <vector>

#include "core/highlight/shadow/shadow_edges.h"
#include "core/photometry/intensity.h"

namespace luxrig {

struct HeadSight {
  std::vector<Vec3> direction;     ///< unit, from the head to each receiver; zero if they coincide
  std::vector<double> lux_per_cd;  ///< cosθ / d² [1/m²]; 0 where hidden or facing away
};

/// receivers   a normal of zero always faces the head (an eye, a camera)
/// room        everything that can block light, including the target
[[nodiscard]] HeadSight sight_of(const RayScene& room, const Vec3& head_world_m,
                                 std::span<const OrientedPoint> receivers, int threads);

/// Lux at every receiver [lx] at full level. lux: one per receiver.
void lux_of_aim(const HeadSight& sight, const IntensityDistribution& intensity, const Pose& world_from_lamp,
                std::span<double> lux);

}  // namespace luxrig
