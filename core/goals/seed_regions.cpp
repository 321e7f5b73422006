#include "core/goals/seed_regions.h"

#include <algorithm>

namespace luxrig {

// Dijkstra's method on whole numbers, with a queue for each distance (Dial 1969).
SeedRegions::SeedRegions(const SurfacePatches& surface) : surface_(surface), claims_(surface.size()) {
  std::uint32_t longest = 0;
  for (const PatchLink& link : surface.links) longest = std::max(longest, link.length);
  queues_.resize(longest + 1);
}

void SeedRegions::offer(const Label& label) {
  Claim& best = claims_[label.patch];
  const Claim& claim = label.claim;
  const bool better = claim.distance < best.distance || (claim.distance == best.distance && claim.owner > best.owner);
  if (!better) return;
  best = claim;
  queues_[claim.distance % queues_.size()].push_back(label);
  ++queued_;
}

/// sources   by rising distance
void SeedRegions::spread(const std::vector<Label>& sources, std::vector<std::uint32_t>& changed) {
  std::vector<Label> now;
  std::size_t offered = 0;
  for (std::uint32_t distance = 0; queued_ > 0 || offered < sources.size(); ++distance) {
    if (queued_ == 0) distance = sources[offered].claim.distance;
    while (offered < sources.size() && sources[offered].claim.distance == distance) offer(sources[offered++]);
    now.clear();
    now.swap(queues_[distance % queues_.size()]);
    queued_ -= now.size();
    for (const Label& label : now) {
      if (claims_[label.patch] != label.claim) continue;
      changed.push_back(label.patch);
      for (const PatchLink& link : surface_.links_of(label.patch))
        offer({link.patch, {distance + link.length, label.claim.owner}});
    }
  }
}

void SeedRegions::add(std::uint32_t seed, std::uint32_t patch, std::vector<std::uint32_t>& changed) {
  seeds_.push_back({seed, patch});
  spread({{patch, {0, seed}}}, changed);
}

// What the seed had is free: its neighbours spread into it, and so do further seeds that lie in it.
void SeedRegions::remove(std::uint32_t seed, std::vector<std::uint32_t>& changed) {
  const auto which = std::find_if(seeds_.begin(), seeds_.end(), [&](const auto& s) { return s[0] == seed; });
  if (which == seeds_.end()) return;
  std::vector<std::uint32_t> freed;
  const auto free = [&](std::uint32_t patch) {
    if (claims_[patch].owner != seed) return;
    claims_[patch] = {};
    freed.push_back(patch);
  };
  free((*which)[1]);
  seeds_.erase(which);
  for (std::size_t i = 0; i < freed.size(); ++i)
    for (const PatchLink& link : surface_.links_of(freed[i])) free(link.patch);
  changed.insert(changed.end(), freed.begin(), freed.end());

  std::vector<Label> sources;
  for (const auto& [other, patch] : seeds_)
    if (owner(patch) == kNone) sources.push_back({patch, {0, other}});
  for (const std::uint32_t patch : freed)
    for (const PatchLink& link : surface_.links_of(patch))
      if (const Claim& claim = claims_[link.patch]; claim.owner != kNone)
        sources.push_back({patch, {claim.distance + link.length, claim.owner}});
  std::sort(sources.begin(), sources.end(),
            [](const Label& a, const Label& b) { return a.claim.distance < b.claim.distance; });
  spread(sources, changed);
}

}  // namespace luxrig
