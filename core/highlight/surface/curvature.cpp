#include "core/highlight/surface/curvature.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/check.h"
#include "core/highlight/surface/quadric_fit.h"
#include "core/highlight/surface/surface_samples.h"
#include "core/parallel.h"

namespace luxrig {
namespace {

constexpr double kWiden = 2;             ///< once, if samples are few
constexpr double kManyNeighbours = 300;  ///< samples are merged if they average more than this
constexpr double kMergeCells = 8;        ///< per radius
constexpr double kMaxPieces = 4096;      ///< of one facet; one that needs more counts by its corners alone
constexpr double kPieceEdge = 1.0 / 3;   ///< of the radius: longest edge of the pieces of long facets
constexpr double kOneSided = 0.6;        ///< least length of the mean normal of a neighbourhood with a single sheet
constexpr double kRefitTilt = 0.1;       ///< slope of the fit above which it is repeated over its own plane
constexpr std::size_t kPointsPerTask = 256;

/// One point's neighbourhood at a time; keeps its memory.
class Neighbourhood {
 public:
  explicit Neighbourhood(const SampleGrid& grid) : grid_(grid) {}

  Curvature fit(const Vec3& place_m, const Vec3& facing, double radius_m) {
    gather(place_m, radius_m);
    // If all neighbours face much the same way: their mean normal. Otherwise the mean of those that face like the
    // point's own normal, which noise may have turned. Then the mean of those that face like that mean.
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
  return std::max(0.03 * surface.size_m(), 1.5 * surface.median_edge_m());
}

Result<std::vector<Curvature>> curvature_of(const TargetSurface& surface, const CurvatureOptions& options) {
  return curvature_at(surface, surface.points_m, surface.normals, options);
}

Result<std::vector<Curvature>> curvature_at(const TargetSurface& surface, std::span<const Vec3> places_m,
                                            std::span<const Vec3> facing, const CurvatureOptions& options) {
  LUXRIG_CHECK(places_m.size() == facing.size(), "{} places, {} normals", places_m.size(), facing.size());
  const double radius_m = options.radius_m;
  if (!(radius_m > 0) || !std::isfinite(radius_m))
    return refusal(fmt::format("curvature needs a radius above 0 m, not {}", radius_m));
  const std::size_t count = places_m.size();
  std::vector<Curvature> curvatures(count);
  if (count == 0) return curvatures;

  std::vector<SurfaceSample> samples = surface_samples(surface, radius_m, kPieceEdge * radius_m, kMaxPieces);
  // Mean number of samples within a radius, estimated from some of them.
  {
    const SampleGrid grid(samples, radius_m);
    std::vector<std::span<const SurfaceSample>> stretches;
    const std::size_t step = std::max<std::size_t>(1, count / 256);
    double near = 0, asked = 0;
    for (std::size_t i = 0; i < count; i += step, ++asked) {
      grid.near(places_m[i], radius_m, stretches);
      for (const auto& stretch : stretches)
        for (const SurfaceSample& sample : stretch)
          if ((sample.position_m - places_m[i]).squaredNorm() < radius_m * radius_m) ++near;
    }
    if (near > kManyNeighbours * asked) samples = merged_in_cells(samples, radius_m / kMergeCells);
  }
  const SampleGrid grid(std::move(samples), radius_m);

  // Neighbours in sequence, so that their samples are in the cache.
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  std::vector<std::array<std::int32_t, 3>> cells(count);
  for (std::size_t i = 0; i < count; ++i) cells[i] = grid.cell_of(places_m[i]);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t i, std::uint32_t j) { return cells[i] != cells[j] ? cells[i] < cells[j] : i < j; });
  const std::size_t tasks = (count + kPointsPerTask - 1) / kPointsPerTask;
  parallel_for(tasks, options.threads, [&](std::size_t task) {
    if (options.watch.stop.stop_requested()) return;
    Neighbourhood neighbourhood(grid);
    for (std::size_t k = task * kPointsPerTask; k < std::min(count, (task + 1) * kPointsPerTask); ++k) {
      const std::uint32_t i = order[k];
      if (facing[i].isZero(0)) continue;
      curvatures[i] = neighbourhood.fit(places_m[i], facing[i], radius_m);
      if (!curvatures[i].known()) curvatures[i] = neighbourhood.fit(places_m[i], facing[i], kWiden * radius_m);
    }
  });
  if (options.watch.stop.stop_requested())
    return tl::unexpected(Fault{Cause::cancelled, "", "curvature was stopped", {}});
  return curvatures;
}

}  // namespace luxrig
