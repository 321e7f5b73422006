#include "core/goals/dicing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/goals/triangle_cut.h"
#include "core/parallel.h"

namespace luxrig {
namespace {

constexpr double kMaxPieces = 50e6;
constexpr std::size_t kTrianglesAtOnce = 4096, kCellsAtOnce = 4096;

/// Corners in an order that depends on their places only, so that neither winding nor numbering changes a bit.
std::array<Vec3, 3> corners_m(const Scene& scene, std::size_t triangle) {
  std::array<Vec3f, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) corners[i] = scene.vertices_m[scene.triangles[triangle][i]];
  std::sort(corners.begin(), corners.end(), [](const Vec3f& a, const Vec3f& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  return {corners[0].cast<double>(), corners[1].cast<double>(), corners[2].cast<double>()};
}

/// False if the triangle is no wider than the rounding of its corners: its normal would be noise.
bool has_area(const std::array<Vec3, 3>& corners) {
  constexpr double kRounding = 0x1p-22;  // four times that of a float
  const Vec3 a = corners[1] - corners[0], b = corners[2] - corners[1], c = corners[0] - corners[2];
  const double longest2 = std::max({a.squaredNorm(), b.squaredNorm(), c.squaredNorm()});
  const double rounding =
      kRounding * std::max(corners[0].lpNorm<Eigen::Infinity>(), corners[2].lpNorm<Eigen::Infinity>());
  return a.cross(b).squaredNorm() > rounding * rounding * longest2;  // so also false for NaN
}

std::size_t blocks_of(std::size_t count, std::size_t at_once) { return (count + at_once - 1) / at_once; }

/// All pieces of a scene with the keys of their cells.
struct Pieces {
  std::vector<CellKey> keys;
  std::vector<DicedPiece> pieces;
};

void cut_triangles(const Scene& scene, const CellGrid& grid, std::size_t block, Pieces& out) {
  std::vector<CutPiece> cut;
  const std::size_t end = std::min(scene.triangles.size(), (block + 1) * kTrianglesAtOnce);
  for (std::size_t t = block * kTrianglesAtOnce; t < end; ++t) {
    const std::array<Vec3, 3> corners = corners_m(scene, t);
    if (!has_area(corners)) continue;
    const Vec3f normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized().cast<float>();
    cut.clear();
    cut_triangle({grid.cells_of(corners[0]), grid.cells_of(corners[1]), grid.cells_of(corners[2])}, cut);
    for (const CutPiece& piece : cut) {
      out.keys.push_back(key_of(piece.cell));
      out.pieces.push_back({grid.position_m(piece.centroid).cast<float>(), normal,
                            static_cast<float>(piece.area * grid.cell_m() * grid.cell_m())});
    }
  }
}

Pieces cut_all(const Scene& scene, const CellGrid& grid, int threads) {
  std::vector<Pieces> blocks(blocks_of(scene.triangles.size(), kTrianglesAtOnce));
  parallel_for(blocks.size(), threads, [&](std::size_t b) { cut_triangles(scene, grid, b, blocks[b]); });
  Pieces all;
  std::size_t count = 0;
  for (const Pieces& block : blocks) count += block.keys.size();
  all.keys.reserve(count);
  all.pieces.reserve(count);
  for (Pieces& block : blocks) {
    all.keys.insert(all.keys.end(), block.keys.begin(), block.keys.end());
    all.pieces.insert(all.pieces.end(), block.pieces.begin(), block.pieces.end());
    block = {};
  }
  return all;
}

/// Bounds of triangles with area, and how many pieces they will have.
std::pair<Eigen::AlignedBox3d, double> extent_of(const Scene& scene, double cell_m) {
  Eigen::AlignedBox3d box_m;
  double pieces = 0;
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    std::array<Vec3, 3> corners = corners_m(scene, t);
    if (!has_area(corners)) continue;
    for (Vec3& corner : corners) {
      box_m.extend(corner);
      corner /= cell_m;
    }
    pieces += expected_pieces(corners);
  }
  return {box_m, pieces};
}

}  // namespace

Result<SurfacePatches> dice_surfaces(const Scene& scene, const PatchOptions& options) {
  const double cell_m = options.cell_m;
  if (!(cell_m > 0) || !std::isfinite(cell_m)) return refusal(fmt::format("patches of {} m cannot be", cell_m));
  const auto [box_m, expected] = extent_of(scene, cell_m);
  const double along = box_m.isEmpty() ? 0 : box_m.sizes().maxCoeff() / cell_m + 4;
  if (!(expected <= kMaxPieces) || !(along <= kMaxCells)) {
    const double larger = std::max(std::sqrt(expected / kMaxPieces), along / kMaxCells);
    return refusal(fmt::format("patches of {:.3g} m are too small for a scene of this size: at least {:.2g} m", cell_m,
                               1.05 * cell_m * larger));
  }

  SurfacePatches surface;
  surface.grid = CellGrid(cell_m, scene.origin_world_m, box_m);
  surface.origin_world_m = scene.origin_world_m;
  const Pieces all = cut_all(scene, surface.grid, options.threads);
  const std::vector<std::uint32_t> order = order_of(all.keys);

  std::vector<std::uint32_t> first_of_run;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && all.keys[order[i]] == all.keys[order[i - 1]]) continue;
    first_of_run.push_back(static_cast<std::uint32_t>(i));
    surface.cells.push_back(all.keys[order[i]]);
  }
  first_of_run.push_back(static_cast<std::uint32_t>(order.size()));

  const std::size_t cells = surface.cells.size();
  std::vector<std::vector<SurfacePatch>> patches(blocks_of(cells, kCellsAtOnce));
  surface.first_of_cell.assign(cells + 1, 0);
  parallel_for(patches.size(), options.threads, [&](std::size_t block) {
    std::vector<DicedPiece> of_cell;
    for (std::size_t c = block * kCellsAtOnce; c < std::min(cells, (block + 1) * kCellsAtOnce); ++c) {
      of_cell.clear();
      for (std::uint32_t i = first_of_run[c]; i < first_of_run[c + 1]; ++i) of_cell.push_back(all.pieces[order[i]]);
      const std::array<std::uint32_t, 3> cell = cell_of(surface.cells[c]);
      const Vec3 middle_m = surface.grid.position_m(Vec3(cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5));
      const std::size_t before = patches[block].size();
      append_patches_of_cell(of_cell, middle_m.cast<float>(), cell_m, patches[block]);
      surface.first_of_cell[c + 1] = static_cast<std::uint32_t>(patches[block].size() - before);
    }
  });
  std::partial_sum(surface.first_of_cell.begin(), surface.first_of_cell.end(), surface.first_of_cell.begin());
  surface.patches.reserve(surface.first_of_cell.back());
  for (const std::vector<SurfacePatch>& block : patches)
    surface.patches.insert(surface.patches.end(), block.begin(), block.end());
  surface.cell_of_patch.reserve(surface.size());
  for (std::size_t c = 0; c < cells; ++c)
    surface.cell_of_patch.insert(surface.cell_of_patch.end(), surface.first_of_cell[c + 1] - surface.first_of_cell[c],
                                 static_cast<std::uint32_t>(c));
  surface.cell_index = CellIndex(surface.cells);
  return surface;
}

Result<SurfacePatches> make_surface_patches(const Scene& scene, const RayScene& rays, const PatchOptions& options) {
  auto surface = dice_surfaces(scene, options);
  if (surface) link_patches(rays, options.threads, *surface);
  return surface;
}

}  // namespace luxrig
