#include "core/goals/triangle_cut.h"

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

/// Convex. A triangle in a box has at most 3 + 6 corners; the rest is for rounding.
struct ConvexPolygon {
  std::array<Vec3, 16> corners;
  std::size_t count = 0;

  void add(const Vec3& corner) {
    if (count < corners.size()) corners[count++] = corner;
  }
  [[nodiscard]] std::pair<double, double> range(int axis) const {
    double low = corners[0][axis], high = low;
    for (std::size_t i = 1; i < count; ++i) {
      low = std::min(low, corners[i][axis]);
      high = std::max(high, corners[i][axis]);
    }
    return {low, high};
  }
};

void split(const ConvexPolygon& whole, int axis, double at, ConvexPolygon& below, ConvexPolygon& above) {
  below.count = above.count = 0;
  for (std::size_t i = 0; i < whole.count; ++i) {
    const Vec3& here = whole.corners[i];
    const Vec3& next = whole.corners[i + 1 == whole.count ? 0 : i + 1];
    if (here[axis] <= at) below.add(here);
    if (here[axis] >= at) above.add(here);
    if ((here[axis] < at && next[axis] > at) || (here[axis] > at && next[axis] < at)) {
      Vec3 crossing = here + (next - here) * ((at - here[axis]) / (next[axis] - here[axis]));
      crossing[axis] = at;
      below.add(crossing);
      above.add(crossing);
    }
  }
}

void add_piece(const ConvexPolygon& part, const std::array<std::uint32_t, 3>& cell, std::vector<CutPiece>& pieces) {
  Vec3 moment = Vec3::Zero();
  double area = 0;
  for (std::size_t i = 2; i < part.count; ++i) {
    const Vec3 &a = part.corners[0], &b = part.corners[i - 1], &c = part.corners[i];
    const double size = 0.5 * (b - a).cross(c - a).norm();
    moment += size * (a + b + c) / 3;
    area += size;
  }
  if (area > 0) pieces.push_back({cell, moment / area, area});
}

void cut_along(int axis, const ConvexPolygon& whole, std::array<std::uint32_t, 3> cell, std::vector<CutPiece>& pieces) {
  if (axis == 3) return add_piece(whole, cell, pieces);
  const auto [low, high] = whole.range(axis);
  auto slab = static_cast<std::uint32_t>(low);
  const auto last = static_cast<std::uint32_t>(high);
  if (slab == last) {
    cell[axis] = slab;
    return cut_along(axis + 1, whole, cell, pieces);
  }
  ConvexPolygon rest = whole, below, above;
  for (; slab < last; ++slab) {
    split(rest, axis, slab + 1.0, below, above);
    cell[axis] = slab;
    if (below.count > 2) cut_along(axis + 1, below, cell, pieces);
    if (above.count < 3) return;
    std::swap(rest, above);
  }
  cell[axis] = slab;
  cut_along(axis + 1, rest, cell, pieces);
}

}  // namespace

void cut_triangle(const std::array<Vec3, 3>& corners, std::vector<CutPiece>& pieces) {
  ConvexPolygon whole;
  for (const Vec3& corner : corners) whole.add(corner);
  cut_along(0, whole, {}, pieces);
}

// A surface meets as many cells as its shadows along the axes have area, a line as many as it has length along them.
double expected_pieces(const std::array<Vec3, 3>& corners) {
  const Vec3 a = corners[1] - corners[0], b = corners[2] - corners[1], c = corners[0] - corners[2];
  return 1 + 0.5 * a.cross(b).lpNorm<1>() + 0.5 * (a.lpNorm<1>() + b.lpNorm<1>() + c.lpNorm<1>());
}

}  // namespace luxrig
