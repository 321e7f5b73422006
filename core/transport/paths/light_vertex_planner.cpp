#include "core/transport/paths/light_vertex_planner.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace luxrig {
namespace {

/// Share of a receiver's hits that follows the lamps' light, whatever it has learnt.
constexpr double kUnlearnt = 0.1;

/// Hits cost one ray and serve all receivers, so pools hold more than one receiver needs: receivers' errors are then
/// less correlated, and paths are joined with more different hits.
constexpr std::size_t kReceiversPerHit = 8;
constexpr std::size_t kMinHits = 32, kMaxHits = 4096;  ///< of a group, unless one receiver needs more

}  // namespace

LightVertexPlan LightVertexPlanner::plan(std::size_t receiver, double per_path, std::uint32_t paths) const {
  const std::size_t groups = lamps_.groups();
  const std::span<const Learnt> learnt(learnt_.data() + receiver * groups, groups);
  std::vector<double> weights(groups, 0.0);
  double sum = 0;
  for (std::size_t g = 0; g < groups; ++g) {
    if (learnt[g].hits > 0) weights[g] = std::sqrt(learnt[g].squares / learnt[g].hits);
    sum += weights[g];
  }
  for (std::size_t g = 0; g < groups; ++g) {
    const double by_light = lamps_.group_share(g);
    weights[g] = sum > 0 ? (1 - kUnlearnt) * weights[g] / sum + kUnlearnt * by_light : by_light;
  }
  return LightVertexPlan::of(lamps_, weights, per_path * paths, paths);
}

void LightVertexPlanner::learn(std::size_t receiver, std::span<const double> squares,
                               std::span<const LightVertexRange> stretches) {
  for (std::size_t g = 0; g < stretches.size(); ++g) {
    Learnt& learnt = learnt_[receiver * lamps_.groups() + g];
    learnt.squares += squares[g];
    learnt.hits += stretches[g].count;
  }
}

std::vector<std::uint32_t> LightVertexPlanner::pool_counts(const EmitterSampler& lamps,
                                                           std::span<const LightVertexPlan> plans,
                                                           std::span<const std::uint32_t> paths) {
  std::vector<std::uint32_t> counts(lamps.groups(), 0);
  for (std::size_t g = 0; g < counts.size(); ++g) {
    if (!(lamps.group_share(g) > 0)) continue;
    std::size_t most = 1, all = 0;
    for (std::size_t i = 0; i < plans.size(); ++i) {
      const std::size_t wanted = hits_for(plans[i].at_start[g], paths[i]);
      most = std::max(most, wanted);
      all += wanted;
    }
    const std::size_t shared = std::clamp(all / kReceiversPerHit, kMinHits, kMaxHits);
    counts[g] = std::bit_ceil(static_cast<std::uint32_t>(std::max(most, shared)));
  }
  return counts;
}

}  // namespace luxrig
