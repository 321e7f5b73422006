#include <algorithm>
#include <optional>

#include "core/transport/direct/emitter_sampler.h"
#include "tools/bench/cache/radiance_cache.h"

namespace luxrig {
namespace {

/// Refinements: each takes four times the samples and cells of 1/√2 the size, so half the size in total.
constexpr int kRefinements = 2;

CacheSettings refined(CacheSettings settings) {
  settings.gather_rays = std::min(settings.gather_rays * 4, 1 << 20);
  settings.light_samples = std::min(settings.light_samples * 4, 1 << 20);
  settings.voxels = std::min(settings.voxels * 181 / 128, 1024);
  settings.link_rays = std::min(settings.link_rays * 2, 1 << 12);
  settings.hemisphere_samples = std::min(settings.hemisphere_samples * 2, 1 << 10);
  return settings;
}

/// The part of a Watch's progress for one of several attempts, each four times as long as the previous one.
Watch part_of(const Watch& watch, double begin, double end) {
  Watch part{watch.stop, {}};
  if (watch.progress)
    part.progress = [&watch, begin, end](double done) {
      watch.progress(begin + (end - begin) * std::clamp(done, 0.0, 1.0));
    };
  return part;
}

class CacheEvaluator final : public Evaluator {
 public:
  CacheEvaluator(const Scene& scene, const RayScene& rays, const CacheSettings& settings)
      : scene_(scene), rays_(rays), settings_(settings) {}
  std::string_view name() const override { return "cache"; }

  Result<TransportMatrix> evaluate(std::span<const Receiver> receivers, std::span<const Emitter> emitters,
                                   const EvaluateOptions& options) const override {
    if (auto checked = check_evaluation(receivers, emitters, options); !checked)
      return tl::unexpected(std::move(checked.error()));
    CacheSettings settings = settings_;
    double begin = 0;
    std::uint64_t spent = 0;
    // Stops a refinement halfway; the previous attempt is then the answer.
    std::stop_source halt;
    const std::stop_callback when_stopped(options.watch.stop, [&] { halt.request_stop(); });
    const std::stop_callback when_enough(options.enough, [&] { halt.request_stop(); });
    std::optional<TransportMatrix> reached;
    for (int attempt = 0;; ++attempt) {
      const double end = begin + (1 - begin) * 0.2;
      RadianceCache::BuildOptions build;
      build.run() = options;
      build.watch = part_of(options.watch, begin, begin + (end - begin) / 2);
      if (reached) build.watch.stop = halt.get_token();
      // Without receivers, emitters or surfaces no cache is needed; an empty one is returned.
      const bool dark = emitters.empty() || receivers.empty() || scene_.triangles.empty();
      auto cache = RadianceCache::build(dark ? Scene{} : scene_, rays_, receivers, settings, build);
      const auto ended_early = [&] {
        return reached && options.enough.stop_requested() && !options.watch.stop.stop_requested();
      };
      if (!cache && ended_early()) return std::move(*reached);
      if (!cache) return tl::unexpected(std::move(cache.error()));
      EvaluateOptions evaluate = options;
      evaluate.watch = part_of(options.watch, begin + (end - begin) / 2, end);
      if (reached) evaluate.watch.stop = halt.get_token();
      auto matrix = cache->evaluate(emitters, evaluate);
      if (!matrix && ended_early()) return std::move(*reached);
      if (!matrix) return matrix;
      spent += cache->report().rays + matrix->rays;
      const bool enough = matrix->relative_error <= options.wanted_relative_error || attempt == kRefinements ||
                          options.enough.stop_requested() ||
                          spent + 4 * (cache->report().rays + matrix->rays) > options.max_rays;
      if (options.watch.progress) options.watch.progress(enough ? 1.0 : end);
      if (options.watch.stop.stop_requested())
        return tl::unexpected(Fault{Cause::cancelled, "", "stopped while refining the radiance cache", {}});
      if (enough) {
        matrix->rays = dark ? matrix->rays : spent;
        return matrix;
      }
      reached = std::move(*matrix);
      reached->rays = spent;
      begin = end;
      settings = refined(settings);
    }
  }

 private:
  const Scene& scene_;
  const RayScene& rays_;
  CacheSettings settings_;
};

}  // namespace

std::unique_ptr<Evaluator> make_cache_evaluator(const Scene& scene, const RayScene& rays,
                                                const CacheSettings& settings) {
  return std::make_unique<CacheEvaluator>(scene, rays, settings);
}

}  // namespace luxrig
