#include "core/highlight/surface/target_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>
#include <utility>

namespace luxrig {
namespace {

/// A triangle whose height is below this share of its longest edge has no area: in floats that is rounding.
constexpr double kFlattest = 1e-7;

/// Vertices nearer than this share of the mesh's largest coordinate are one: float rounding may have separated them.
constexpr double kSamePlace = 3e-7;

/// For each vertex the first vertex at the same place.
std::vector<std::uint32_t> first_at_same_place(const std::vector<Vec3f>& vertices_m) {
  double largest_m = 0;
  for (const Vec3f& v : vertices_m) largest_m = std::max<double>(largest_m, v.cwiseAbs().maxCoeff());
  const double tolerance_m = std::max(kSamePlace * largest_m, 1e-30), cell_m = 8 * tolerance_m;
  using Cell = std::array<std::int64_t, 3>;
  const auto cell_of = [&](const Vec3& p) {
    Cell cell;
    for (int axis = 0; axis < 3; ++axis)
      cell[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(std::floor(p[axis] / cell_m));
    return cell;
  };
  const auto hash = [](const Cell& cell) {
    std::uint64_t h = 0;
    for (const std::int64_t i : cell) h = (h ^ static_cast<std::uint64_t>(i)) * 0x9E3779B97F4A7C15ull + (h >> 29);
    return static_cast<std::size_t>(h ^ (h >> 31));
  };
  // Heads of the lists of first vertices, one per cell.
  std::unordered_map<Cell, std::uint32_t, decltype(hash)> head(2 * vertices_m.size(), hash);
  std::vector<std::uint32_t> next(vertices_m.size(), TargetSurface::kNone), first(vertices_m.size());
  for (std::uint32_t i = 0; i < vertices_m.size(); ++i) {
    const Vec3 p = vertices_m[i].cast<double>();
    const Cell low = cell_of(p - Vec3::Constant(tolerance_m)), high = cell_of(p + Vec3::Constant(tolerance_m));
    first[i] = i;
    Cell at;
    for (at[0] = low[0]; at[0] <= high[0]; ++at[0])
      for (at[1] = low[1]; at[1] <= high[1]; ++at[1])
        for (at[2] = low[2]; at[2] <= high[2]; ++at[2])
          if (const auto found = head.find(at); found != head.end())
            for (std::uint32_t k = found->second; k != TargetSurface::kNone; k = next[k])
              if ((vertices_m[k].cast<double>() - p).norm() <= tolerance_m) first[i] = std::min(first[i], k);
    if (first[i] != i) continue;
    const auto [place, fresh] = head.try_emplace(cell_of(p), i);
    if (!fresh) next[i] = std::exchange(place->second, i);
  }
  return first;
}

void add_rings(TargetSurface& surface) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(6 * surface.triangles.size());
  for (const auto& t : surface.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      edges.emplace_back(t[i], t[(i + 1) % 3]);
      edges.emplace_back(t[(i + 1) % 3], t[i]);
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  surface.ring_begin_.assign(surface.points_m.size() + 1, 0);
  surface.rings_.reserve(edges.size());
  for (const auto& [from, to] : edges) {
    ++surface.ring_begin_[from + 1];
    surface.rings_.push_back(to);
  }
  std::partial_sum(surface.ring_begin_.begin(), surface.ring_begin_.end(), surface.ring_begin_.begin());
}

}  // namespace

double TargetSurface::area_m2() const { return std::accumulate(areas_m2.begin(), areas_m2.end(), 0.0); }

Vec3 TargetSurface::centroid_world_m() const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < points_m.size(); ++i) sum += areas_m2[i] * points_m[i];
  const double all_m2 = area_m2();
  return all_m2 > 0 ? Vec3(origin_world_m + sum / all_m2) : origin_world_m;
}

double TargetSurface::diagonal_m() const {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : points_m) box.extend(p);
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

