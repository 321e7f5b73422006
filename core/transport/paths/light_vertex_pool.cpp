#include "core/transport/paths/light_vertex_pool.h"

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

/// Share of the hits at further vertices that follows the lamps' light, not the values learnt at the start.
constexpr double kByLight = 0.5;

double fraction_of(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

}  // namespace

std::uint64_t LightVertexPool::refill(const LightTracer& lights, std::uint64_t key,
                                      std::span<const std::uint32_t> counts, EmitterSampler::Weights& weights) {
  std::uint64_t rays = 0;
  groups_.resize(counts.size());
  hits_.clear();
  shining_.clear();
  for (std::size_t g = 0; g < counts.size(); ++g) {
    Group& group = groups_[g];
    const SobolSequence samples(mixed(key, g));
    group.begin = hits_.size();
    group.shining_begin = shining_.size();
    group.count = counts[g];
    // Aligned to its length, so that it has the strata of a whole net.
    if (group.count > 0) group.next = (group.next + group.count - 1) / group.count * group.count;
    for (std::uint32_t i = 0; i < group.count; ++i) {
      hits_.push_back(lights.trace(g, samples, group.next + i, weights, rays));
      if (hits_.back().shines()) shining_.push_back(i);
    }
    group.next += group.count;
    group.shining = static_cast<std::uint32_t>(shining_.size() - group.shining_begin);
  }
  return rays;
}

std::uint32_t hits_for(double per_path, std::uint32_t paths) {
  return static_cast<std::uint32_t>(std::ceil(per_path * paths - 1e-9));
}

LightVertexPlan LightVertexPlan::of(const EmitterSampler& lamps, std::span<const double> weights, double hits,
                                    std::uint32_t paths) {
  LightVertexPlan plan;
  double sum = 0, light = 0;
  for (std::size_t g = 0; g < weights.size(); ++g) {
    sum += weights[g];
    light += lamps.group_share(g);
  }
  for (std::size_t g = 0; g < weights.size(); ++g) {
    const double by_light = light > 0 ? lamps.group_share(g) / light : 0;
    const double share = !(by_light > 0) ? 0 : sum > 0 ? weights[g] / sum : by_light;
    const double wanted = share * hits;
    plan.at_start.push_back((wanted >= 1 ? std::exp2(std::round(std::log2(wanted))) : wanted) / paths);
    plan.deeper.push_back(kByLight * by_light + (1 - kByLight) * share);
  }
  return plan;
}

void draw_stretches(const LightVertexPlan& plan, const LightVertexPool& pool, std::uint32_t paths, std::uint64_t key,
                    std::vector<LightVertexRange>& stretches) {
  stretches.resize(pool.groups());
  for (std::size_t g = 0; g < pool.groups(); ++g) {
    const double expected = plan.at_start[g] * paths;
    const std::uint64_t bits = mixed(key, g);
    std::uint32_t count = hits_for(plan.at_start[g], paths);
    if (expected < 1) count = fraction_of(bits) < expected ? 1 : 0;
    const std::uint32_t places = count > 0 ? pool.count(g) / count : 0;
    stretches[g] = places == 0 ? LightVertexRange{}
                               : LightVertexRange{static_cast<std::uint32_t>(mixed(bits, 1) % places) * count, count};
  }
}

}  // namespace luxrig
