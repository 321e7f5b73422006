#pragma once
/// Small scenes for the cache's tests.

#include "core/transport/cache/radiance_cache.h"
#include "core/transport/enclosures.h"

namespace luxrig {

inline void add_box(Scene& scene, const Vec3& low_m, const Vec3& high_m, std::uint32_t material = 0) {
  const auto first = static_cast<std::uint32_t>(scene.vertices_m.size());
  for (int i = 0; i < 8; ++i)
    scene.vertices_m.emplace_back(
        Vec3(i & 1 ? high_m.x() : low_m.x(), i & 2 ? high_m.y() : low_m.y(), i & 4 ? high_m.z() : low_m.z())
            .cast<float>());
  constexpr std::uint32_t kFaces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                          {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  for (const auto& f : kFaces)
    for (const auto& t : {std::array{f[0], f[1], f[2]}, std::array{f[0], f[2], f[3]}}) {
      scene.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      scene.material_of_triangle.push_back(material);
      scene.object_of_triangle.push_back(0);
    }
  scene.object_names = {"scene"};
}

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
