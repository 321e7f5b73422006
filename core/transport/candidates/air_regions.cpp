#include "core/transport/candidates/air_regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <unordered_map>

#include "core/transport/sobol.h"

namespace luxrig {
namespace {

/// A surface may be off by e, and rays stop 1 e short of their ends (ray_scene.h). A point within this many e of a
/// surface may be meant to be on either side.
constexpr double kErrorsOfDoubt = 64;

struct Welded {
  std::vector<std::uint32_t> vertex_of;  ///< first vertex at the same place
};

Welded weld(const Scene& scene) {
  struct Hash {
    std::size_t operator()(const std::array<float, 3>& p) const {
      std::uint64_t h = 0;
      for (const float x : p) h = mixed(h, std::bit_cast<std::uint32_t>(x));
      return static_cast<std::size_t>(h);
    }
  };
  std::unordered_map<std::array<float, 3>, std::uint32_t, Hash> first;
  Welded welded;
  welded.vertex_of.resize(scene.vertices_m.size());
  for (std::uint32_t i = 0; i < scene.vertices_m.size(); ++i) {
    const Vec3f& v = scene.vertices_m[i];
    // Adding 0 makes -0 equal to 0.
    welded.vertex_of[i] = first.try_emplace({v.x() + 0.0f, v.y() + 0.0f, v.z() + 0.0f}, i).first->second;
  }
  return welded;
}

/// Pieces of surface, by union-find.
class Pieces {
 public:
  explicit Pieces(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a), b = root(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace

AirRegions::AirRegions(const Scene& scene) : origin_world_m_(scene.origin_world_m) {
  const auto& vertex_of = weld(scene).vertex_of;
  struct Side {
    std::uint64_t ends;
    std::uint32_t triangle;
  };
  std::vector<Side> sides;
  sides.reserve(3 * scene.triangles.size());
  const auto count = static_cast<std::uint32_t>(scene.triangles.size());
  for (std::uint32_t t = 0; t < count; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(vertex_of[scene.triangles[t][k]], vertex_of[scene.triangles[t][(k + 1) % 3]]);
      sides.push_back({static_cast<std::uint64_t>(a) << 32 | b, t});
    }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return a.ends != b.ends ? a.ends < b.ends : a.triangle < b.triangle; });
  Pieces pieces(count);
  for (std::size_t i = 1; i < sides.size(); ++i)
    if (sides[i].ends == sides[i - 1].ends) pieces.join(sides[i].triangle, sides[i - 1].triangle);
  std::vector<bool> open(count, false);
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i;
    while (end < sides.size() && sides[end].ends == sides[i].ends) ++end;
    if ((end - i) % 2 == 1) open[pieces.root(sides[i].triangle)] = true;
    i = end;
  }

