#include "core/transport/candidates/surface_importance.h"

#include <algorithm>
#include <cmath>

#include "core/transport/path_sampler.h"
#include "core/transport/sobol.h"

namespace luxrig {
namespace {

constexpr std::uint32_t kRaysPerReceiver = 128;
constexpr std::uint32_t kRaysPerPlace = 32;
/// Nearer than this many cells, the kernel is averaged over a cell's square instead of taken at its middle.
constexpr double kNearCells = 4;
constexpr int kNearGrid = 4;
/// Sweeps end when one changes the sum of W by less than this.
constexpr double kConverged = 1e-5;
constexpr std::uint32_t kMostSweeps = 400;

constexpr std::uint64_t kGridKey = 0x67726964, kReceiverKey = 0x72656376, kPlaceKey = 0x706c6163, kCellKey = 0x63656c6c;

Vec3 grid_offset(std::uint64_t seed) {
  const SobolSequence random(mixed(seed, kGridKey));
  const auto u = random.set(0, 0);
  return {u[0], u[1], u[2]};
}

Vec3 sphere_direction(double u, double v) {
  const double z = 1 - 2 * v, radius = std::sqrt(std::max(0.0, 1 - z * z)), angle = 2 * kPi * u;
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

}  // namespace

double diffuse_reflectance(const Material& material) {
  const double f0 = material.specular_reflectance;
  const double coat = f0 > 0 ? f0 + (1 - f0) / 21 : 0;
  return std::min(coat + (1 - coat) * material.luminous_reflectance(), 0.98);
}

SurfaceImportance::SurfaceImportance(const Scene& scene, const VisibilityScene& visibility,
                                     std::span<const Receiver> receivers, std::span<const Vec3> also_from_world_m,
                                     const ImportanceSettings& settings, const CandidateSkips& skips,
                                     const std::stop_token& stop)
    : scene_(*visibility.rays),
      receivers_(receivers),
      settings_(settings),
      stop_(stop),
      surfaces_(scene, *visibility.rays, settings.cell_m, grid_offset(settings.seed)),
      stride_((receivers.size() + 7) / 8 * 8) {
  discover(also_from_world_m);
  see_receivers(visibility, skips);
  solve();
  rays_ += surfaces_.rays_cast();
}

/// Cells that receivers see, places see, and cells see, until there are no more.
void SurfaceImportance::discover(std::span<const Vec3> also_from_world_m) {
  const auto look = [&](const Vec3& from_m, const Vec3& direction, const Vec3& normal) {
    ++rays_;
    if (const auto hit = scene_.nearest(from_m, direction, normal))
      surfaces_.cell_at(hit->position_world_m, hit->normal_world, settings_.most_cells);
  };
  for (std::size_t r = 0; r < receivers_.size(); ++r) {
    const SobolSequence samples(mixed(mixed(settings_.seed, kReceiverKey), r));
    for (std::uint32_t i = 0; i < kRaysPerReceiver; ++i) {
      const auto [u, v] = samples.pair(i, 0, 0);
      look(receivers_[r].position_world_m, cosine_direction(receivers_[r].normal_world, u, v),
           receivers_[r].normal_world);
    }
  }
  for (std::size_t p = 0; p < also_from_world_m.size() && !stop_.stop_requested(); ++p) {
    const SobolSequence samples(mixed(mixed(settings_.seed, kPlaceKey), p));
    for (std::uint32_t i = 0; i < kRaysPerPlace; ++i) {
      const auto [u, v] = samples.pair(i, 0, 0);
      look(also_from_world_m[p], sphere_direction(u, v), Vec3::Zero());
    }
  }
  for (std::uint32_t c = 0; c < surfaces_.cells().size() && !stop_.stop_requested(); ++c) trace_bounces(c);
  bounces_.resize(surfaces_.cells().size() * settings_.rays_per_cell, {SurfaceCells::kNone, 0});
}

void SurfaceImportance::trace_bounces(std::uint32_t cell) {
  const Vec3 from_m = surfaces_.cells()[cell].position_world_m, normal = surfaces_.cells()[cell].normal_world;
  const SobolSequence samples(mixed(mixed(settings_.seed, kCellKey), cell));
  for (std::uint32_t i = 0; i < settings_.rays_per_cell; ++i) {
    const auto [u, v] = samples.pair(i, 0, 0);
    ++rays_;
    const auto hit = scene_.nearest(from_m, cosine_direction(normal, u, v), normal);
    Bounce bounce{SurfaceCells::kNone, 0};
    if (hit) {
      const double reflectance = diffuse_reflectance(scene_.material_of(hit->triangle));
      if (reflectance > 0)
        bounce = {surfaces_.cell_at(hit->position_world_m, hit->normal_world, settings_.most_cells),
                  static_cast<float>(reflectance / settings_.rays_per_cell)};
    }
    bounces_.push_back(bounce);
  }
}

/// cosθr cosθy / (π d²), at the cell's place; near by, its mean over a square of the cell's size there.
double SurfaceImportance::kernel(const Receiver& receiver, const SurfaceCells::Cell& cell) const {
  const auto at = [&](const Vec3& place_m) {
    const Vec3 towards_m = place_m - receiver.position_world_m;
    const double squared_m2 = towards_m.squaredNorm();
    const double cosines = receiver.normal_world.dot(towards_m) * -cell.normal_world.dot(towards_m);
    return receiver.normal_world.dot(towards_m) > 0 && cosines > 0 ? cosines / (kPi * squared_m2 * squared_m2) : 0.0;
  };
  const double size_m = settings_.cell_m;
  if ((cell.position_world_m - receiver.position_world_m).squaredNorm() >= kNearCells * kNearCells * size_m * size_m)
    return at(cell.position_world_m);
  const Vec3 u = cell.normal_world.unitOrthogonal(), v = cell.normal_world.cross(u);
  double sum = 0;
  for (int i = 0; i < kNearGrid; ++i)
    for (int j = 0; j < kNearGrid; ++j)
      sum +=
          at(cell.position_world_m + size_m * (((i + 0.5) / kNearGrid - 0.5) * u + ((j + 0.5) / kNearGrid - 0.5) * v));
  return sum / (kNearGrid * kNearGrid);
}

void SurfaceImportance::see_receivers(const VisibilityScene& visibility, const CandidateSkips& skips) {
  const auto& cells = surfaces_.cells();
  seen_per_lumen_.assign(cells.size() * stride_, 0.0f);
  std::vector<Vec3> places_m;
  for (const auto& cell : cells) places_m.push_back(cell.position_world_m);
  const PointTree tree(places_m);
  for (std::size_t r = 0; r < receivers_.size() && !stop_.stop_requested(); ++r) {
    VisiblePoints visible(visibility, receivers_[r], skips, 0, 0);
    double value = 0;
    visible.visit(
        tree, places_m, [&](std::uint32_t c) { return (value = kernel(receivers_[r], cells[c])) > 0; },
        [&](std::uint32_t c) { seen_per_lumen_[c * stride_ + r] = static_cast<float>(value); });
    rays_ += visible.rays;
  }
}

/// Gauss and Seidel's iteration, there and back in turn.
void SurfaceImportance::solve() {
  const std::size_t count = surfaces_.cells().size(), per_cell = settings_.rays_per_cell;
  lux_per_lumen_ = seen_per_lumen_;
  std::vector<float> fresh(stride_);
  for (sweeps_ = 0; sweeps_ < kMostSweeps && !stop_.stop_requested(); ++sweeps_) {
    double change = 0, sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t c = sweeps_ % 2 == 0 ? i : count - 1 - i;
      std::copy_n(seen_per_lumen_.data() + c * stride_, stride_, fresh.data());
      for (std::size_t q = 0; q < per_cell; ++q) {
        const Bounce& bounce = bounces_[c * per_cell + q];
        if (bounce.cell == SurfaceCells::kNone) continue;
        const float* from = lux_per_lumen_.data() + bounce.cell * stride_;
        for (std::size_t r = 0; r < stride_; ++r) fresh[r] += bounce.share * from[r];
      }
      float* to = lux_per_lumen_.data() + c * stride_;
      float cell_change = 0, cell_sum = 0;
      for (std::size_t r = 0; r < stride_; ++r) {
        cell_change += std::abs(fresh[r] - to[r]);
        cell_sum += fresh[r];
        to[r] = fresh[r];
      }
      change += cell_change;
      sum += cell_sum;
    }
    if (change <= kConverged * sum) break;
  }
  live_.assign(count, 0);
  for (std::size_t c = 0; c < count; ++c)
    live_[c] = std::any_of(lux_per_lumen_.begin() + static_cast<std::ptrdiff_t>(c * stride_),
                           lux_per_lumen_.begin() + static_cast<std::ptrdiff_t>((c + 1) * stride_),
                           [](float w) { return w > 0; });
}

std::size_t SurfaceImportance::bytes() const {
  return (seen_per_lumen_.size() + lux_per_lumen_.size()) * sizeof(float) + bounces_.size() * sizeof(Bounce) +
         surfaces_.cells().size() * 3 * sizeof(SurfaceCells::Cell);
}

}  // namespace luxrig