double TargetSurface::size_m() const {
  const Vec3 middle_m = centroid_world_m() - origin_world_m;
  double sum = 0, all_m2 = 0;
  for (const auto& t : triangles) {
    const Vec3 a = points_m[t[0]] - middle_m, b = points_m[t[1]] - middle_m, c = points_m[t[2]] - middle_m;
    const double area_m2 = (b - a).cross(c - a).norm() / 2;
    // Mean squared distance over a triangle, from its corners.
    sum += area_m2 * (a.squaredNorm() + b.squaredNorm() + c.squaredNorm() + (a + b + c).squaredNorm()) / 12;
    all_m2 += area_m2;
  }
  return all_m2 > 0 ? std::sqrt(12 * sum / all_m2) : 0;
}

double TargetSurface::median_edge_m() const {
  std::vector<double> lengths;
  lengths.reserve(3 * triangles.size());
  for (const auto& t : triangles)
    for (std::size_t i = 0; i < 3; ++i) lengths.push_back((points_m[t[i]] - points_m[t[(i + 1) % 3]]).norm());
  if (lengths.empty()) return 0;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

Result<TargetSurface> make_target_surface(const Scene& target) {
  for (std::size_t i = 0; i < target.vertices_m.size(); ++i)
    if (!target.vertices_m[i].allFinite()) return refusal(fmt::format("vertex {} of the target is not finite", i));
  for (std::size_t i = 0; i < target.triangles.size(); ++i)
    for (const std::uint32_t vertex : target.triangles[i])
      if (vertex >= target.vertices_m.size())
        return refusal(
            fmt::format("triangle {} of the target uses vertex {} of {}", i, vertex, target.vertices_m.size()));

  TargetSurface surface;
  surface.origin_world_m = target.origin_world_m;
  const std::vector<std::uint32_t> first = first_at_same_place(target.vertices_m);
  struct Piece {
    Vec3 normal;
    std::array<double, 3> angles;
    double area_m2;
  };
  std::vector<Piece> pieces;
  std::vector<std::uint8_t> used(target.vertices_m.size(), 0);
  for (const auto& triangle : target.triangles) {
    const std::array<std::uint32_t, 3> t = {first[triangle[0]], first[triangle[1]], first[triangle[2]]};
    std::array<Vec3, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = target.vertices_m[t[i]].cast<double>();
    const Vec3 cross = (p[1] - p[0]).cross(p[2] - p[0]);
    const double twice = cross.norm();
    double longest2 = 0;
    for (std::size_t i = 0; i < 3; ++i) longest2 = std::max(longest2, (p[(i + 1) % 3] - p[i]).squaredNorm());
    if (!(twice > kFlattest * longest2)) continue;
    Piece piece{cross / twice, {}, twice / 2};
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 a = p[(i + 1) % 3] - p[i], b = p[(i + 2) % 3] - p[i];
      piece.angles[i] = std::atan2(twice, a.dot(b));
      used[t[i]] = 1;
    }
    pieces.push_back(piece);
    surface.triangles.push_back(t);
  }

  std::vector<std::uint32_t> point_of(target.vertices_m.size(), TargetSurface::kNone);
  for (std::uint32_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    point_of[v] = static_cast<std::uint32_t>(surface.points_m.size());
    surface.points_m.push_back(target.vertices_m[v].cast<double>());
  }
  surface.point_of_vertex.resize(target.vertices_m.size());
  for (std::size_t v = 0; v < first.size(); ++v) surface.point_of_vertex[v] = point_of[first[v]];
  surface.normals.assign(surface.points_m.size(), Vec3::Zero());
  surface.areas_m2.assign(surface.points_m.size(), 0);
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      std::uint32_t& corner = surface.triangles[k][i];
      corner = point_of[corner];
      surface.normals[corner] += pieces[k].angles[i] * pieces[k].normal;
      surface.areas_m2[corner] += pieces[k].area_m2 / 3;
    }
  }
  for (Vec3& normal : surface.normals) {
    const double length = normal.norm();
    normal = length > 1e-6 ? Vec3(normal / length) : Vec3::Zero();
  }
  add_rings(surface);
  return surface;
}

}  // namespace luxrig
