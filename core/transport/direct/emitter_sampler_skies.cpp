/// Skies as lamps: directions towards them from a surface point, and lines along which their light falls. With known
/// openings, each is a mixture: the whole sky, or the whole scene, and the part through the openings.

#include <algorithm>

#include "core/transport/bsdf.h"
#include "core/transport/direct/emitter_sampler.h"

namespace luxrig {

void EmitterSampler::weigh_skies(const Vec3& position_world_m, const Vec3& normal_world, Weights& weights) const {
  if (openings_) openings_->view(position_world_m, normal_world, weights.view);
  if (!(normal_world.z() > -0.99999)) return;
  for (std::size_t p = places_.size(); p > 0 && places_[p - 1].kind == Kind::sky; --p) {
    const Site& place = places_[p - 1];
    const Vec3* towards = place.towards_sun_world ? &*place.towards_sun_world : nullptr;
    const double lit = openings_ ? openings_->lit_share(weights.view, position_world_m, towards) : 1;
    double& weight = weights.places[weights.places.size() + p - 1 - places_.size()];
    for (std::size_t i = place.begin; i < place.end; ++i)
      weight += lit * lamps_[i].importance * lamps_[i].sky->horizontal_illuminance_lx();
  }
}

double EmitterSampler::sky_density_per_sr(const Site& place, const Vec3& position_world_m, const Vec3& direction_world,
                                          const Weights& weights) const {
  const double of_sky = lamps_[place.begin].sky->density_per_sr(direction_world);
  const double whole = whole_sky_share(place, weights);
  if (!(whole < 1)) return of_sky;
  return whole * of_sky + (1 - whole) * openings_->density_per_sr(weights.view, position_world_m, direction_world);
}

double EmitterSampler::line_density_per_m2(const Vec3& towards_world, const Vec3& position_world_m) const {
  const double over_scene = 1 / (kPi * radius_m_ * radius_m_);
  if (!openings_) return over_scene;
  const double whole = openings_->whole_scene_share(towards_world);
  return whole * over_scene + (1 - whole) * openings_->line_density_per_m2(towards_world, position_world_m);
}

EmitterRay EmitterSampler::emit_sky(const Lamp& lamp, double u, double v, double s, double t) const {
  EmitterRay ray;
  ray.emitter = lamp.emitter;
  const DirectionSample sample = lamp.sky->sample(u, v);
  if (!(sample.density_per_sr > 0)) return ray;
  const double whole = openings_ ? openings_->whole_scene_share(sample.direction) : 1;
  ray.direction_world = -sample.direction;
  if (s < whole) {
    const Eigen::Vector2d disk = concentric_disk(s / whole, t);
    const Vec3 across = Frame(sample.direction).world({disk.x(), disk.y(), 0});
    ray.from_world_m = centre_world_m_ + radius_m_ * (across + sample.direction);
  } else {
    Vec3 on_line_m = centre_world_m_;
    if (!openings_->sample_line(sample.direction, (s - whole) / (1 - whole), t, on_line_m)) return ray;
    const double along_m = radius_m_ - (on_line_m - centre_world_m_).dot(sample.direction);
    ray.from_world_m = on_line_m + along_m * sample.direction;
  }
  ray.density = lamp.share * sample.density_per_sr;
  ray.per_area = line_density_per_m2(sample.direction, ray.from_world_m);
  ray.flux_lm = lamp.sky->luminance_cd_m2(sample.direction) / (ray.density * ray.per_area);
  return ray;
}

}  // namespace luxrig
