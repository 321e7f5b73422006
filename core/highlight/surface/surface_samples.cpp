#include "core/highlight/surface/surface_samples.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace luxrig {
namespace {

/// Cuts a triangle at its longest edge until no edge is longer than `edge_m`.
void cut_up(const std::array<Vec3, 3>& p, const Vec3& normal, double edge_m, std::vector<SurfaceSample>& samples) {
  std::size_t longest = 0;
  double length2 = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double here2 = (p[(i + 1) % 3] - p[i]).squaredNorm();
    if (here2 > length2) {
      length2 = here2;
      longest = i;
    }
  }
  const Vec3 &a = p[longest], &b = p[(longest + 1) % 3], &c = p[(longest + 2) % 3];
  if (length2 <= edge_m * edge_m) {
    samples.push_back({(a + b + c) / 3, normal, (b - a).cross(c - a).norm() / 2});
    return;
  }
  const Vec3 middle = (a + b) / 2;
  cut_up({a, middle, c}, normal, edge_m, samples);
  cut_up({middle, b, c}, normal, edge_m, samples);
}

/// Pieces of a facet: those for its area, plus those along it if it is thin.
double pieces_of(double area_m2, double longest_edge_m, double edge_m) {
  return 2 * area_m2 / (edge_m * edge_m) + 2 * longest_edge_m / edge_m;
}

double longest_edge_of(const std::array<Vec3, 3>& p) {
  return std::sqrt(std::max({(p[1] - p[0]).squaredNorm(), (p[2] - p[1]).squaredNorm(), (p[0] - p[2]).squaredNorm()}));
}

}  // namespace

double pieces_of_surface(const TargetSurface& surface, double longest_m, double edge_m) {
  double pieces = 0;
  for (const auto& t : surface.triangles) {
    const std::array<Vec3, 3> p = {surface.points_m[t[0]], surface.points_m[t[1]], surface.points_m[t[2]]};
    const double longest_edge_m = longest_edge_of(p);
    if (longest_edge_m > longest_m)
      pieces += pieces_of((p[1] - p[0]).cross(p[2] - p[0]).norm() / 2, longest_edge_m, edge_m);
  }
  return pieces;
}

std::vector<SurfaceSample> surface_samples(const TargetSurface& surface, double longest_m, double edge_m,
                                           double max_pieces) {
  std::vector<double> areas_m2 = surface.areas_m2;
  std::vector<SurfaceSample> pieces;
  for (const auto& t : surface.triangles) {
    const std::array<Vec3, 3> p = {surface.points_m[t[0]], surface.points_m[t[1]], surface.points_m[t[2]]};
    const double longest_edge_m = longest_edge_of(p);
    if (longest_edge_m <= longest_m) continue;
    const Vec3 cross = (p[1] - p[0]).cross(p[2] - p[0]);
    if (pieces_of(cross.norm() / 2, longest_edge_m, edge_m) > max_pieces) continue;
    cut_up(p, cross.normalized(), edge_m, pieces);
    for (const std::uint32_t corner : t) areas_m2[corner] -= cross.norm() / 6;
  }
  std::vector<SurfaceSample> samples;
  samples.reserve(surface.points_m.size() + pieces.size());
  for (std::size_t i = 0; i < surface.points_m.size(); ++i)
    samples.push_back({surface.points_m[i], surface.normals[i], std::max(areas_m2[i], 0.0)});
  samples.insert(samples.end(), pieces.begin(), pieces.end());
  return samples;
}

}  // namespace luxrig
