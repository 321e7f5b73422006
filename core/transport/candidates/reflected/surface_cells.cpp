#include "core/transport/candidates/reflected/surface_cells.h"

#include <algorithm>
#include <cmath>

#include "core/transport/sobol.h"

namespace luxrig {
namespace {

constexpr std::uint32_t kSeveral = 0x80000000;
/// Longer lists are not searched: a ray is faster.
constexpr std::size_t kMaxListed = 48;
/// Margin around each cube in its tests, as a share of its size; smaller lifts stay within the tested region.
constexpr double kMargin = 0.06;
constexpr double kCellLift = 0.03;
/// Above this number, cubes are not tested (all then count as having several planes).
constexpr double kMaxCubes = 5e7;
constexpr std::uint32_t kMaxPieces = 8;

/// Separating axes of a triangle and a cube (T. Akenine-Möller, "Fast 3D Triangle-Box Overlap Testing", 2001).
bool overlaps(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& middle, double half) {
  const Vec3 v[3] = {a - middle, b - middle, c - middle};
  const auto apart = [&](const Vec3& axis) {
    const double p = axis.dot(v[0]), q = axis.dot(v[1]), r = axis.dot(v[2]);
    return std::max(-std::max({p, q, r}), std::min({p, q, r})) > half * axis.cwiseAbs().sum();
  };
  for (int k = 0; k < 3; ++k)
    if (apart(Vec3::Unit(k))) return false;
  if (apart((v[1] - v[0]).cross(v[2] - v[0]))) return false;
  for (int e = 0; e < 3; ++e)
    for (int k = 0; k < 3; ++k)
      if (apart((v[(e + 1) % 3] - v[e]).cross(Vec3::Unit(k)))) return false;
  return true;
}

}  // namespace

SurfaceCells::SurfaceCells(const Scene& scene, const RayScene& rays, double cell_m, const Vec3& offset_share)
    : rays_(&rays), cell_m_(cell_m), slots_(1024) {
  const Eigen::AlignedBox3d bounds_m = rays.bounds_world_m();
  start_world_m_ = (bounds_m.isEmpty() ? Vec3(Vec3::Zero()) : bounds_m.min()) - cell_m * (offset_share + Vec3::Ones());
  mark_cubes(scene);
}

SurfaceCells::Cube SurfaceCells::cube_at(const Vec3& position_world_m) const {
  return ((position_world_m - start_world_m_) / cell_m_).array().floor().cast<int>();
}

std::uint64_t SurfaceCells::key_of(const Cube& cube, const Vec3& normal) {
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  const auto facing = static_cast<std::uint64_t>(2 * axis + (normal[axis] < 0 ? 1 : 0));
  std::uint64_t key = facing + 1;  // never 0
  for (int k = 0; k < 3; ++k) key = key << 20 | (static_cast<std::uint64_t>(cube[k]) & 0xfffff);
  return key;
}

void SurfaceCells::mark_cubes(const Scene& scene) {
  const Eigen::AlignedBox3d bounds_m = rays_->bounds_world_m();
  if (bounds_m.isEmpty()) return;
  const Vec3 extent = ((bounds_m.max() - start_world_m_) / cell_m_).array().floor() + 2;
  if (!(extent.prod() < kMaxCubes)) return;
  size_ = extent.cast<int>();
  plane_in_cube_.assign(static_cast<std::size_t>(extent.prod()), kNone);
  const double half_m = cell_m_ * (0.5 + kMargin);
  const auto corner_m = [&](std::uint32_t t, std::size_t k) { return scene.vertex_world_m(scene.triangles[t][k]); };
  const auto normal_of = [&](std::uint32_t t) {
    return Vec3((corner_m(t, 1) - corner_m(t, 0)).cross(corner_m(t, 2) - corner_m(t, 0)).normalized());
  };
  struct Overlap {
    std::uint32_t cube, triangle;
  };
  std::vector<Overlap> overlapping;
  for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) {
    const Vec3 a = corner_m(t, 0), b = corner_m(t, 1), c = corner_m(t, 2), normal = normal_of(t);
    const Vec3 margin_m = Vec3::Constant(kMargin * cell_m_);
    const Cube low = cube_at(a.cwiseMin(b).cwiseMin(c) - margin_m).cwiseMax(0);
    const Cube high = cube_at(a.cwiseMax(b).cwiseMax(c) + margin_m).cwiseMin(size_ - Cube::Ones());
    for (int z = low.z(); z <= high.z(); ++z)
      for (int y = low.y(); y <= high.y(); ++y)
        for (int x = low.x(); x <= high.x(); ++x) {
          const Vec3 middle_m = start_world_m_ + cell_m_ * Vec3(x + 0.5, y + 0.5, z + 0.5);
          // Most cubes in the box of a slanting triangle are far from its plane.
          if (std::abs(normal.dot(middle_m - a)) > half_m * normal.cwiseAbs().sum()) continue;
          if (!overlaps(a, b, c, middle_m, half_m)) continue;
          const auto index = static_cast<std::uint32_t>(x + size_.x() * (y + size_.y() * z));
          overlapping.push_back({index, t});
          std::uint32_t& plane = plane_in_cube_[index];
          if (plane == kNone) {
            plane = t;
          } else if (plane != kSeveral) {
            const Vec3 other = normal_of(plane);
            const bool same =
                normal.cross(other).norm() < 1e-3 && std::abs(other.dot(a - corner_m(plane, 0))) < 1e-3 * cell_m_;
            if (!same) plane = kSeveral;
          }
        }
  }
  std::erase_if(overlapping, [&](const Overlap& one) { return plane_in_cube_[one.cube] != kSeveral; });
  std::stable_sort(overlapping.begin(), overlapping.end(),
                   [](const Overlap& p, const Overlap& q) { return p.cube < q.cube; });
  for (std::size_t i = 0; i < overlapping.size(); ++i) {
    const auto [cube, t] = overlapping[i];
    listed_.push_back({corner_m(t, 0), corner_m(t, 1) - corner_m(t, 0), corner_m(t, 2) - corner_m(t, 0)});
    if (i + 1 < overlapping.size() && overlapping[i + 1].cube == cube) continue;
    plane_in_cube_[cube] = kSeveral + static_cast<std::uint32_t>(list_begin_.size() - 1);
    list_begin_.push_back(static_cast<std::uint32_t>(listed_.size()));
  }
}

