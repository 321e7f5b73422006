// Which patches belong together: neighbours of similar orientation that see each other.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/goals/dicing.h"
#include "core/parallel.h"

namespace luxrig {
namespace {

constexpr std::size_t kPatchesAtOnce = 2048;
constexpr double kLift_cells = 0.25;

using Pair = std::array<std::uint32_t, 2>;

bool alike(const SurfacePatch& a, const SurfacePatch& b) {
  static const auto kCosine = static_cast<float>(std::cos(kOneGroup_rad));
  return a.normal.dot(b.normal) > kCosine;
}

/// Pairs found for each patch, in the patches' order.
template <class Find>
std::vector<Pair> pairs_of_patches(std::size_t patches, int threads, const Find& find) {
  std::vector<std::vector<Pair>> blocks((patches + kPatchesAtOnce - 1) / kPatchesAtOnce);
  parallel_for(blocks.size(), threads, [&](std::size_t b) {
    for (std::size_t p = b * kPatchesAtOnce; p < std::min(patches, (b + 1) * kPatchesAtOnce); ++p)
      find(static_cast<std::uint32_t>(p), blocks[b]);
  });
  std::vector<Pair> pairs;
  for (const std::vector<Pair>& block : blocks) pairs.insert(pairs.end(), block.begin(), block.end());
  return pairs;
}

std::vector<Vec3> lifted_patches(const SurfacePatches& surface, const RayScene& rays, int threads) {
  std::vector<Vec3> lifted(surface.size());
  parallel_for((surface.size() + kPatchesAtOnce - 1) / kPatchesAtOnce, threads, [&](std::size_t block) {
    for (std::size_t p = block * kPatchesAtOnce; p < std::min(surface.size(), (block + 1) * kPatchesAtOnce); ++p) {
      const SurfacePlace place{surface.position_world_m(static_cast<std::uint32_t>(p)),
                               surface.patches[p].normal.cast<double>().normalized()};
      lifted[p] = lifted_world_m(place, surface.grid.cell_m(), rays);
    }
  });
  return lifted;
}

/// Patches of cells that share a face. The first of a pair has the lower number.
std::vector<Pair> seen_neighbours(const SurfacePatches& surface, const RayScene& rays, int threads) {
  const std::vector<Vec3> lifted = lifted_patches(surface, rays, threads);
  return pairs_of_patches(surface.size(), threads, [&](std::uint32_t p, std::vector<Pair>& pairs) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint32_t c = surface.cell_index.find(next_cell(surface.cells[surface.cell_of_patch[p]], axis));
      if (c == CellIndex::kNone) continue;
      for (std::uint32_t q = surface.first_of_cell[c]; q < surface.first_of_cell[c + 1]; ++q)
        if (alike(surface.patches[p], surface.patches[q]) && !rays.occluded(lifted[p], Vec3::Zero(), lifted[q]))
          pairs.push_back({p, q});
    }
  });
}

bool share_an_edge_only(CellKey a, CellKey b) {
  const auto cell_a = cell_of(a), cell_b = cell_of(b);
  int differ = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto step = static_cast<std::int64_t>(cell_a[axis]) - static_cast<std::int64_t>(cell_b[axis]);
    if (std::abs(step) > 1) return false;
    differ += step != 0;
  }
  return differ == 2;
}

/// Patches of cells that share an edge, both of them linked with one beside them. They shorten ways across the grid and
/// join nothing new.
std::vector<Pair> diagonal_neighbours(const SurfacePatches& surface, int threads) {
  return pairs_of_patches(surface.size(), threads, [&](std::uint32_t p, std::vector<Pair>& pairs) {
    const std::size_t begin = pairs.size();
    for (const PatchLink& one : surface.links_of(p))
      for (const PatchLink& two : surface.links_of(one.patch))
        if (two.patch > p && alike(surface.patches[p], surface.patches[two.patch]) &&
            share_an_edge_only(surface.cells[surface.cell_of_patch[p]],
                               surface.cells[surface.cell_of_patch[two.patch]]))
          pairs.push_back({p, two.patch});
    std::sort(pairs.begin() + static_cast<std::ptrdiff_t>(begin), pairs.end());
    pairs.erase(std::unique(pairs.begin() + static_cast<std::ptrdiff_t>(begin), pairs.end()), pairs.end());
  });
}

