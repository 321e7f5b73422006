#pragma once
/// The gain of each part of the radiance cache: its switches one by one, and its ways through voxels side by side. The
/// cache has no clock: the caller passes one in.

#include <functional>
#include <string>
#include <vector>

#include "tools/bench/cache/radiance_cache.h"

namespace luxrig {

/// Seconds since some fixed moment.
using StopWatch = std::function<double()>;

struct NamedCacheSettings {
  std::string name;
  CacheSettings settings;
};

/// First the default and its variants with one part changed each. Then the thesis's method and its variants with one
/// part changed each, and with one improvement after another, each added to the previous ones.
[[nodiscard]] std::vector<NamedCacheSettings> cache_ablation_settings();

struct AblationRow {
  std::string setting;
  double build_seconds = 0;         ///< once for a scene and its receivers
  double evaluate_seconds = 0;      ///< for all emitters, with the direct part
  double changed_lamp_seconds = 0;  ///< for the first emitter alone
  CacheReport report;
  double rms_error = 0;       ///< root mean square over receivers of (lux - reference) / reference
  double mean_error = 0;      ///< mean of the same: the bias
  double reported_error = 0;  ///< root mean square of the reported standard error / reference
};

/// One row per entry of `settings`, all levels 1.
/// reference_lux   per receiver, from a converged evaluator; receivers with 0 are left out of the errors
/// Cause::cancelled when stopped, else as RadianceCache.
[[nodiscard]] Result<std::vector<AblationRow>> run_cache_ablation(
    const Scene& scene, const RayScene& rays, std::span<const Receiver> receivers, std::span<const Emitter> emitters,
    const Eigen::VectorXd& reference_lux, std::span<const NamedCacheSettings> settings, const StopWatch& seconds,
    const EvaluateOptions& options);

struct TraversalRow {
  std::string name;
  double seconds_per_ray = 0;
  double missed = 0;    ///< share of blocked rays that this way lets through
  double invented = 0;  ///< share of free rays that this way blocks
};

/// Lines between random places near surfaces: whether a surface is in between, by each way through voxels and by exact
/// rays, which count as right. As in the cache, the ends of lines through voxels are a cell (four voxels) off.
/// voxels   of the geometry volume, along the longest side
[[nodiscard]] std::vector<TraversalRow> compare_traversals(const Scene& scene, const RayScene& rays, int voxels,
                                                           std::size_t lines, std::uint64_t seed,
                                                           const StopWatch& seconds);

}  // namespace luxrig