std::uint32_t SurfaceCells::plane_in(const Cube& cube) const {
  if ((cube.array() < 0).any() || (cube.array() >= size_.array()).any()) return kNone;
  return plane_in_cube_[static_cast<std::size_t>(cube.x() + size_.x() * (cube.y() + size_.y() * cube.z()))];
}

bool SurfaceCells::simple(const Cube& cube) const { return plane_in(cube) < kSeveral; }

std::size_t SurfaceCells::slot_of(std::uint64_t key) const {
  std::size_t slot = mixed(0, key) & (slots_.size() - 1);
  while (slots_[slot].key != 0 && slots_[slot].key != key) slot = (slot + 1) & (slots_.size() - 1);
  return slot;
}

void SurfaceCells::grow() {
  std::vector<Slot> old(2 * slots_.size());
  old.swap(slots_);
  for (const Slot& slot : old)
    if (slot.key != 0) slots_[slot_of(slot.key)] = slot;
}

bool SurfaceCells::sees(const Vec3& position_world_m, const Vec3& normal_world, const Cell& cell,
                        std::uint64_t& rays) const {
  const double lift_m = kCellLift * cell_m_;
  ++rays;
  return !rays_->occluded(position_world_m + lift_m * normal_world, Vec3::Zero(),
                          cell.first_world_m + lift_m * cell.first_normal_world);
}

/// Segment and triangle: T. Möller and B. Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997. Edges
/// belong to both of their triangles, so that nothing passes between.
bool SurfaceCells::sees_within(const Cube& cube, const Vec3& position_world_m, const Vec3& normal_world,
                               const Cell& cell, std::uint64_t& rays) const {
  const std::uint32_t plane = plane_in(cube);
  const bool listed = plane >= kSeveral && plane != kNone;
  const std::size_t begin = listed ? list_begin_[plane - kSeveral] : 0,
                    end = listed ? list_begin_[plane - kSeveral + 1] : 0;
  if (!listed || end - begin > kMaxListed) return sees(position_world_m, normal_world, cell, rays);
  const double lift_m = kCellLift * cell_m_;
  const Vec3 from_m = position_world_m + lift_m * normal_world;
  const Vec3 way_m = cell.first_world_m + lift_m * cell.first_normal_world - from_m;
  constexpr double kEdge = 1e-9;
  for (std::size_t i = begin; i < end; ++i) {
    const auto& [a_m, ab_m, ac_m] = listed_[i];
    const Vec3 across = way_m.cross(ac_m);
    const double determinant = ab_m.dot(across);
    if (determinant == 0) continue;
    const Vec3 off_m = from_m - a_m;
    const double u = off_m.dot(across) / determinant;
    if (u < -kEdge || u > 1 + kEdge) continue;
    const Vec3 turned = off_m.cross(ab_m);
    const double v = way_m.dot(turned) / determinant;
    if (v < -kEdge || u + v > 1 + kEdge) continue;
    const double t = ac_m.dot(turned) / determinant;
    if (t >= 0 && t <= 1) return false;
  }
  return true;
}

