#pragma once
/// Shared by both kinds of cache.

#include "core/transport/direct/emitter_sampler.h"
#include "tools/bench/cache/radiance_cache.h"

namespace luxrig {

/// Reflected light by a method's estimate: receivers × emitters, per transported channel.
struct ReflectedLight {
  /// One matrix if all surfaces are grey (light of each primary, and of their sum). Else one per linear Rec. 709
  /// primary, for an emitter of that colour.
  std::vector<Eigen::MatrixXd> lux_per_level;
  /// Luminance of independent estimates, kCacheReplicates of them.
  std::vector<Eigen::MatrixXd> replicates;
  /// Luminance of the same light with coarser cells.
  Eigen::MatrixXd coarser;
  /// The error of `lux_per_level` from its resolution, as a share of its difference from `coarser`.
  double share_of_difference = 0;
  std::uint64_t rays = 0;
};

class RadianceCache::Method {
 public:
  virtual ~Method() = default;
  /// Empty when stopped.
  [[nodiscard]] virtual std::optional<ReflectedLight> reflected(std::span<const Emitter> emitters,
                                                                const EvaluateOptions& options) const = 0;
  [[nodiscard]] virtual CacheReport report() const = 0;

  const RayScene* rays = nullptr;
  std::vector<Receiver> receivers;
};

/// Weights of the linear Rec. 709 primaries in luminance.
inline const Vec3 kLuminanceOfRgb(0.2126, 0.7152, 0.0722);

/// True if every material reflects all primaries alike.
[[nodiscard]] bool all_grey(const Scene& scene);

using BuiltMethod = Result<std::unique_ptr<RadianceCache::Method>>;
[[nodiscard]] BuiltMethod build_side_cache(const Scene& scene, const RayScene& rays,
                                           std::span<const Receiver> receivers, const CacheSettings& settings,
                                           const RadianceCache::BuildOptions& options);
[[nodiscard]] BuiltMethod build_direction_cache(const Scene& scene, const RayScene& rays,
                                                std::span<const Receiver> receivers, const CacheSettings& settings,
                                                const RadianceCache::BuildOptions& options);

}  // namespace luxrig
