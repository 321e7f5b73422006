#include "tools/bench/cache/seen_part.h"

#include <algorithm>
#include <array>
#include <vector>

#include "core/transport/bsdf.h"
#include "core/transport/sobol.h"
#include "tools/bench/cache/volume/voxelise.h"

namespace luxrig {
namespace {

constexpr std::uint64_t kSeenSamples = 0x7365656e;
constexpr std::size_t kSightRays = 16384;
constexpr std::size_t kMaxReceivers = 1024;
constexpr double kLeftOut = 0.005;  ///< of the rays, at either end
constexpr double kMargin = 0.5;     ///< of the longest side
/// A scene less than this many times as long is kept whole: cells are then only a little larger.
constexpr double kFarLarger = 4;

}  // namespace

Eigen::AlignedBox3d seen_part_m(const Scene& scene, const RayScene& rays, std::span<const Receiver> receivers,
                                std::uint64_t seed) {
  const Eigen::AlignedBox3d whole_m = triangle_bounds_m(scene);
  if (receivers.empty() || whole_m.isEmpty()) return whole_m;
  const std::size_t used = std::min(receivers.size(), kMaxReceivers);
  const auto of_each = static_cast<std::uint32_t>(kSightRays / used);
  std::array<std::vector<double>, 3> met_m;
  Eigen::AlignedBox3d part_m;
  for (const Receiver& receiver : receivers) part_m.extend(receiver.position_world_m - scene.origin_world_m);
  for (std::size_t k = 0; k < used; ++k) {
    const Receiver& receiver = receivers[k * receivers.size() / used];
    const SobolSequence samples(mixed(mixed(seed, kSeenSamples), k));
    for (std::uint32_t i = 0; i < of_each; ++i) {
      const auto [u, v] = samples.pair(i, 0, 0);
      const auto hit =
          rays.nearest(receiver.position_world_m, cosine_direction(receiver.normal_world, u, v), receiver.normal_world);
      if (!hit) continue;
      for (std::size_t axis = 0; axis < 3; ++axis)
        met_m[axis].push_back(hit->position_world_m[static_cast<Eigen::Index>(axis)] -
                              scene.origin_world_m[static_cast<Eigen::Index>(axis)]);
    }
  }
  if (met_m[0].empty()) return whole_m;
  Vec3 low_m, high_m;
  const auto left_out = static_cast<std::ptrdiff_t>(kLeftOut * static_cast<double>(met_m[0].size()));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<double>& at_m = met_m[axis];
    std::nth_element(at_m.begin(), at_m.begin() + left_out, at_m.end());
    low_m[static_cast<Eigen::Index>(axis)] = at_m[static_cast<std::size_t>(left_out)];
    std::nth_element(at_m.begin(), at_m.end() - 1 - left_out, at_m.end());
    high_m[static_cast<Eigen::Index>(axis)] = *(at_m.end() - 1 - left_out);
  }
  part_m.extend(low_m);
  part_m.extend(high_m);
  const double margin_m = kMargin * part_m.sizes().maxCoeff();
  part_m.extend(Vec3(part_m.min() - Vec3::Constant(margin_m)));
  part_m.extend(Vec3(part_m.max() + Vec3::Constant(margin_m)));
  part_m = part_m.intersection(whole_m);
  if (part_m.isEmpty() || whole_m.sizes().maxCoeff() < kFarLarger * part_m.sizes().maxCoeff()) return whole_m;
  return part_m;
}

}  // namespace luxrig