std::uint32_t SurfaceCells::piece(std::uint32_t first, const Cube& cube, const Vec3& position_world_m,
                                  const Vec3& normal_world, std::uint64_t& rays) const {
  if (simple(cube)) return first;
  for (std::uint32_t c = first; c != kNone; c = cells_[c].next)
    if (sees_within(cube, position_world_m, normal_world, cells_[c], rays)) return c;
  return kNone;
}

/// Reservoir sampling: a new place may represent its cell. For equal chances, the n-th hit replaces the previous choice
/// with probability 1/n.
void SurfaceCells::stand_in(Cell& cell, std::uint64_t key, const CellPoint& place, Found by) {
  if (by == Found::from_receiver) return;
  const bool lamp = by == Found::from_lamp;
  const std::uint32_t n = ++(lamp ? cell.hits_from_lamps : cell.hits_from_surfaces);
  const bool for_all = (lamp ? cell.hits_from_surfaces : cell.hits_from_lamps) == 0;
  const std::size_t from = lamp && !for_all ? kPlaces / 2 : 0, to = lamp || for_all ? kPlaces : kPlaces / 2;
  for (std::size_t i = from; i < to; ++i)
    if (mixed(key + i, 2 * n + lamp) % n == 0) cell.places[i] = place;
}

std::uint32_t SurfaceCells::cell_at(const Vec3& position_world_m, const Vec3& normal_world, std::uint32_t max_cells,
                                    Found by) {
  const Cube cube = cube_at(position_world_m);
  const std::uint64_t key = key_of(cube, normal_world);
  const std::size_t slot = slot_of(key);
  std::uint32_t first = slots_[slot].key == key ? slots_[slot].first : kNone;
  if (first != kNone) {
    const std::uint32_t found = piece(first, cube, position_world_m, normal_world, rays_cast_);
    if (found != kNone) {
      stand_in(cells_[found], key, {position_world_m, normal_world}, by);
      return found;
    }
    std::uint32_t pieces = 0;
    for (std::uint32_t c = first; c != kNone; c = cells_[c].next) ++pieces;
    if (pieces >= kMaxPieces) return kNone;
  }
  if (cells_.size() >= max_cells) return kNone;
  const auto made = static_cast<std::uint32_t>(cells_.size());
  Cell cell{{}, position_world_m, normal_world, 0, 0, first};
  cell.places.fill({position_world_m, normal_world});
  stand_in(cell, key, cell.places[0], by);
  cells_.push_back(cell);
  slots_used_ += slots_[slot].key == 0;
  slots_[slot] = {key, made};
  if (2 * slots_used_ > slots_.size()) grow();
  return made;
}

std::uint32_t SurfaceCells::find(const Vec3& position_world_m, const Vec3& normal_world, std::uint64_t& rays) const {
  const Cube cube = cube_at(position_world_m);
  const Slot& slot = slots_[slot_of(key_of(cube, normal_world))];
  if (slot.key != 0) {
    const std::uint32_t found = piece(slot.first, cube, position_world_m, normal_world, rays);
    if (found != kNone) return found;
  }
  // A corner that no ray has found: the nearest surrounding cell that faces the same way and sees it.
  std::uint32_t nearest = kNone;
  double nearest_m2 = HUGE_VAL;
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) {
        const Slot& about = slots_[slot_of(key_of(cube + Cube(x, y, z), normal_world))];
        if (about.key == 0) continue;
        for (std::uint32_t c = about.first; c != kNone; c = cells_[c].next) {
          const double distance_m2 = (cells_[c].first_world_m - position_world_m).squaredNorm();
          if (distance_m2 >= nearest_m2) continue;
          if (!sees(position_world_m, normal_world, cells_[c], rays)) continue;
          nearest = c;
          nearest_m2 = distance_m2;
        }
      }
  return nearest;
}

}  // namespace luxrig
