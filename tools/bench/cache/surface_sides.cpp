#include "tools/bench/cache/surface_sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/parallel.h"

namespace luxrig {
namespace {

/// Height above a surface of the lines of sight between its places, as a share of a cell.
constexpr double kLift = 0.02;
/// Pieces to a cell's face; one more for each triangle that crosses the cell.
constexpr double kPiecesPerFace = 16;
/// Maximum: surfaces outside the grid belong to its outermost cells, however large they are.
constexpr double kMaxPieces = 64;
/// Polygons thinner than this [cells] along an axis lie in one cell along it.
constexpr double kThin = 1e-9;
/// Parts of triangles smaller than this [cell faces] are left out. Where a cell's border runs along a triangle's edge,
/// rounding leaves slivers with places that may lie outside.
constexpr double kDust = 1e-9;
/// Sides of less than this share of a cell's face join a larger neighbour whose normal is within 37°.
constexpr double kSmallSide = 0.2;
constexpr double kSameWay = 0.8;
/// Places within this of a plane [cells] lie in it.
constexpr double kFlat = 1e-4;
constexpr std::size_t kTrianglesPerTask = 256;

struct RawPiece {
  SurfacePiece piece;
  std::uint32_t cell;
  std::uint32_t facing;
};

/// A convex polygon of few corners, in frame grid.
struct Polygon {
  std::array<Vec3, 10> corners = [] {
    std::array<Vec3, 10> none;
    none.fill(Vec3::Zero());
    return none;
  }();
  int count = 0;
  void add(const Vec3& corner) { corners[static_cast<std::size_t>(count++)] = corner; }
};

/// The part of a polygon on one side of a plane across an axis (I. Sutherland, G. Hodgman, 1974).
Polygon clipped(const Polygon& polygon, int axis, double at, bool keep_above) {
  Polygon out;
  for (int i = 0; i < polygon.count; ++i) {
    const Vec3& a = polygon.corners[static_cast<std::size_t>(i)];
    const Vec3& b = polygon.corners[static_cast<std::size_t>((i + 1) % polygon.count)];
    const double da = keep_above ? a[axis] - at : at - a[axis], db = keep_above ? b[axis] - at : at - b[axis];
    if (da >= 0) out.add(a);
    if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
      Vec3 crossing = a + (b - a) * (da / (da - db));
      crossing[axis] = at;
      out.add(crossing);
    }
  }
  return out;
}

/// Calls take(polygon, cell) for the part of a polygon in each cell.
template <class Take>
void cut_by_cells(const Polygon& polygon, int axis, Eigen::Vector3i cell, const Eigen::Vector3i& size, Take&& take) {
  if (polygon.count < 3) return;
  if (axis == 3) {
    take(polygon, cell);
    return;
  }
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (int i = 0; i < polygon.count; ++i) {
    low = std::min(low, polygon.corners[static_cast<std::size_t>(i)][axis]);
    high = std::max(high, polygon.corners[static_cast<std::size_t>(i)][axis]);
  }
  const auto cell_at = [&](double at) { return std::clamp(static_cast<int>(std::floor(at)), 0, size[axis] - 1); };
  const int first = high - low < kThin ? cell_at((low + high) / 2) : cell_at(low);
  const int last = high - low < kThin ? first : cell_at(high);
  Polygon rest = polygon;
  for (int i = first; i <= last; ++i) {
    cell[axis] = i;
    if (i == last) {
      cut_by_cells(rest, axis + 1, cell, size, take);
    } else {
      cut_by_cells(clipped(rest, axis, i + 1, false), axis + 1, cell, size, take);
      rest = clipped(rest, axis, i + 1, true);
    }
  }
}

/// A place in a convex polygon, uniform by area, for a point of the unit square.
Vec3 place_in(const Polygon& polygon, double u, double v) {
  std::array<double, 10> area{};
  double whole = 0;
  const Vec3& a = polygon.corners[0];
  for (int i = 1; i + 1 < polygon.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    area[k] = (polygon.corners[k] - a).cross(polygon.corners[k + 1] - a).norm();
    whole += area[k];
  }
  std::size_t k = 1;
  double left = u * whole;
  while (static_cast<int>(k) + 2 < polygon.count && left > area[k]) left -= area[k++];
  const double s = std::sqrt(area[k] > 0 ? std::clamp(left / area[k], 0.0, 1.0) : 0.5);
  return a + s * (polygon.corners[k] - a) + s * v * (polygon.corners[k + 1] - polygon.corners[k]);
}

}  // namespace

