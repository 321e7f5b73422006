#pragma once
/// Learns which lamps' light vertices matter to which receiver from the results of joining.

#include <cstdint>
#include <span>
#include <vector>

#include "core/transport/paths/light_vertex_pool.h"

namespace luxrig {

class LightVertexPlanner {
 public:
  LightVertexPlanner(const EmitterSampler& lamps, std::size_t receivers)
      : lamps_(lamps), learnt_(receivers * lamps.groups()) {}

  /// A plan for `paths` paths of the receiver with about `per_path` hits each: most hits where they scatter most.
  [[nodiscard]] LightVertexPlan plan(std::size_t receiver, double per_path, std::uint32_t paths) const;

  /// squares   by group, as PathSampler::join_start() gives them for these stretches
  /// May run for different receivers at once.
  void learn(std::size_t receiver, std::span<const double> squares, std::span<const LightVertexRange> stretches);

  /// Hits per group that a pool needs when many plans share it.
  /// paths   by plan
  [[nodiscard]] static std::vector<std::uint32_t> pool_counts(const EmitterSampler& lamps,
                                                              std::span<const LightVertexPlan> plans,
                                                              std::span<const std::uint32_t> paths);

 private:
  struct Learnt {
    double squares = 0;  ///< sum of squares of the result of one hit per path
    double hits = 0;
  };
  const EmitterSampler& lamps_;
  std::vector<Learnt> learnt_;  ///< receivers × groups
};

}  // namespace luxrig
