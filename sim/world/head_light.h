#pragma once
/// What a pan-tilt head gives every receiver, wherever it looks, without a ray being traced while it turns.
///
/// Direct part: exact for a point. The lamp sits in the pivot, so what is hidden from it does not depend on the aim;
/// visibility is found once, and the column is I(ω) cosθ / d² in closed form. A lamp with size gets the quadrature of
/// shape_light.h (to 1e-3) times the share of it that is seen, which is found once, at the aim of the rig file.
/// Indirect part: known at a set of aims, and in between the average of those, weighted by the inverse fourth power of
/// the angle between the beams (Shepard 1968). At an aim of the set it is that aim's own value; the set holds the aim
/// that the rig file gives and `spread_aims` of the head's range. Off the set it blurs the patch that the beam lights:
/// in a cube of 4 m with a spot of 24° and 32 aims the r.m.s. error is 17 % of the mean indirect light at a wall
/// reflectance of 0.5 (23 % at 0.3), so 3 % of the whole where interreflection is a sixth of the
/// light (tests/sim/world/head_light_accuracy_test.cpp). A scenario that compares the truth after a movement with
/// a plan to better than that gives the head's aim in the rig file.

#include <vector>

#include "sim/world/world.h"

namespace luxrig::sim {

/// One head: where it hangs, what it sees, and its indirect light at some aims.
struct HeadSamples {
  std::size_t fixture = 0;
  Pose world_from_mount;  ///< true
  double roll_rad = 0;
  Luminaire luminaire;       ///< its size, colour and TILT count
  std::vector<double> sees;  ///< per receiver: share of the lamp with nothing in between, less what glass takes, 0…1
  std::vector<Vec3> aims_mount;            ///< unit beam directions
  Eigen::MatrixXd indirect_lux_per_level;  ///< receivers × aims
};

[[nodiscard]] std::unique_ptr<const HeadLight> make_head_light(std::vector<Receiver> receivers,
                                                               std::vector<HeadSamples> heads);

/// What a head, aimed so, shows each receiver of its lamp: HeadSamples::sees.
[[nodiscard]] std::vector<double> seen_shares(const RayScene& scene, const std::vector<Receiver>& receivers,
                                              const Emitter& head);

/// Beam direction in frame mount (core/rig/frames.h).
[[nodiscard]] Vec3 beam_mount(const Joints& joints);

/// About `count` joint settings whose beams are spread evenly over what the head can reach.
[[nodiscard]] std::vector<Joints> spread_aims(const JointRange& range, int count);

}  // namespace luxrig::sim