  for (std::uint32_t t = 0; t < count; ++t) {
    const std::uint32_t piece = pieces.root(t);
    if (open[piece]) continue;
    if (piece == t) ++closed_pieces_;
    std::array<std::uint32_t, 3> corner;
    std::array<Vec3, 3> at_m;
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k] = vertex_of[scene.triangles[t][k]];
      at_m[k] = scene.vertices_m[corner[k]].cast<double>();
      bounds_m_.extend(at_m[k]);
    }
    const Vec3 normal = (at_m[1] - at_m[0]).cross(at_m[2] - at_m[0]);
    if (normal.z() == 0) continue;  // upright: no vertical line crosses it
    Triangle triangle{};
    triangle.key = mixed(0x6169725f72656769, piece);
    triangle.dz_dx = -normal.x() / normal.z();
    triangle.dz_dy = -normal.y() / normal.z();
    triangle.z_m = at_m[0].z() - triangle.dz_dx * at_m[0].x() - triangle.dz_dy * at_m[0].y();
    for (std::size_t k = 0; k < 3; ++k) {
      std::size_t a = k, b = (k + 1) % 3;
      if (corner[a] > corner[b]) std::swap(a, b);
      triangle.edges[k] = {at_m[a].x(), at_m[a].y(), at_m[b].x(), at_m[b].y()};
    }
    triangles_.push_back(triangle);
  }
  if (triangles_.empty()) return;

  // A grid over x and y: two passes, count and fill.
  per_side_ = std::clamp<std::size_t>(static_cast<std::size_t>(std::sqrt(triangles_.size())), 1, 512);
  const auto each_column = [&](const Triangle& triangle, auto&& visit) {
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    for (const Edge& e : triangle.edges) {
      low[0] = std::min({low[0], e.ax, e.bx}), high[0] = std::max({high[0], e.ax, e.bx});
      low[1] = std::min({low[1], e.ay, e.by}), high[1] = std::max({high[1], e.ay, e.by});
    }
    for (std::size_t y = column(low[1], 1); y <= column(high[1], 1); ++y)
      for (std::size_t x = column(low[0], 0); x <= column(high[0], 0); ++x) visit(y * per_side_ + x);
  };
  begin_.assign(per_side_ * per_side_ + 1, 0);
  for (const Triangle& triangle : triangles_) each_column(triangle, [&](std::size_t c) { ++begin_[c + 1]; });
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  listed_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::uint32_t t = 0; t < triangles_.size(); ++t)
    each_column(triangles_[t], [&](std::size_t c) { listed_[next[c]++] = t; });
}

std::size_t AirRegions::column(double at, int axis) const {
  const double low = bounds_m_.min()[axis], size = bounds_m_.max()[axis] - low;
  if (!(size > 0)) return 0;
  const double cell = (at - low) / size * static_cast<double>(per_side_);
  return static_cast<std::size_t>(std::clamp(cell, 0.0, static_cast<double>(per_side_ - 1)));
}

/// Point-in-polygon test by crossings to the right. Each edge answers equally for all triangles that share it, so that
/// a vertical line through a closed piece never slips between two of them.
bool AirRegions::over(const Triangle& triangle, double x, double y) {
  bool inside = false;
  for (const Edge& e : triangle.edges)
    if ((e.ay > y) != (e.by > y) && x < e.ax + (y - e.ay) / (e.by - e.ay) * (e.bx - e.ax)) inside = !inside;
  return inside;
}

std::uint64_t AirRegions::mark(const Vec3& point_world_m) const {
  const Vec3 p = point_world_m - origin_world_m_;
  if (triangles_.empty() || !bounds_m_.contains(p)) return 0;
  std::uint64_t mark = 0;
  const std::size_t c = column(p.y(), 1) * per_side_ + column(p.x(), 0);
  for (std::uint32_t i = begin_[c]; i < begin_[c + 1]; ++i) {
    const Triangle& t = triangles_[listed_[i]];
    if (over(t, p.x(), p.y()) && t.z_m + t.dz_dx * p.x() + t.dz_dy * p.y() > p.z()) mark ^= t.key;
  }
  return mark;
}

ReceiversAir::ReceiversAir(const Scene& scene, const RayScene& rays, std::span<const Receiver> receivers)
    : rays_(rays), regions_(scene) {
  for (const Receiver& r : receivers) {
    const double doubt_m = kErrorsOfDoubt * rays.surface_error_m(r.position_world_m);
    for (const double lifts : {0.0, 1.0, 4.0})
      marks_.push_back(regions_.mark(r.position_world_m + lifts * doubt_m * r.normal_world));
  }
  std::sort(marks_.begin(), marks_.end());
  marks_.erase(std::unique(marks_.begin(), marks_.end()), marks_.end());
}

bool ReceiversAir::reaches(const Vec3& point_world_m) const {
  const auto known = [&](const Vec3& p) { return std::binary_search(marks_.begin(), marks_.end(), regions_.mark(p)); };
  if (known(point_world_m)) return true;
  const double doubt_m = kErrorsOfDoubt * rays_.surface_error_m(point_world_m);
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      if (known(point_world_m + side * doubt_m * Vec3::Unit(axis))) return true;
  return false;
}

}  // namespace luxrig
