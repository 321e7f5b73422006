#include "tools/bench/highlight/normals_read.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace luxrig {

double error_of_read_normals(std::span<const OrientedPoint> samples, const Vec3& eye_world_m,
                             std::span<const LampOnSamples> lamps, std::uint64_t seed) {
  double sum_lx = 0;
  for (const LampOnSamples& lamp : lamps)
    for (const double lux : lamp.lux) sum_lx += lux;
  const double noise_lx = ReadNormals::kNoise * sum_lx / static_cast<double>(samples.size());
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise;
  double angles_rad = 0;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    const double sure = 1 / (ReadNormals::kSpread * ReadNormals::kSpread);
    Eigen::Matrix3d weight = sure * Eigen::Matrix3d::Identity();
    Vec3 pull = sure * (eye_world_m - samples[s].position_world_m).normalized();
    for (const LampOnSamples& lamp : lamps) {
      const double value_lx = lamp.lux[s] + noise_lx * noise(random);
      if (value_lx <= ReadNormals::kShadow * noise_lx) continue;
      const Vec3 slope = lamp.facing_lx[s] / noise_lx * lamp.towards[s];
      weight += slope * slope.transpose();
      pull += value_lx / noise_lx * slope;
    }
    const Vec3 read = weight.ldlt().solve(pull).normalized();
    angles_rad += std::atan2(read.cross(samples[s].normal).norm(), read.dot(samples[s].normal));
  }
  return angles_rad / static_cast<double>(samples.size());
}

}  // namespace luxrig