std::uint32_t facing_of(const Vec3& normal) {
  int axis = 0;
  const double largest = normal.cwiseAbs().maxCoeff(&axis);
  const auto third = [&](double across) {
    const double share = across / largest;
    return share < -1.0 / 3 ? 0u : share > 1.0 / 3 ? 2u : 1u;
  };
  const std::uint32_t face = 2 * static_cast<std::uint32_t>(axis) + (normal[axis] > 0 ? 1u : 0u);
  return face * 9 + third(normal[(axis + 1) % 3]) * 3 + third(normal[(axis + 2) % 3]);
}

SurfaceSides::SurfaceSides(const Scene& scene, const RayScene& rays, const VoxelGrid& cells, int group_cells,
                           int threads)
    : rays_(rays), origin_world_m_(scene.origin_world_m), cells_(cells) {
  cut_up(scene, threads);
  make_sides(threads);
  make_groups(group_cells, threads);
}

void SurfaceSides::cut_up(const Scene& scene, int threads) {
  const std::size_t tasks = (scene.triangles.size() + kTrianglesPerTask - 1) / kTrianglesPerTask;
  std::vector<std::vector<RawPiece>> found(tasks);
  parallel_for(tasks, threads, [&](std::size_t task) {
    const std::size_t end = std::min(scene.triangles.size(), (task + 1) * kTrianglesPerTask);
    for (std::size_t t = task * kTrianglesPerTask; t < end; ++t) {
      Polygon whole;
      for (const std::uint32_t vertex : scene.triangles[t])
        whole.add(cells_.grid_from_scene(scene.vertices_m[vertex].cast<double>()));
      const Vec3 cross = (whole.corners[1] - whole.corners[0]).cross(whole.corners[2] - whole.corners[0]);
      if (!(cross.norm() > 0)) continue;
      const Vec3 normal = cross.normalized();
      const std::uint32_t front = facing_of(normal), back = facing_of(-normal);
      cut_by_cells(whole, 0, Eigen::Vector3i::Zero(), cells_.size,
                   [&](const Polygon& part, const Eigen::Vector3i& cell) {
                     double area = 0;  // [cell faces]
                     for (int i = 1; i + 1 < part.count; ++i)
                       area += 0.5 * (part.corners[static_cast<std::size_t>(i)] - part.corners[0])
                                         .cross(part.corners[static_cast<std::size_t>(i + 1)] - part.corners[0])
                                         .norm();
                     if (!(area > kDust)) return;
                     const int count = 1 + static_cast<int>(std::min(area * kPiecesPerFace, kMaxPieces));
                     const double area_m2 = area / count * cells_.voxel_m * cells_.voxel_m;
                     for (int i = 0; i < count; ++i) {
                       // The R2 sequence (M. Roberts, 2018), evenly spread for any count.
                       const double u = std::fmod(0.7548776662466927 * (i + 1), 1.0),
                                    v = std::fmod(0.5698402909980532 * (i + 1), 1.0);
                       const Vec3 at_m = origin_world_m_ + cells_.scene_from_grid(place_in(part, u, v));
                       const auto index = static_cast<std::uint32_t>(cells_.index(cell));
                       const auto triangle = static_cast<std::uint32_t>(t);
                       const auto share_m2 = static_cast<float>(area_m2);
                       found[task].push_back({{at_m, normal.cast<float>(), share_m2, triangle, 0}, index, front});
                       found[task].push_back({{at_m, (-normal).cast<float>(), share_m2, triangle, 0}, index, back});
                     }
                   });
    }
  });
  std::vector<RawPiece> all;
  for (auto& part : found) {
    all.insert(all.end(), part.begin(), part.end());
    part = {};
  }
  std::stable_sort(all.begin(), all.end(), [](const RawPiece& a, const RawPiece& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.facing < b.facing;
  });
  pieces_.reserve(all.size());
  for (const RawPiece& raw : all) {
    if (slots_.empty() || slots_.back().cell != raw.cell || slots_.back().facing != raw.facing)
      slots_.push_back({raw.cell, raw.facing, false, static_cast<std::uint32_t>(pieces_.size()), 0});
    pieces_.push_back(raw.piece);
    slots_.back().end_place = static_cast<std::uint32_t>(pieces_.size());
  }
}

