#include "tools/bench/cache/radiance_cache.h"

#include <fmt/format.h>

#include <cmath>

#include "core/transport/direct/direct_light.h"
#include "core/transport/error_floor.h"
#include "core/transport/progress.h"
#include "core/transport/replicate_error.h"
#include "tools/bench/cache/cache_method.h"

namespace luxrig {
namespace {

Result<void> check(const CacheSettings& s) {
  struct Range {
    const char* name;
    int value, least, most;
  };
  const Range ranges[] = {{"voxels", s.voxels, 16, 1024},
                          {"reduction", s.reduction, 1, 16},
                          {"light_samples", s.light_samples, 1, 1 << 24},
                          {"reflections", s.reflections, 0, 1000},
                          {"gather_rays", s.gather_rays, 1, 1 << 24},
                          {"group_cells", s.group_cells, 1, 64},
                          {"group_rays", s.group_rays, 1, 1 << 20},
                          {"first_steps", s.first_steps, 1, 10000},
                          {"link_steps", s.link_steps, 1, 10000},
                          {"link_rays", s.link_rays, 1, 1 << 16},
                          {"luminance_order", s.luminance_order, 1, 3},
                          {"chrominance_order", s.chrominance_order, 1, s.luminance_order},
                          {"hemisphere_samples", s.hemisphere_samples, 1, 10000}};
  for (const Range& r : ranges)
    if (r.value < r.least || r.value > r.most)
      return refusal(fmt::format("radiance cache: {} is {}; it must be {} to {}", r.name, r.value, r.least, r.most));
  return {};
}

}  // namespace

bool all_grey(const Scene& scene) {
  for (const Material& m : scene.materials)
    if (m.reflectance_rgb.x() != m.reflectance_rgb.y() || m.reflectance_rgb.x() != m.reflectance_rgb.z()) return false;
  return true;
}

RadianceCache::RadianceCache(std::unique_ptr<Method> method) : method_(std::move(method)) {}
RadianceCache::~RadianceCache() = default;
RadianceCache::RadianceCache(RadianceCache&&) noexcept = default;
RadianceCache& RadianceCache::operator=(RadianceCache&&) noexcept = default;

CacheReport RadianceCache::report() const { return method_->report(); }

Result<RadianceCache> RadianceCache::build(const Scene& scene, const RayScene& rays,
                                           std::span<const Receiver> receivers, const CacheSettings& settings,
                                           const BuildOptions& options) {
  if (auto checked = check(settings); !checked) return tl::unexpected(std::move(checked.error()));
  if (rays.has_panes())
    return refusal("the radiance cache knows no glass, and the scene has panes: choose the model path or gather");
  EvaluateOptions of_receivers;
  if (auto checked = check_evaluation(receivers, {}, of_receivers); !checked)
    return tl::unexpected(std::move(checked.error()));
  auto method = settings.contents == CacheContents::sides
                    ? build_side_cache(scene, rays, receivers, settings, options)
                    : build_direction_cache(scene, rays, receivers, settings, options);
  if (!method) return tl::unexpected(std::move(method.error()));
  return RadianceCache(std::move(*method));
}

Result<TransportMatrix> RadianceCache::evaluate(std::span<const Emitter> emitters,
                                                const EvaluateOptions& options) const {
  const std::vector<Receiver>& receivers = method_->receivers;
  if (auto checked = check_evaluation(receivers, emitters, options); !checked)
    return tl::unexpected(std::move(checked.error()));
  const bool reflects = obstacles_in(*method_->rays) && !emitters.empty() && !receivers.empty();
  auto direct = direct_light(*method_->rays, receivers, emitters, options, reflects ? 0.5 : 1.0);
  if (!direct) return tl::unexpected(std::move(direct.error()));
  TransportMatrix matrix;
  matrix.direct_lux_per_level = std::move(direct->lux_per_level);
  matrix.lux_per_level = matrix.direct_lux_per_level;
  matrix.rays = direct->rays;
  const auto colour_of = [&](int c) {
    Eigen::RowVectorXd colour(static_cast<Eigen::Index>(emitters.size()));
    for (std::size_t e = 0; e < emitters.size(); ++e) colour[static_cast<Eigen::Index>(e)] = emitters[e].colour_rgb[c];
    return colour;
  };
  const auto coloured = [&](const Eigen::MatrixXd& lux, int c) -> Eigen::MatrixXd {
    return lux.array().rowwise() * colour_of(c).array();
  };
  if (!reflects) {
    matrix.replicates = std::move(direct->replicates);
    matrix.relative_error = direct->relative_error;
    matrix.floor_lx = direct->floor_lx;
    if (options.colour)
      for (int c = 0; c < 3; ++c) matrix.rgb_per_level.push_back(coloured(matrix.direct_lux_per_level, c));
    return matrix;
  }
  auto light = method_->reflected(emitters, options);
  if (!light) return tl::unexpected(Fault{Cause::cancelled, "", "stopped while evaluating the radiance cache", {}});
  matrix.rays += light->rays;
  // Illuminance is never negative; harmonics can make it negative where it is nearly zero.
  for (Eigen::MatrixXd& lux : light->lux_per_level) lux = lux.cwiseMax(0.0);
  Eigen::MatrixXd reflected = Eigen::MatrixXd::Zero(matrix.receivers(), matrix.emitters());
  const bool grey = light->lux_per_level.size() == 1;
  for (int c = 0; c < (grey ? 1 : 3); ++c)
    reflected += (grey ? 1.0 : kLuminanceOfRgb[c]) * light->lux_per_level[static_cast<std::size_t>(c)];
  matrix.lux_per_level += reflected;
  if (options.colour)
    for (int c = 0; c < 3; ++c)
      matrix.rgb_per_level.push_back(
          coloured(matrix.direct_lux_per_level, c) +
          (grey ? coloured(reflected, c) : light->lux_per_level[static_cast<std::size_t>(c)]));

  // Replicates around the answer, plus the resolution's error in a pattern with that standard error. If the direct part
  // has its own replicates, the number is theirs, and the reflected ones repeat, scaled to keep their standard error.
  const std::size_t count = std::max(kCacheReplicates, direct->replicates.size());
  const double n = static_cast<double>(count), repeats = n / static_cast<double>(kCacheReplicates);
  constexpr double kOf = static_cast<double>(kCacheReplicates - 1);
  const double scale = std::sqrt(n * (n - 1) / (repeats * static_cast<double>(kCacheReplicates) * kOf)) *
                       student_t_975(kOf) / student_t_975(n - 1);
  const double amplitude = std::sqrt(n - 1) * 1.959963984540054 / student_t_975(n - 1);
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(matrix.receivers(), matrix.emitters());
  for (const Eigen::MatrixXd& replicate : light->replicates) mean += replicate / static_cast<double>(kCacheReplicates);
  const Eigen::MatrixXd resolution = light->share_of_difference * (reflected - light->coarser);
  for (std::size_t k = 0; k < count; ++k) {
    Eigen::MatrixXd& replicate =
        matrix.replicates.emplace_back(matrix.lux_per_level + scale * (light->replicates[k % kCacheReplicates] - mean) +
                                       (k % 2 == 0 ? amplitude : -amplitude) * resolution);
    if (!direct->replicates.empty()) replicate += direct->replicates[k] - matrix.direct_lux_per_level;
  }

  Eigen::VectorXd levels = Eigen::VectorXd::Ones(matrix.emitters());
  for (std::size_t e = 0; e < options.levels.size(); ++e) levels[static_cast<Eigen::Index>(e)] = options.levels[e];
  const Eigen::VectorXd lux = matrix.lux(levels), error_lx = matrix.standard_error_lux(levels);
  matrix.floor_lx = error_floor_lx(options, {lux.data(), static_cast<std::size_t>(lux.size())});
  for (Eigen::Index r = 0; r < matrix.receivers(); ++r) {
    const double scale_lx = std::max(lux[r], matrix.floor_lx);
    if (scale_lx > 0) matrix.relative_error = std::max(matrix.relative_error, error_lx[r] / scale_lx);
  }
  if (options.watch.progress) options.watch.progress(1.0);
  return matrix;
}

}  // namespace luxrig
