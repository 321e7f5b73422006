#include "core/transport/direct/shape_light.h"

#include <algorithm>
#include <cmath>

#include "core/photometry/shapes/shape_sampling.h"
#include "core/transport/direct/cubature.h"
#include "core/transport/direct/shape_patches.h"

namespace luxrig {
namespace {

/// Smallest angle [rad] at which a distribution changes by its own size.
constexpr double kSharpest = 0.01;
constexpr double kMaxPerSide = 16;

double point_lux(const Vec3& towards_m, const Vec3& normal_world, const Emitter& emitter) {
  const double height_m = normal_world.dot(towards_m);
  if (!(height_m > 0)) return 0;
  const double distance_m = towards_m.norm();
  const Vec3 leaving = emitter.world_from_lamp.inverse_direction(-towards_m / distance_m);
  const double lux = height_m / distance_m / (distance_m * distance_m) * emitter.intensity->intensity_cd(leaving);
  return std::isfinite(lux) ? lux : 0;
}

/// Initial pieces per side of a patch, so that a beam does not fall between the first nodes. Its width follows from
/// flux over peak, the solid angle into which the peak would send all light.
double pieces_per_side(double radius_m, double distance_m, const IntensityDistribution& intensity) {
  const double seen_rad = distance_m > radius_m ? 2 * std::asin(radius_m / distance_m) : kPi;
  const double beam_sr = intensity.flux_lm() / intensity.max_intensity_cd();
  const double beam_rad = 2 * std::sqrt(beam_sr / kPi);
  return std::clamp(std::ceil(0.5 * seen_rad / beam_rad), 1.0, kMaxPerSide);
}

}  // namespace

double bounding_radius_m(const LuminousShape& shape) {
  const Vec3 half_m = 0.5 * shape.size_m;
  switch (shape.kind) {
    case LuminousShape::Kind::point:
      return 0;
    case LuminousShape::Kind::rectangle:
      return std::hypot(half_m.x(), half_m.y());
    case LuminousShape::Kind::disk:
    case LuminousShape::Kind::sphere:
      return half_m.x();
    case LuminousShape::Kind::cylinder:
      return std::hypot(half_m.x(), half_m.z());
  }
  return 0;
}

ShapeLight shape_light(const Vec3& position_world_m, const Vec3& normal_world, const Emitter& emitter,
                       const ShapeLightOptions& options) {
  const Vec3 towards_m = emitter.world_from_lamp.translation_m - position_world_m;
  const double distance_m = towards_m.norm(), radius_m = bounding_radius_m(emitter.shape);
  if (!(normal_world.dot(towards_m) > -radius_m)) return {};
  const IntensityDistribution& intensity = *emitter.intensity;
  if (!(intensity.max_intensity_cd() > 0)) return {};
  if (radius_m <= options.wanted_relative_error * kSharpest * distance_m) {
    const double lux = point_lux(towards_m, normal_world, emitter);
    return {lux, radius_m > 0 ? options.wanted_relative_error * lux : 0, 1};
  }

  const Viewer viewer{emitter.world_from_lamp.inverse_direction(-towards_m),
                      emitter.world_from_lamp.inverse_direction(normal_world), 0.5 * intensity.emission_cone_rad()};
  std::vector<ShapePatch> patches;
  cut_into_patches(emitter.shape, viewer, patches);
  const double per_side = pieces_per_side(radius_m, distance_m, intensity);
  std::vector<CubaturePiece> pieces;
  for (std::size_t i = 0; i < patches.size(); ++i)
    for (double t = 0; t < per_side; ++t)
      for (double w = 0; w < per_side; ++w)
        pieces.push_back({i, t / per_side, (t + 1) / per_side, w / per_side, (w + 1) / per_side});
  const CubatureResult sum = integrate_pieces(
      pieces, options.wanted_relative_error, options.max_evaluations, [&](std::size_t i, double t, double w) {
        const PatchPlace place = patches[i].at(t, w);
        const double cosine = viewer.normal.dot(place.direction);
        if (!(cosine > 0) || !(place.sr > 0)) return 0.0;
        const double area_m2 = projected_area_m2(emitter.shape, place.direction);  // the same from both sides
        const double lux = intensity.intensity_cd(-place.direction) / area_m2 * cosine * place.sr;
        return std::isfinite(lux) ? lux : 0.0;
      });
  return {std::max(0.0, sum.value), sum.error, sum.evaluations};
}

double illuminance_lx(const Vec3& position_world_m, const Vec3& normal_world, const Emitter& emitter,
                      double wanted_relative_error) {
  return shape_light(position_world_m, normal_world, emitter, {wanted_relative_error, 200'000}).lux;
}

}  // namespace luxrig