bool SurfaceSides::sees(const Vec3& a_world_m, const Vec3& normal_a, const Vec3& b_world_m, const Vec3& normal_b,
                        double lift_m) const {
  // Rays stop short of their ends by twice the error of a surface. The surface under the places must be farther away.
  lift_m = std::max(lift_m, 4 * rays_.surface_error_m(a_world_m));
  return !rays_.occluded(a_world_m + lift_m * normal_a, Vec3::Zero(), b_world_m + lift_m * normal_b);
}

void SurfaceSides::make_sides(int threads) {
  // Slots still hold ranges of pieces. Within each, pieces are numbered by the first piece that they see.
  for (std::size_t begin = 0, end = 0; begin < slots_.size(); begin = end) {
    while (end < slots_.size() && slots_[end].cell == slots_[begin].cell) ++end;
    const SurfacePiece& first = pieces_[slots_[begin].first_place];
    const Vec3 normal = first.normal_world.cast<double>();
    bool plain = true;
    for (std::size_t s = begin; s < end && plain; ++s)
      for (std::uint32_t i = slots_[s].first_place; i < slots_[s].end_place && plain; ++i)
        plain = std::abs(normal.dot(pieces_[i].position_world_m - first.position_world_m)) < kFlat * cells_.voxel_m;
    for (std::size_t s = begin; s < end; ++s) slots_[s].plain = plain;
  }
  std::vector<std::uint32_t> sides_of_slot(slots_.size(), 0);
  parallel_for(slots_.size(), threads, [&](std::size_t s) {
    std::vector<std::uint32_t> first;
    for (std::uint32_t i = slots_[s].first_place; i < slots_[s].end_place; ++i) {
      SurfacePiece& piece = pieces_[i];
      const Vec3 normal = piece.normal_world.cast<double>();
      const auto seen = std::find_if(first.begin(), first.end(), [&](std::uint32_t other) {
        return sees(piece.position_world_m, normal, pieces_[other].position_world_m,
                    pieces_[other].normal_world.cast<double>(), kLift * cells_.voxel_m);
      });
      piece.side = static_cast<std::uint32_t>(seen - first.begin());
      if (seen == first.end()) first.push_back(i);
    }
    std::stable_sort(pieces_.begin() + slots_[s].first_place, pieces_.begin() + slots_[s].end_place,
                     [](const SurfacePiece& a, const SurfacePiece& b) { return a.side < b.side; });
    sides_of_slot[s] = static_cast<std::uint32_t>(first.size());
  });
  std::uint32_t places = 0;
  for (std::size_t s = 0; s < slots_.size(); ++s) {
    for (std::uint32_t i = slots_[s].first_place; i < slots_[s].end_place; ++i) pieces_[i].side += places;
    slots_[s].first_place = places;
    places += sides_of_slot[s];
    slots_[s].end_place = places;
  }
  side_of_place_.resize(places);
  std::iota(side_of_place_.begin(), side_of_place_.end(), 0u);
  first_slot_.assign(cells_.count() + 1, 0);
  for (const Slot& slot : slots_) ++first_slot_[slot.cell + 1];
  std::partial_sum(first_slot_.begin(), first_slot_.end(), first_slot_.begin());
  index_pieces();
  join_small_sides(threads);
}

void SurfaceSides::index_pieces() {
  first_piece_.assign(1, 0);
  area_of_side_m2_.clear();
  for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
    if (i == 0 || pieces_[i].side != pieces_[i - 1].side) area_of_side_m2_.push_back(0);
    area_of_side_m2_.back() += static_cast<double>(pieces_[i].area_m2);
    first_piece_.resize(area_of_side_m2_.size() + 1);
    first_piece_.back() = i + 1;
  }
}

