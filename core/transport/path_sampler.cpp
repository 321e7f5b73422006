#include "core/transport/path_sampler.h"

#include <cmath>

namespace luxrig {
namespace {

// Sets of four Sobol dimensions: directions of two bounces share a set, roulette of four bounces share one.
constexpr std::uint32_t kRouletteSets = 1u << 16;

double roulette_number(const SobolSequence& samples, std::uint32_t index, std::uint32_t bounce) {
  return samples.pair(index, kRouletteSets + bounce / 4, (bounce / 2) % 2)[bounce % 2];
}

}  // namespace

Vec3 cosine_direction(const Vec3& normal_world, double u, double v) {
  const double a = 2 * u - 1, b = 2 * v - 1;
  double x = 0, y = 0;
  if (a != 0 || b != 0) {
    const bool wide = std::abs(a) > std::abs(b);
    const double radius = wide ? a : b;
    const double angle = wide ? kPi / 4 * (b / a) : kPi / 2 - kPi / 4 * (a / b);
    x = radius * std::cos(angle);
    y = radius * std::sin(angle);
  }
  const double z = std::sqrt(std::max(0.0, 1 - x * x - y * y));
  // Tangents without a branch on the normal (T. Duff et al., JCGT 6(1), 2017).
  const Vec3& n = normal_world;
  const double sign = std::copysign(1.0, n.z());
  const double p = -1 / (sign + n.z()), q = n.x() * n.y() * p;
  const Vec3 tangent(1 + sign * n.x() * n.x() * p, sign * q, -sign * n.x());
  const Vec3 bitangent(q, sign + n.y() * n.y() * p, -n.y());
  return (x * tangent + y * bitangent + z * n).normalized();
}

std::uint64_t PathSampler::add_path(const Receiver& from, const SobolSequence& samples, std::uint32_t index,
                                    std::span<double> sums) const {
  std::uint64_t rays = 0;
  Vec3 position_world_m = from.position_world_m, normal_world = from.normal_world;
  double throughput = 1;
  for (std::uint32_t bounce = 0; bounce < kLongestPath; ++bounce) {
    const auto [u, v] = samples.pair(index, bounce / 2, bounce % 2);
    ++rays;
    const auto hit = scene_.nearest(position_world_m, cosine_direction(normal_world, u, v), normal_world);
    if (!hit) break;
    throughput *= scene_.material_of(hit->triangle).luminous_reflectance();
    if (!(throughput > 0)) break;
    position_world_m = hit->position_world_m;
    normal_world = hit->normal_world;
    rays += lamps_.light(&scene_, position_world_m, normal_world,
                         [&](std::size_t emitter, double lux) { sums[emitter] += throughput * lux; });
    if (throughput < kRouletteBelow) {
      if (roulette_number(samples, index, bounce) * kRouletteBelow >= throughput) break;
      throughput = kRouletteBelow;
    }
  }
  return rays;
}

}  // namespace luxrig
