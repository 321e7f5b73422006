#pragma once
/// Small scenes for the cache's tests.

#include "core/transport/cache/radiance_cache.h"
#include "core/transport/enclosures.h"
#include "tests/core/transport/boxes.h"

namespace luxrig {

/// Two closed rooms of 2 m that share a wall of 15 cm, floor and ceiling in one piece.
inline Scene two_rooms(double reflectance) {
  Scene scene;
  scene.materials = {{"paint", Vec3::Constant(reflectance)}};
  add_box(scene, {0, 0, 0}, {4.15, 2, 2});
  add_box(scene, {2, -0.1, -0.1}, {2.15, 2.1, 2.1});
  return scene;
}

inline Emitter bulb_at(const Vec3& position_m, double flux_lm = 1000) {
  return {make_isotropic(flux_lm), {Mat3::Identity(), position_m}};
}

/// Settings that take little time.
inline CacheSettings quick_sides() {
  CacheSettings settings;
  settings.voxels = 64;
  settings.gather_rays = 1024;
  settings.light_samples = 1024;
  return settings;
}

inline CacheSettings quick_directions() {
  CacheSettings settings = CacheSettings::of_thesis();
  settings.voxels = 32;
  settings.light_samples = 64;
  settings.link_rays = 16;
  return settings;
}

inline TransportMatrix cached(const Scene& scene, const std::vector<Receiver>& receivers,
                              const std::vector<Emitter>& emitters, const CacheSettings& settings,
                              const EvaluateOptions& options = {}, int threads = 0) {
  const RayScene rays(scene);
  RadianceCache::BuildOptions build;
  build.threads = threads;
  auto cache = RadianceCache::build(scene, rays, receivers, settings, build);
  if (!cache) return {};
  auto matrix = cache->evaluate(emitters, options);
  return matrix ? *matrix : TransportMatrix{};
}

}  // namespace luxrig
