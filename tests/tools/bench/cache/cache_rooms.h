#pragma once
/// Small scenes for the cache's tests.

#include "tests/core/transport/boxes.h"
#include "tools/bench/cache/radiance_cache.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig {

/// Two closed rooms of 2 m that share a wall of 15 cm, with floor and ceiling in one piece.
inline Scene two_rooms(double reflectance) {
  Scene scene;
  scene.materials = {{"paint", Vec3::Constant(reflectance)}};
  add_box(scene, {0, 0, 0}, {4.15, 2, 2});
  add_box(scene, {2, -0.1, -0.1}, {2.15, 2.1, 2.1});
  return scene;
}

/// A room of 6 m by 5 m by 2.7 m. Its door, 1.5 m wide, opens to a ground that extends `half_m` each way.
inline Scene room_open_to_a_ground(double half_m, double reflectance) {
  Scene scene;
  scene.materials = {{"paint", Vec3::Constant(reflectance)}};
  const double t = 0.15;
  add_box(scene, {-half_m, -half_m, -0.3}, {half_m, half_m, 0});
  add_box(scene, {-t, -t, 2.7}, {6 + t, 5 + t, 2.7 + t});
  add_box(scene, {-t, -t, 0}, {0, 5 + t, 2.7});
  add_box(scene, {6, -t, 0}, {6 + t, 5 + t, 2.7});
  add_box(scene, {0, 5, 0}, {6, 5 + t, 2.7});
  add_box(scene, {0, -t, 0}, {2, 0, 2.7});
  add_box(scene, {3.5, -t, 0}, {6, 0, 2.7});
  add_box(scene, {2, -t, 2.2}, {3.5, 0, 2.7});
  return scene;
}

inline Emitter bulb_at(const Vec3& position_m, double flux_lm = 1000) {
  return {make_isotropic(flux_lm), {Mat3::Identity(), position_m}};
}

/// Settings for a short run.
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
