#include "core/rig/patch_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>

namespace luxrig {
namespace {

constexpr int kSlots = 512;

std::string run_of(int first, int count) {
  return count == 1 ? fmt::format("{}", first) : fmt::format("{} to {}", first, first + count - 1);
}

/// First address with `count` free slots in a row; 0 = none.
int free_address(const std::vector<const void*>& taken, int count) {
  int run = 0;
  for (int slot = 1; slot <= kSlots; ++slot) {
    run = taken[static_cast<std::size_t>(slot)] ? 0 : run + 1;
    if (run == count) return slot - count + 1;
  }
  return 0;
}

}  // namespace

void PatchMap::claim_slots(std::size_t bus, int universe, int first, int count, Owner owner) {
  slots_[{bus, universe}].push_back({first, count, std::move(owner)});
}

void PatchMap::claim_registers(std::size_t bus, int unit, RegisterTable table, int first, int count, Owner owner) {
  registers_[{bus, unit, table}].push_back({first, count, std::move(owner)});
}

void PatchMap::claim_node(std::size_t bus, int node, Owner owner) { nodes_[{bus, node}].push_back(std::move(owner)); }

void PatchMap::report(const std::vector<Bus>& buses, ProblemList& problems) const {
  for (const auto& [where, claims] : slots_) {
    std::vector<const void*> taken(kSlots + 1, nullptr);
    std::vector<std::pair<const Claim*, const Claim*>> clashes;  // the later claim, and the one it overlaps
    for (const Claim& claim : claims) {
      const auto first = taken.begin() + claim.first, last = first + claim.count;
      const auto hit = std::find_if(first, last, [](const void* owner) { return owner != nullptr; });
      if (hit != last) {
        clashes.emplace_back(&claim, static_cast<const Claim*>(*hit));
      } else {
        std::fill(first, last, &claim);
      }
    }
    for (const auto& [claim, other] : clashes) {
      if (problems.full()) return;
      // Marks the free run as taken, so that two clashing fixtures are not offered the same address.
      const int free = free_address(taken, claim->count);
      if (free > 0) std::fill_n(taken.begin() + free, claim->count, claim);
      problems.add(claim->owner.in_file,
                   fmt::format("{} takes slot {} of universe {} on bus {}, but {} (line {}) has {}", claim->owner.name,
                               run_of(claim->first, claim->count), where.second, buses[where.first].name,
                               other->owner.name, other->owner.in_file.line, run_of(other->first, other->count)),
                   free > 0 ? fmt::format("address {} is free for it", free)
                            : fmt::format("universe {} has no room for it: use another", where.second));
    }
  }
  for (const auto& [where, claims] : registers_) {
    std::unordered_map<int, const Claim*> taken;
    for (const Claim& claim : claims) {
      const Claim* other = nullptr;
      for (int i = claim.first; i < claim.first + claim.count && !other; ++i) {
        const auto [at, is_new] = taken.try_emplace(i, &claim);
        if (!is_new && at->second != &claim) other = at->second;
      }
      if (!other) continue;
      problems.add(
          claim.owner.in_file,
          fmt::format("{} uses {} register {} of unit {} on bus {}, but {} (line {}) uses {}", claim.owner.name,
                      name_of(where.table), run_of(claim.first, claim.count), where.unit, buses[where.bus].name,
                      other->owner.name, other->owner.in_file.line, run_of(other->first, other->count)),
          "give each its own unit or register");
    }
  }
  for (const auto& [where, owners] : nodes_) {
    for (std::size_t i = 1; i < owners.size(); ++i) {
      problems.add(owners[i].in_file,
                   fmt::format("{} is node {} on bus {}, and so is {} (line {})", owners[i].name, where.second,
                               buses[where.first].name, owners.front().name, owners.front().in_file.line),
                   "give each drive a node of its own");
    }
  }
}

}  // namespace luxrig