void set_links(const std::vector<Pair>& beside, const std::vector<Pair>& diagonal, SurfacePatches& surface) {
  surface.first_link.assign(surface.size() + 1, 0);
  for (const auto* pairs : {&beside, &diagonal})
    for (const Pair& pair : *pairs)
      for (const std::uint32_t p : pair) ++surface.first_link[p + 1];
  std::partial_sum(surface.first_link.begin(), surface.first_link.end(), surface.first_link.begin());
  surface.links.resize(surface.first_link.back());
  std::vector<std::uint32_t> next(surface.first_link.begin(), surface.first_link.end() - 1);
  for (const auto* pairs : {&beside, &diagonal})
    for (const auto& [p, q] : *pairs) {
      const double apart_m = (surface.patches[p].position_m - surface.patches[q].position_m).norm();
      const double length = apart_m / surface.grid.cell_m() * kLengthsPerCell;
      const auto rounded = std::max<std::uint32_t>(1, static_cast<std::uint32_t>(std::lround(length)));
      surface.links[next[p]++] = {q, rounded};
      surface.links[next[q]++] = {p, rounded};
    }
}

void set_groups(const std::vector<Pair>& pairs, SurfacePatches& surface) {
  std::vector<std::uint32_t> parent(surface.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto first_of = [&](std::uint32_t p) {
    while (parent[p] != p) p = parent[p] = parent[parent[p]];
    return p;
  };
  for (const auto& [p, q] : pairs) {
    const std::uint32_t a = first_of(p), b = first_of(q);
    parent[std::max(a, b)] = std::min(a, b);
  }
  surface.group_of_patch.resize(surface.size());
  surface.first_of_group.assign(1, 0);
  for (std::uint32_t p = 0; p < surface.size(); ++p) {
    const std::uint32_t first = first_of(p);
    if (first == p) {
      surface.group_of_patch[p] = static_cast<std::uint32_t>(surface.groups());
      surface.first_of_group.push_back(0);
    } else {
      surface.group_of_patch[p] = surface.group_of_patch[first];
    }
    ++surface.first_of_group[surface.group_of_patch[p] + 1];
  }
  std::partial_sum(surface.first_of_group.begin(), surface.first_of_group.end(), surface.first_of_group.begin());
  std::vector<std::uint32_t> next(surface.first_of_group.begin(), surface.first_of_group.end() - 1);
  surface.patches_by_group.resize(surface.size());
  for (std::uint32_t p = 0; p < surface.size(); ++p) surface.patches_by_group[next[surface.group_of_patch[p]]++] = p;
}

}  // namespace

Vec3 lifted_world_m(const SurfacePlace& place, double cell_m, const RayScene& rays) {
  const Vec3 wanted_m = place.position_world_m + kLift_cells * cell_m * place.normal_world;
  if (!rays.occluded(place.position_world_m, place.normal_world, wanted_m)) return wanted_m;
  const auto hit = rays.nearest(place.position_world_m, place.normal_world, place.normal_world);
  const double free_m = hit ? std::min(hit->distance_m, kLift_cells * cell_m) : kLift_cells * cell_m;
  return place.position_world_m + 0.5 * free_m * place.normal_world;
}

void link_patches(const RayScene& rays, int threads, SurfacePatches& surface) {
  const std::vector<Pair> beside = seen_neighbours(surface, rays, threads);
  set_links(beside, {}, surface);
  set_groups(beside, surface);
  set_links(beside, diagonal_neighbours(surface, threads), surface);
}

}  // namespace luxrig
