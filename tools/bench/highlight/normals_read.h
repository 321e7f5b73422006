#pragma once
/// Normals of an object as read from pictures of it, one per lamp: a machine's measure of how well form can be read.
/// Photometric stereo (R. J. Woodham, Optical Engineering 19, 1980) with known lamps and paint. A pixel in shadow, whose
/// value drowns in noise, tells nothing. Where lamps leave a direction open, the surface is taken to face the eye.

#include <cstdint>
#include <span>
#include <vector>

#include "core/highlight/shadow/shadow_edges.h"

namespace luxrig {

/// A lamp's light on each sample.
struct LampOnSamples {
  std::vector<Vec3> towards;      ///< unit, from the sample to the lamp
  std::vector<double> facing_lx;  ///< were the sample turned to the lamp, and nothing between
  std::vector<double> lux;        ///< that reaches it
};

struct ReadNormals {
  /// Of a pixel, as a share of the samples' mean light of all lamps together.
  static constexpr double kNoise = 0.02;
  /// A pixel below so many times its noise is taken for shadow.
  static constexpr double kShadow = 3;
  /// Standard deviation of each component of a normal about the direction to the eye.
  static constexpr double kSpread = 0.5;
};

/// Mean angle between the normals read and those of the samples [rad]. samples: at least one. Same seed, same noise.
[[nodiscard]] double error_of_read_normals(std::span<const OrientedPoint> samples, const Vec3& eye_world_m,
                                           std::span<const LampOnSamples> lamps, std::uint64_t seed);

}  // namespace luxrig
