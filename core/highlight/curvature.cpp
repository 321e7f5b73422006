#include "core/highlight/curvature.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/highlight/quadric_fit.h"
#include "core/highlight/sample_grid.h"
#include "core/parallel.h"

namespace luxrig {
namespace {

constexpr double kWiden = 2;             ///< once, where samples are few
constexpr double kManyNeighbours = 300;  ///< beyond so many on average, samples are merged
constexpr double kMergeCells = 8;        ///< per radius
constexpr double kPieceEdge = 1.0 / 3;   ///< of the radius: edges of what long facets are cut into
constexpr double kMostPieces = 4096;     ///< of one facet; one that would need more counts by its corners alone
constexpr double kOneSided = 0.6;        ///< length of the mean normal of a neighbourhood that is not two sheets
constexpr double kRefitTilt = 0.1;       ///< slope of the fit from which on it is made again over its own plane
constexpr std::size_t kPointsPerTask = 256;

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

std::vector<SurfaceSample> samples_of(const TargetSurface& surface, double radius_m) {
  std::vector<double> areas_m2 = surface.areas_m2;
  std::vector<SurfaceSample> pieces;
  const double edge_m = kPieceEdge * radius_m;
  for (const auto& t : surface.triangles) {
    const std::array<Vec3, 3> p = {surface.points_m[t[0]], surface.points_m[t[1]], surface.points_m[t[2]]};
    const double longest_m =
        std::sqrt(std::max({(p[1] - p[0]).squaredNorm(), (p[2] - p[1]).squaredNorm(), (p[0] - p[2]).squaredNorm()}));
    if (longest_m <= radius_m) continue;
    const Vec3 cross = (p[1] - p[0]).cross(p[2] - p[0]);
    if (cross.norm() / (edge_m * edge_m) + 2 * longest_m / edge_m > kMostPieces) continue;
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

/// One point's neighbourhood after another; keeps its memory.
class Neighbourhood {
 public:
  explicit Neighbourhood(const SampleGrid& grid) : grid_(grid) {}

  Curvature fit(const Vec3& place_m, const Vec3& facing, double radius_m) {
    gather(place_m, radius_m);
    // Where all around faces much the same way, the mean normal of that; else of what faces as the point's own normal
    // does, which noise may have turned. Then that of what faces the same way as this mean.
    Vec3 first = Vec3::Zero();
    double whole = 0;
    for (const Near& sample : near_) {
      first += sample.weight * sample.normal;
      whole += sample.weight;
    }
    if (!(first.norm() > kOneSided * whole)) {
      const std::optional<Vec3> own = mean_normal(facing);
      if (!own) return {};
      first = *own;
    }
    const std::optional<Vec3> second = mean_normal(first);
    if (!second) return {};
    Vec3 up = *second;
    for (int pass = 0; pass < 2; ++pass) {
      const std::optional<QuadricFit> quadric = fit_over(up);
      if (!quadric) return {};
      const Eigen::Matrix<double, 6, 1>& c = quadric->coefficients;
      const Vec3 normal = (up - c(1) * x_ - c(2) * y_).normalized();
      if (pass == 0 && std::hypot(c(1), c(2)) > kRefitTilt) {
        up = normal;
        continue;
      }
      const PrincipalCurvatures k = principal_curvatures(c);
      const auto world = [&](const Vec3& v) { return Vec3(v.x() * x_ + v.y() * y_ + v.z() * up).normalized(); };
      return {radius_m,
              k.larger / radius_m,
              k.smaller / radius_m,
              world(k.larger_direction),
              world(k.smaller_direction),
              normal,
              quadric->mean_bend_error / radius_m};
    }
    return {};
  }

 private:
  struct Near {
    Vec3 offset;  ///< from the point, in radii
    Vec3 normal;
    double weight;
  };

  void gather(const Vec3& place_m, double radius_m) {
    near_.clear();
    grid_.near(place_m, radius_m, stretches_);
    double most = 0;
    for (const auto& stretch : stretches_) {
      for (const SurfaceSample& sample : stretch) {
        const Vec3 offset = (sample.position_m - place_m) / radius_m;
        const double left = 1 - offset.squaredNorm();
        if (left <= 0) continue;
        near_.push_back({offset, sample.normal, sample.area_m2 * left * left});
        most = std::max(most, near_.back().weight);
      }
    }
    if (most > 0)
      for (Near& sample : near_) sample.weight /= most;
  }

  [[nodiscard]] std::optional<Vec3> mean_normal(const Vec3& facing) const {
    Vec3 sum = Vec3::Zero();
    for (const Near& sample : near_)
      if (sample.normal.dot(facing) > 0) sum += sample.weight * sample.normal;
    if (!(sum.norm() > 1e-9)) return std::nullopt;
    return sum.normalized();
  }

  [[nodiscard]] std::optional<QuadricFit> fit_over(const Vec3& up) {
    x_ = up.unitOrthogonal();
    y_ = up.cross(x_);
    QuadricSums sums;
    for (const Near& sample : near_)
      if (sample.weight > 0 && sample.normal.dot(up) > 0)
        sums.add(sample.weight, sample.offset.dot(x_), sample.offset.dot(y_), sample.offset.dot(up));
    return sums.fit();
  }

  const SampleGrid& grid_;
  std::vector<std::span<const SurfaceSample>> stretches_;
  std::vector<Near> near_;
  Vec3 x_ = Vec3::UnitX(), y_ = Vec3::UnitY();
};

}  // namespace

double suggested_curvature_radius_m(const TargetSurface& surface) {
  if (surface.triangles.empty()) return 0;
  return std::max(0.015 * surface.diagonal_m(), 2.5 * surface.median_edge_m());
}

Result<std::vector<Curvature>> curvature_of(const TargetSurface& surface, const CurvatureOptions& options) {
  const double radius_m = options.radius_m;
  if (!(radius_m > 0) || !std::isfinite(radius_m))
    return refusal(fmt::format("curvature needs a radius above 0 m, not {}", radius_m));
  const std::size_t count = surface.points_m.size();
  std::vector<Curvature> curvatures(count);
  if (count == 0) return curvatures;

  std::vector<SurfaceSample> samples = samples_of(surface, radius_m);
  // Of the samples, how many are within a radius of one: the mean over some of them.
  {
    const SampleGrid grid(samples, radius_m);
    std::vector<std::span<const SurfaceSample>> stretches;
    const std::size_t step = std::max<std::size_t>(1, count / 256);
    double near = 0, asked = 0;
    for (std::size_t i = 0; i < count; i += step, ++asked) {
      grid.near(surface.points_m[i], radius_m, stretches);
      for (const auto& stretch : stretches)
        for (const SurfaceSample& sample : stretch)
          if ((sample.position_m - surface.points_m[i]).squaredNorm() < radius_m * radius_m) ++near;
    }
    if (near > kManyNeighbours * asked) samples = merged_in_cells(samples, radius_m / kMergeCells);
  }
  const SampleGrid grid(std::move(samples), radius_m);

  // Neighbours one after another, so that they find their samples in the cache.
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  std::vector<std::array<std::int32_t, 3>> cells(count);
  for (std::size_t i = 0; i < count; ++i) cells[i] = grid.cell_of(surface.points_m[i]);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t i, std::uint32_t j) { return cells[i] != cells[j] ? cells[i] < cells[j] : i < j; });
  const std::size_t tasks = (count + kPointsPerTask - 1) / kPointsPerTask;
  parallel_for(tasks, options.threads, [&](std::size_t task) {
    if (options.stop.stop_requested()) return;
    Neighbourhood neighbourhood(grid);
    for (std::size_t k = task * kPointsPerTask; k < std::min(count, (task + 1) * kPointsPerTask); ++k) {
      const std::uint32_t i = order[k];
      if (surface.normals[i].isZero(0)) continue;
      curvatures[i] = neighbourhood.fit(surface.points_m[i], surface.normals[i], radius_m);
      if (!curvatures[i].known())
        curvatures[i] = neighbourhood.fit(surface.points_m[i], surface.normals[i], kWiden * radius_m);
    }
  });
  if (options.stop.stop_requested()) return tl::unexpected(Fault{Cause::cancelled, "", "curvature was stopped", {}});
  return curvatures;
}

}  // namespace luxrig
