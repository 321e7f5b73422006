#pragma once
/// The light hits of one replicate, which the paths of all receivers may be joined with, by group of lamps.

#include <span>

#include "core/transport/paths/light_hits.h"

namespace luxrig {

class HitPool {
 public:
  /// Traces `counts[g]` hits of each group (a power of two, or 0) in place of those it held, and goes on in the
  /// sequence where it was. Returns the rays cast.
  std::uint64_t refill(const LightHits& lights, std::uint64_t key, std::span<const std::uint32_t> counts,
                       Lamps::Weights& weights);

  [[nodiscard]] std::size_t groups() const { return groups_.size(); }
  [[nodiscard]] std::uint32_t count(std::size_t group) const { return groups_[group].count; }
  /// In the order of the sequence: every aligned stretch of 2^m has the strata of its first 2^m points.
  [[nodiscard]] std::span<const LightHit> hits(std::size_t group) const {
    return {hits_.data() + groups_[group].begin, groups_[group].count};
  }
  /// Indices into hits(group) of those with flux.
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
  std::vector<LightHit> hits_;
  std::vector<std::uint32_t> shining_;
};

/// How many light hits the vertices of a path are joined with, by group of lamps. Joining is unbiased whatever they
/// are, since paths find what hits leave out; groups whose contributions vary most should get most.
struct HitPlan {
  std::vector<double> at_start;  ///< for each path, expected; a power of two per `paths` paths where that is above one
  std::vector<double> deeper;    ///< probability, for the one hit that each further vertex is joined with

  /// weights   by group, ≥ 0
  /// hits      in all, about, for so many paths
  static HitPlan of(const Lamps& lamps, std::span<const double> weights, double hits, std::uint32_t paths);
};

/// Stretches of a pool, by group, that serve `paths` paths by the plan: where less than one hit is expected, one by
/// chance or none.
struct HitStretch {
  std::uint32_t begin = 0, count = 0;
};
void draw_stretches(const HitPlan& plan, const HitPool& pool, std::uint32_t paths, std::uint64_t key,
                    std::vector<HitStretch>& stretches);

/// Hits of a group that a plan needs for so many paths, at most.
[[nodiscard]] std::uint32_t hits_for(double per_path, std::uint32_t paths);

}  // namespace luxrig
