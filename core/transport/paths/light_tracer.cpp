#include "core/transport/paths/light_tracer.h"

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

/// Dimensions separate from those of paths.
constexpr std::uint32_t kLightSet = 1u << 17;

bool box_meets(const Eigen::AlignedBox3d& box, const Vec3& from, const Vec3& direction) {
  double near = 0, far = HUGE_VAL;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0) {
      if (from[axis] < box.min()[axis] || from[axis] > box.max()[axis]) return false;
      continue;
    }
    const double a = (box.min()[axis] - from[axis]) / direction[axis];
    const double b = (box.max()[axis] - from[axis]) / direction[axis];
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  // A box without thickness, or one only touched, is hit.
  return near <= far * (1 + 1e-9) + 1e-300;
}

}  // namespace

std::vector<Bsdf> bsdfs_of(const RayScene& scene) {
  std::vector<Bsdf> bsdfs;
  for (const Material& material : scene.materials()) bsdfs.emplace_back(material);
  return bsdfs;
}

double largest_reflectance(const RayScene& scene) {
  double largest = 0;
  for (const Material& m : scene.materials())
    largest = std::max({largest, m.reflectance_rgb.maxCoeff(), m.specular_reflectance});
  return scene.bounds_world_m().isEmpty() ? 0 : largest;
}

LightVertex LightTracer::trace(std::size_t group, const SobolSequence& samples, std::uint32_t index,
                               EmitterSampler::Weights& weights, std::uint64_t& rays) const {
  LightVertex light;
  const auto [u, v] = samples.pair(index, kLightSet, 0);
  const auto [s, t] = lamps_.have_size() ? samples.pair(index, kLightSet, 1) : std::array<double, 2>{};
  const EmitterRay ray = lamps_.emit(group, u, v, s, t);
  if (!(ray.flux_lm > 0) || !box_meets(bounds_world_m_, ray.from_world_m, ray.direction_world)) return light;
  ++rays;
  // Moved off along the ray: a panel may be flush with a wall, which must not stop its light at the start.
  const auto hit = scene_.nearest(ray.from_world_m, ray.direction_world, ray.direction_world);
  if (!hit) return light;
  const Bsdf& bsdf = bsdfs_[scene_.material_index_of(hit->triangle)];
  if (bsdf.black()) return light;
  const double cosine = -hit->normal_world.dot(ray.direction_world);
  if (!(cosine > 0)) return light;
  light.position_world_m = hit->position_world_m;
  light.normal_world = hit->normal_world;
  light.to_light_world = -ray.direction_world;
  light.bsdf = &bsdf;
  light.emitter = ray.emitter;
  const double spread = ray.per_area > 0 ? ray.per_area : 1 / (hit->position_world_m - ray.from_world_m).squaredNorm();
  light.density = ray.density * cosine * spread;
  const double sum = lamps_.weigh(light.position_world_m, light.normal_world, weights);
  light.choice_density = lamps_.choice_density(ray.emitter, light.position_world_m, light.to_light_world, weights, sum);
  if (images_) light.plane = images_->plane_of(hit->triangle);
  if (light.plane != MirrorImages::kNoPlane && !lamps_.is_sky(ray.emitter))
    light.in_place =
        lamps_.density_in_place(lamps_.place_of(ray.emitter), light.position_world_m, light.to_light_world);
  if (!std::isfinite(light.density)) return light;
  const double through = scene_.has_panes() ? scene_.transmittance(ray.from_world_m, hit->position_world_m) : 1;
  light.flux_rgb = through * ray.flux_lm * lamps_.colour_rgb(ray.emitter);
  light.matt_rgb = light.flux_rgb.cwiseProduct(bsdf.body_rgb()) / kPi;
  return light;
}

}  // namespace luxrig
