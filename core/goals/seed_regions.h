#pragma once
/// Shares out groups among seeds: each patch goes to the nearest along links. Internal to core/goals.

#include "core/goals/surface_patches.h"

namespace luxrig {

/// The Voronoi partition of the patches' graph, kept while seeds come and go. It depends only on which seeds there are.
/// Of seeds at equal distance the one with the highest number gets a patch. A group without a seed has no owner.
class SeedRegions {
 public:
  static constexpr std::uint32_t kNone = ~0u;

  explicit SeedRegions(const SurfacePatches& surface);  ///< must outlive this
  /// seed      a number not in use, below kNone
  /// changed   patches with another owner are appended, each once or more often
  /// Time is linear in the seed's region.
  void add(std::uint32_t seed, std::uint32_t patch, std::vector<std::uint32_t>& changed);
  void remove(std::uint32_t seed, std::vector<std::uint32_t>& changed);
  [[nodiscard]] std::uint32_t owner(std::uint32_t patch) const { return claims_[patch].owner; }

 private:
  struct Claim {
    std::uint32_t distance = kNone, owner = kNone;
    bool operator==(const Claim&) const = default;
  };
  struct Label {
    std::uint32_t patch;
    Claim claim;
  };
  void offer(const Label& label);
  void spread(const std::vector<Label>& sources, std::vector<std::uint32_t>& changed);

  const SurfacePatches& surface_;
  std::vector<Claim> claims_;                        ///< on each patch, the best so far
  std::vector<std::array<std::uint32_t, 2>> seeds_;  ///< seed and its patch
  /// Labels by distance, modulo the number of queues, which is above the longest link.
  std::vector<std::vector<Label>> queues_;
  std::size_t queued_ = 0;
};

}  // namespace luxrig
