#include "tools/bench/cache/light_view.h"

#include <array>
#include <cmath>

#include "core/photometry/shapes/shape_sampling.h"

namespace luxrig {
namespace {

struct Start {
  Vec3 from_world_m, direction_world;
  double flux_lm = 0;  ///< total of all samples
};

Start leaves_luminaire(const RayScene& scene, const Emitter& emitter, const std::array<double, 4>& u) {
  const DirectionSample drawn = emitter.intensity->sample(u[0], u[1]);
  if (!(drawn.density_per_sr > 0)) return {};
  const double intensity_cd = emitter.intensity->intensity_cd(drawn.direction);
  if (!(intensity_cd > 0)) return {};
  const Pose& pose = emitter.world_from_lamp;
  const Vec3 direction = pose.direction(drawn.direction).normalized();
  Vec3 from_m = pose.translation_m;
  if (emitter.shape.kind != LuminousShape::Kind::point)
    from_m = pose.point(sample_leaving_place_m(emitter.shape, drawn.direction, u[2], u[3]));
  // Shadow rays stop this far short of a lamp, so that a ceiling does not shade a lamp flush with it. So light that
  // leaves the lamp starts this far outside.
  from_m += 32 * scene.surface_error_m(from_m) * direction;
  return {from_m, direction, intensity_cd / drawn.density_per_sr};
}

/// Light that passes through a disk, at right angles to its direction, that covers the scene from the sky.
Start leaves_sky(const RayScene& scene, const SkyLuminance& sky, const std::array<double, 4>& u) {
  const DirectionSample drawn = sky.sample(u[0], u[1]);
  if (!(drawn.density_per_sr > 0)) return {};
  const double luminance_cd_m2 = sky.luminance_cd_m2(drawn.direction);
  if (!(luminance_cd_m2 > 0)) return {};
  const Eigen::AlignedBox3d box_m = scene.bounds_world_m();
  const double radius_m = 0.5 * box_m.diagonal().norm();
  const Vec3 across = drawn.direction.unitOrthogonal(), up = drawn.direction.cross(across);
  const double r = radius_m * std::sqrt(u[2]), phi = 2 * kPi * u[3];
  const Vec3 place_m = box_m.center() + r * (std::cos(phi) * across + std::sin(phi) * up);
  return {place_m + 1.01 * radius_m * drawn.direction, -drawn.direction,
          luminance_cd_m2 / drawn.density_per_sr * kPi * radius_m * radius_m};
}

}  // namespace

LightView light_view(const RayScene& scene, const Emitter& emitter, const SobolSequence& samples, std::uint32_t count) {
  LightView view;
  if (scene.bounds_world_m().isEmpty()) return view;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto u = samples.set(i, 0);
    const Start start = emitter.sky ? leaves_sky(scene, *emitter.sky, u) : leaves_luminaire(scene, emitter, u);
    if (!(start.flux_lm > 0)) continue;
    ++view.rays;
    const auto hit = scene.nearest(start.from_world_m, start.direction_world, Vec3::Zero());
    if (!hit) continue;
    view.hits.push_back({hit->position_world_m, hit->normal_world, hit->triangle, start.flux_lm / count});
  }
  return view;
}

Vec3 diffuse_equivalent_rgb(const Material& material) {
  const double coat = material.specular_reflectance;
  return (material.reflectance_rgb * (1 - coat)).array() + coat;
}

}  // namespace luxrig
