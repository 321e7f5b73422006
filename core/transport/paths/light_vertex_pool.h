#pragma once
/// Light vertices of one replicate, by group of lamps; the paths of all receivers may be joined with them.

#include <span>

#include "core/transport/paths/light_tracer.h"

namespace luxrig {

class LightVertexPool {
 public:
  /// Replaces its hits by `counts[g]` new ones of each group (a power of two, or 0), continuing the sequence. Returns
  /// the rays cast.
  std::uint64_t refill(const LightTracer& lights, std::uint64_t key, std::span<const std::uint32_t> counts,
                       EmitterSampler::Weights& weights);

  [[nodiscard]] std::size_t groups() const { return groups_.size(); }
  [[nodiscard]] std::uint32_t count(std::size_t group) const { return groups_[group].count; }
  /// In sequence order: every aligned stretch of 2^m has the strata of its first 2^m points.
  [[nodiscard]] std::span<const LightVertex> hits(std::size_t group) const {
    return {hits_.data() + groups_[group].begin, groups_[group].count};
  }
  /// Indices into hits(group) of the hits with flux.
  [[nodiscard]] std::span<const std::uint32_t> shining(std::size_t group) const {
    return {shining_.data() + groups_[group].shining_begin, groups_[group].shining};
  }

 private:
  struct Group {
    std::uint32_t next = 0;  ///< in its sequence
    std::size_t begin = 0, shining_begin = 0;
    std::uint32_t count = 0, shining = 0;
  };
  std::vector<Group> groups_;
  std::vector<LightVertex> hits_;
  std::vector<std::uint32_t> shining_;
};

/// Number of light vertices that the vertices of a path are joined with, by group of lamps. Any plan is unbiased, since
/// paths find the light that hits leave out; groups with the most variance should get the most hits.
struct LightVertexPlan {
  std::vector<double> at_start;  ///< expected number per path; a power of two per `paths` paths if that is above one
  std::vector<double> deeper;    ///< probability for the single hit of each further vertex

  /// weights   by group, ≥ 0
  /// hits      approximate total for this many paths
  static LightVertexPlan of(const EmitterSampler& lamps, std::span<const double> weights, double hits,
                            std::uint32_t paths);
};

/// Stretches of a pool, by group, that serve `paths` paths under the plan. If less than one hit is expected, one or
/// none by chance.
struct LightVertexRange {
  std::uint32_t begin = 0, count = 0;
};
void draw_stretches(const LightVertexPlan& plan, const LightVertexPool& pool, std::uint32_t paths, std::uint64_t key,
                    std::vector<LightVertexRange>& stretches);

/// Upper limit of a group's hits that a plan needs for this many paths.
[[nodiscard]] std::uint32_t hits_for(double per_path, std::uint32_t paths);

}  // namespace luxrig
