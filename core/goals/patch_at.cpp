#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/goals/dicing.h"

namespace luxrig {
namespace {

struct Candidate {
  bool unlike;  ///< faces another way than a neighbour in the same group would
  double distance2_m2;
  std::uint32_t patch;
};

void add_candidates(const SurfacePatches& surface, CellKey key, const SurfacePlace& place,
                    std::vector<Candidate>& candidates) {
  const std::uint32_t c = surface.cell_index.find(key);
  if (c == CellIndex::kNone) return;
  for (std::uint32_t p = surface.first_of_cell[c]; p < surface.first_of_cell[c + 1]; ++p) {
    const double cosine = surface.patches[p].normal.cast<double>().dot(place.normal_world);
    if (cosine <= std::cos(kOnePatch_rad)) continue;
    candidates.push_back(
        {cosine <= std::cos(kOneGroup_rad), (surface.position_world_m(p) - place.position_world_m).squaredNorm(), p});
  }
}

}  // namespace

std::optional<std::uint32_t> patch_at(const SurfacePatches& surface, const RayScene& rays, const SurfacePlace& place) {
  const Vec3 in_cells = surface.grid.cells_of(place.position_world_m - surface.origin_world_m);
  if (!in_cells.allFinite() || !place.normal_world.allFinite() || !surface.grid.contains(in_cells)) return {};
  std::vector<Candidate> candidates;
  for (int around = 0; around < 27; ++around) {
    const Vec3 there = in_cells + Vec3(around % 3 - 1, around / 3 % 3 - 1, around / 9 - 1);
    if (surface.grid.contains(there)) add_candidates(surface, key_at(there), place, candidates);
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.unlike, a.distance2_m2, a.patch) < std::tie(b.unlike, b.distance2_m2, b.patch);
  });
  const double cell_m = surface.grid.cell_m();
  const Vec3 eye_world_m = lifted_world_m(place, cell_m, rays);
  for (const Candidate& candidate : candidates) {
    const SurfacePlace there{surface.position_world_m(candidate.patch),
                             surface.patches[candidate.patch].normal.cast<double>().normalized()};
    if (!rays.occluded(eye_world_m, Vec3::Zero(), lifted_world_m(there, cell_m, rays))) return candidate.patch;
  }
  return {};
}

}  // namespace luxrig
