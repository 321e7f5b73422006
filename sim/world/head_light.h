#pragma once
/// The light of a pan-tilt head on every receiver at any aim, without tracing rays while it turns.
///
/// Direct part: exact for a point. The lamp sits in the pivot, so occlusion does not depend on the aim. Visibility is
/// found once, and the column is I(ω) cosθ / d² in closed form. A lamp with size gets the quadrature of shape_light.h
/// (to 1e-3) times its visible share, found once, at the rig file's aim.
/// Indirect part: known at a set of aims; in between, their average, weighted by the inverse fourth power of the angle
/// between the beams (Shepard 1968). At an aim of the set it is that aim's own value. The set holds the rig file's aim
/// and `spread_aims` of the head's range. Off the set it blurs the patch lit by the beam: in a cube of 4 m with a spot
/// of 24° and 32 aims the r.m.s. error is 17 % of the mean indirect light at a wall reflectance of 0.5 (23 % at 0.3),
/// so 3 % of the whole if interreflection is a sixth of the light. tests/sim/world/head_light_accuracy_test.cpp measures it. A
/// scenario that compares the truth after a movement with a plan more precisely than that must have the head's aim in
/// the rig file.

#include <vector>

#include "sim/world/world.h"

namespace luxrig::sim {

/// One head: its mount, its visible receivers, and its indirect light at some aims.
struct HeadSamples {
  std::size_t fixture = 0;
  Pose world_from_mount;  ///< true
  double roll_rad = 0;
  Mat3 photometry_from_lamp = Mat3::Identity();
  Luminaire luminaire;           ///< with its size, colour and TILT
  std::vector<double> sees;      ///< per receiver: unoccluded share of the lamp times the transmission of glass, 0…1
  std::vector<Vec3> aims_mount;  ///< unit beam directions
  Eigen::MatrixXd indirect_lux_per_level;  ///< receivers × aims
};

[[nodiscard]] std::unique_ptr<const HeadLight> make_head_light(std::vector<Receiver> receivers,
                                                               std::vector<HeadSamples> heads);

/// Visible share of a head's lamp at each receiver, at this aim: HeadSamples::sees.
[[nodiscard]] std::vector<double> seen_shares(const RayScene& scene, const std::vector<Receiver>& receivers,
                                              const Emitter& head);

/// Beam direction in frame mount (core/rig/frames.h).
[[nodiscard]] Vec3 beam_mount(const Joints& joints);

/// About `count` joint settings whose beams are spread evenly over the head's range.
[[nodiscard]] std::vector<Joints> spread_aims(const JointRange& range, int count);

}  // namespace luxrig::sim