void SurfaceSides::join_small_sides(int threads) {
  const double small_m2 = kSmallSide * cells_.voxel_m * cells_.voxel_m;
  std::vector<std::uint32_t> joined(sides());
  std::iota(joined.begin(), joined.end(), 0u);
  parallel_for(slots_.size(), threads, [&](std::size_t s) {
    for (std::uint32_t side = slots_[s].first_place; side < slots_[s].end_place; ++side) {
      if (area_of_side_m2_[side] >= small_m2) continue;
      const SurfacePiece& from = pieces_[first_piece_[side]];
      const Vec3 normal = from.normal_world.cast<double>();
      const Eigen::Vector3i here = voxel_of(slots_[s].cell);
      double largest_m2 = small_m2;
      for (int n = 0; n < 27; ++n) {
        const Eigen::Vector3i cell = here + Eigen::Vector3i(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
        if (!cells_.contains(cell)) continue;
        for (const Slot& slot : slots_of_cell(static_cast<std::uint32_t>(cells_.index(cell))))
          for (std::uint32_t other = slot.first_place; other < slot.end_place; ++other) {
            if (!(area_of_side_m2_[other] >= largest_m2) || other == side) continue;
            const SurfacePiece& to = pieces_[first_piece_[other]];
            const Vec3 other_normal = to.normal_world.cast<double>();
            if (normal.dot(other_normal) < kSameWay ||
                !sees(from.position_world_m, normal, to.position_world_m, other_normal, kLift * cells_.voxel_m))
              continue;
            largest_m2 = area_of_side_m2_[other];
            joined[side] = other;
          }
      }
    }
  });
  std::uint32_t count = 0;
  std::vector<std::uint32_t> number(sides());
  for (std::uint32_t side = 0; side < sides(); ++side)
    if (joined[side] == side) number[side] = count++;
  for (std::uint32_t& side : side_of_place_) side = number[joined[side]];
  for (SurfacePiece& piece : pieces_) piece.side = side_of_place_[piece.side];
  // Stable. A side's own pieces come before those that joined it only if their numbers did. Any of its pieces may
  // represent the side.
  std::stable_sort(pieces_.begin(), pieces_.end(),
                   [](const SurfacePiece& a, const SurfacePiece& b) { return a.side < b.side; });
  index_pieces();
}

Eigen::Vector3i SurfaceSides::voxel_of(std::uint32_t cell) const {
  const auto nx = static_cast<std::uint32_t>(cells_.size.x()), ny = static_cast<std::uint32_t>(cells_.size.y());
  return {static_cast<int>(cell % nx), static_cast<int>(cell / nx % ny), static_cast<int>(cell / nx / ny)};
}

void SurfaceSides::make_groups(int group_cells, int threads) {
  struct Member {
    std::uint64_t key;
    std::uint32_t side;
  };
  std::vector<Member> members;
  members.reserve(sides());
  const VoxelGrid wide = cells_.coarser(group_cells);
  for (std::uint32_t side = 0; side < sides(); ++side) {
    const SurfacePiece& first = pieces_[first_piece_[side]];
    const std::uint64_t cell = wide.index(wide.nearest_voxel(first.position_world_m - origin_world_m_));
    members.push_back({cell * 6 + facing_of(first.normal_world.cast<double>()) / 9, side});
  }
  std::stable_sort(members.begin(), members.end(), [](const Member& a, const Member& b) { return a.key < b.key; });
  std::vector<std::size_t> begin;
  for (std::size_t i = 0; i < members.size(); ++i)
    if (i == 0 || members[i].key != members[i - 1].key) begin.push_back(i);
  begin.push_back(members.size());
  group_of_side_.assign(sides(), 0);
  std::vector<std::uint32_t> groups_of_key(begin.size(), 0);
  parallel_for(begin.size() - 1, threads, [&](std::size_t k) {
    std::vector<std::uint32_t> first;
    for (std::size_t i = begin[k]; i < begin[k + 1]; ++i) {
      const SurfacePiece& piece = pieces_[first_piece_[members[i].side]];
      const auto seen = std::find_if(first.begin(), first.end(), [&](std::uint32_t other) {
        return sees(piece.position_world_m, piece.normal_world.cast<double>(), pieces_[other].position_world_m,
                    pieces_[other].normal_world.cast<double>(), kLift * cells_.voxel_m);
      });
      group_of_side_[members[i].side] = static_cast<std::uint32_t>(seen - first.begin());
      if (seen == first.end()) first.push_back(first_piece_[members[i].side]);
    }
    groups_of_key[k] = static_cast<std::uint32_t>(first.size());
  });
  std::uint32_t groups = 0;
  for (std::size_t k = 0; k + 1 < begin.size(); ++k) {
    for (std::size_t i = begin[k]; i < begin[k + 1]; ++i) group_of_side_[members[i].side] += groups;
    groups += groups_of_key[k];
  }
  area_of_group_m2_.assign(groups, 0.0);
  for (std::size_t s = 0; s < sides(); ++s) area_of_group_m2_[group_of_side_[s]] += area_of_side_m2_[s];
}

std::span<const SurfaceSides::Slot> SurfaceSides::slots_of_cell(std::uint32_t cell) const {
  return std::span(slots_).subspan(first_slot_[cell], first_slot_[cell + 1] - first_slot_[cell]);
}

void SurfaceSides::look_in(const Slot& slot, const Vec3& position_world_m, const Vec3& normal_world,
                           std::uint64_t& rays, Found& seen, Found& nearest) const {
  for (std::uint32_t place = slot.first_place; place < slot.end_place; ++place) {
    const std::uint32_t side = side_of_place_[place];
    const SurfacePiece* closest = nullptr;
    double distance = HUGE_VAL;
    for (const SurfacePiece& piece : pieces_of_side(side)) {
      const double d = (piece.position_world_m - position_world_m).squaredNorm();
      if (d < distance) {
        distance = d;
        closest = &piece;
      }
    }
    if (distance < nearest.distance_squared_m2) nearest = {side, distance};
    if (!(distance < seen.distance_squared_m2)) continue;
    ++rays;
    if (sees(position_world_m, normal_world, closest->position_world_m, closest->normal_world.cast<double>(),
             kLift * cells_.voxel_m))
      seen = {side, distance};
  }
}

std::uint32_t SurfaceSides::side_at(const Vec3& position_world_m, const Vec3& normal_world, std::uint64_t& rays) const {
  if (cells_.count() == 0) return kNone;
  const Eigen::Vector3i here = cells_.nearest_voxel(position_world_m - origin_world_m_);
  const std::uint32_t facing = facing_of(normal_world);
  Found seen, nearest;
  for (const Slot& slot : slots_of_cell(static_cast<std::uint32_t>(cells_.index(here)))) {
    if (slot.facing != facing) continue;
    if (slot.plain && slot.end_place - slot.first_place == 1) return side_of_place_[slot.first_place];
    look_in(slot, position_world_m, normal_world, rays, seen, nearest);
  }
  if (seen.side != kNone) return seen.side;
  // The place sees no place of its cell: it is in a corner between intersecting solids, too small for a place of its
  // own, or rounding moved it into the next cell. Places in neighbouring cells that it sees are the same surface.
  for (int n = 0; n < 27; ++n) {
    const Eigen::Vector3i cell = here + Eigen::Vector3i(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
    if (cell == here || !cells_.contains(cell)) continue;
    for (const Slot& slot : slots_of_cell(static_cast<std::uint32_t>(cells_.index(cell))))
      if (slot.facing == facing) look_in(slot, position_world_m, normal_world, rays, seen, nearest);
  }
  if (seen.side != kNone) return seen.side;
  if (nearest.side != kNone) return nearest.side;
  // Rounding moved its normal into the next part of the cube.
  for (int n = 0; n < 27; ++n) {
    const Eigen::Vector3i cell = here + Eigen::Vector3i(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
    if (!cells_.contains(cell)) continue;
    for (const Slot& slot : slots_of_cell(static_cast<std::uint32_t>(cells_.index(cell))))
      for (std::uint32_t place = slot.first_place; place < slot.end_place; ++place)
        for (const SurfacePiece& piece : pieces_of_side(side_of_place_[place])) {
          if (piece.normal_world.cast<double>().dot(normal_world) < 0.5) continue;
          const double distance = (piece.position_world_m - position_world_m).squaredNorm();
          if (distance < nearest.distance_squared_m2) nearest = {side_of_place_[place], distance};
        }
  }
  return nearest.side;
}

std::size_t SurfaceSides::bytes() const {
  return pieces_.size() * sizeof(SurfacePiece) + first_piece_.size() * 4 + slots_.size() * sizeof(Slot) +
         first_slot_.size() * 4 + sides() * (sizeof(double) + 4) + groups() * sizeof(double);
}

}  // namespace luxrig
