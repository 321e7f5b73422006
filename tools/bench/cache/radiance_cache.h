#pragma once
/// The light of a scene stored in cells, so that a changed lamp costs little. Everything that depends on scene and
/// receivers alone is computed once. Each set of emitters then needs only its first hits and sums.
///
///   build       voxels, cells, the cells that each receiver reads, the exchange between cells
///   evaluate    light-view samples of each emitter into the cells, reflections between cells, sums at the receivers
///
/// The direct part is that of direct_light.h. The reflected part has two errors, and both are reported:
///   samples     kCacheReplicates independent sets of gather rays and light-view samples give as many estimates. Their
///               spread gives the error of the mean (for directions: of light-view samples and receiving places)
///   resolution  the same light is also read from cells several times as large; the difference shows how much the
///               cells' size still matters. It is spread over the replicates with alternating signs, so that
///               TransportMatrix::standard_error_lux() is the root of the sum of squares of both.
///
/// source   A. Gkaravelis, thesis §3.2; K. Vardis, G. Papaioannou, A. Gkaravelis, "Real-time radiance caching using
///          chrominance compression", JCGT 3(4), 2014

#include <cstdint>
#include <memory>
#include <span>

#include "core/run.h"
#include "core/scene/scene.h"
#include "core/transport/evaluator.h"
#include "tools/bench/cache/cache_settings.h"

namespace luxrig {

inline constexpr std::size_t kCacheReplicates = 8;

/// Contents and cost of a cache.
struct CacheReport {
  std::size_t cells = 0;                ///< with light (sides, with CacheContents::sides)
  std::size_t cells_near_surfaces = 0;  ///< with light, if none were left out
  std::size_t links = 0;                ///< from cell to cell
  std::size_t bytes = 0;                ///< kept after building
  std::uint64_t rays = 0;               ///< traced while building
};

class RadianceCache {
 public:
  struct BuildOptions : Run {};

  /// Computes everything that does not depend on emitters. `scene` is the source of `rays`. `rays` must outlive the
  /// cache; the scene need not. Cause::cancelled when stopped. Cause::invalid if a setting is out of its range, or if
  /// the scene is so much larger than the part that receivers see that rounding hides the thickness of walls.
  [[nodiscard]] static Result<RadianceCache> build(const Scene& scene, const RayScene& rays,
                                                   std::span<const Receiver> receivers, const CacheSettings& settings,
                                                   const BuildOptions& options);
  ~RadianceCache();
  RadianceCache(RadianceCache&&) noexcept;
  RadianceCache& operator=(RadianceCache&&) noexcept;

  /// T for the receivers that the cache was built for. options.wanted_relative_error and max_rays are ignored: the
  /// settings decide, except for the direct part of luminaires with size and skies. Linear: column j depends on emitter
  /// j only. Errors as Evaluator::evaluate.
  [[nodiscard]] Result<TransportMatrix> evaluate(std::span<const Emitter> emitters,
                                                 const EvaluateOptions& options) const;

  [[nodiscard]] CacheReport report() const;

  class Method;  ///< storage of light in cells: SideCache or DirectionCache

 private:
  explicit RadianceCache(std::unique_ptr<Method> method);
  std::unique_ptr<Method> method_;
};

/// An Evaluator that builds a cache for each call. It refines its settings, starting from `settings`, until the
/// estimated error is the wanted one, up to 16 times the rays and twice the cells per axis. Keeps references: scene and
/// rays must outlive it.
[[nodiscard]] std::unique_ptr<Evaluator> make_cache_evaluator(const Scene& scene, const RayScene& rays,
                                                              const CacheSettings& settings = {});

}  // namespace luxrig
