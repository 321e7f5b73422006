#include "core/calibration/seen_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/check.h"
#include "core/photometry/light_colour.h"

namespace luxrig {
namespace {

/// Seen more aslant, a pixel is a long streak, and hardly any paint is matt.
constexpr double kMostAslant_rad = rad_from_deg(70);
/// Darker paint shows noise, gloss and flare instead of light.
constexpr double kDarkest = 0.05;
constexpr double kGloss = 0.03;
/// All pixels of a place see the same plane.
constexpr double kSameNormal = 0.999, kOffPlane_m = 0.01;
/// A point so near to what is seen behind it has the same light.
constexpr double kOnSurface_m = 0.02;
/// Of a place's middle to its sides [px].
constexpr double kAround_px = kPlaceSide_px / 2.0;
/// So many candidates per place wanted: half of a room may be glossy, dark or aslant.
constexpr int kCandidates = 3;

std::optional<Hit> hit_at(const RayScene& rays, const Camera& camera, double x_px, double y_px) {
  return rays.nearest(camera.eye_world_m, ray_direction(camera, x_px, y_px), Vec3::Zero());
}

std::optional<SeenPlace> place_at(const RayScene& rays, const Camera& camera, double x_px, double y_px) {
  const auto middle = hit_at(rays, camera, x_px, y_px);
  if (!middle) return std::nullopt;
  const Material& paint = rays.material_of(middle->triangle);
  const Vec3 to_camera = (camera.eye_world_m - middle->position_world_m).normalized();
  if (middle->normal_world.dot(to_camera) < std::cos(kMostAslant_rad) || paint.luminous_reflectance() < kDarkest ||
      paint.specular_reflectance > kGloss)
    return std::nullopt;
  const std::uint32_t material = rays.material_index_of(middle->triangle);
  for (const double dx_px : {-kAround_px, kAround_px})
    for (const double dy_px : {-kAround_px, kAround_px}) {
      const auto corner = hit_at(rays, camera, x_px + dx_px, y_px + dy_px);
      if (!corner || rays.material_index_of(corner->triangle) != material ||
          corner->normal_world.dot(middle->normal_world) < kSameNormal ||
          std::abs((corner->position_world_m - middle->position_world_m).dot(middle->normal_world)) > kOffPlane_m)
        return std::nullopt;
    }
  return SeenPlace{middle->position_world_m, middle->normal_world, material, paint.luminous_reflectance(), x_px, y_px};
}

/// Whether a picture of this size holds the whole of a place.
bool holds(const SeenPlace& place, int width_px, int height_px) {
  return place.x_px >= kAround_px && place.y_px >= kAround_px && place.x_px + kAround_px <= width_px &&
         place.y_px + kAround_px <= height_px;
}

/// A point that lies on a surface, and is seen; its receiver stays where the rig file has the point.
std::optional<SeenPlace> place_of_point(const RayScene& rays, const Camera& camera, const Point& point) {
  const auto at = pixel_of(camera, point.position_world_m);
  if (!at) return std::nullopt;
  auto place = place_at(rays, camera, at->x_px, at->y_px);
  if (!place || !holds(*place, camera.width_px, camera.height_px)) return std::nullopt;
  const Vec3 off_m = place->position_world_m - point.position_world_m;
  if (off_m.norm() > kOnSurface_m || place->normal_world.dot(point.normal_world) < kSameNormal) return std::nullopt;
  place->position_world_m = point.position_world_m;
  return place;
}

/// What two pictures differ by, as luminance.
struct Difference {
  int width_px = 0, height_px = 0;
  std::vector<double> cd_m2;
  double mean_cd_m2 = 0;

  Difference(const Picture& lit, const Picture& dark) : width_px(lit.width_px), height_px(lit.height_px) {
    for (std::size_t i = 0; i < lit.luminance_cd_m2.size(); ++i) {
      cd_m2.push_back(luminance_of_rgb((lit.luminance_cd_m2[i] - dark.luminance_cd_m2[i]).cast<double>()));
      mean_cd_m2 += cd_m2.back() / static_cast<double>(lit.luminance_cd_m2.size());
    }
  }
  [[nodiscard]] double at(int x, int y) const {
    return cd_m2[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) + static_cast<std::size_t>(x)];
  }
  /// Mean around a place, as far as the picture goes.
  [[nodiscard]] double around(const SeenPlace& place) const {
    const double reach_px = halo_reach_px(height_px);
    const int far = static_cast<int>(3 * reach_px);
    double sum = 0, weights = 0;
    for (int y = std::max(0, static_cast<int>(place.y_px) - far);
         y < std::min(height_px, static_cast<int>(place.y_px) + far); ++y)
      for (int x = std::max(0, static_cast<int>(place.x_px) - far);
           x < std::min(width_px, static_cast<int>(place.x_px) + far); ++x) {
        const double weight = std::exp(-(std::pow(x + 0.5 - place.x_px, 2) + std::pow(y + 0.5 - place.y_px, 2)) /
                                       (2 * reach_px * reach_px));
        sum += weight * at(x, y);
        weights += weight;
      }
    return sum / weights;
  }
};

SeenLight light_of(const Difference& difference, const SeenPlace& place) {
  double sum = 0, of_squares = 0, weights = 0, weights2 = 0;
  const auto first = [](double middle_px) { return static_cast<int>(std::floor(middle_px - kAround_px)); };
  // Pixels that the place covers in part count in part.
  const auto covered = [](int pixel, double middle_px) {
    return std::max(0.0,
                    std::min(pixel + 1.0, middle_px + kAround_px) - std::max<double>(pixel, middle_px - kAround_px));
  };
  for (int y = first(place.y_px); y < std::min(difference.height_px, first(place.y_px) + kPlaceSide_px + 1); ++y)
    for (int x = first(place.x_px); x < std::min(difference.width_px, first(place.x_px) + kPlaceSide_px + 1); ++x) {
      const double weight = covered(x, place.x_px) * covered(y, place.y_px), cd_m2 = difference.at(x, y);
      sum += weight * cd_m2;
      of_squares += weight * cd_m2 * cd_m2;
      weights += weight;
      weights2 += weight * weight;
    }
  const double mean = sum / weights, variance = std::max(0.0, of_squares / weights - mean * mean);
  const double lux_per_cd_m2 = kPi / place.reflectance, pixels = weights * weights / weights2;
  return {mean * lux_per_cd_m2, std::sqrt(variance / (pixels - 1)) * lux_per_cd_m2,
          (difference.mean_cd_m2 - mean) * lux_per_cd_m2, (difference.around(place) - mean) * lux_per_cd_m2};
}

}  // namespace

std::vector<SeenPlace> seen_places(const RayScene& rays, const Camera& camera, std::span<const Point> points,
                                   int count) {
  std::vector<SeenPlace> places;
  for (const Point& point : points)
    if (const auto place = place_of_point(rays, camera, point)) places.push_back(*place);
  if (count <= 0) return places;
  std::vector<SeenPlace> found;
  const double cell_px = std::sqrt(static_cast<double>(camera.width_px) * camera.height_px / (kCandidates * count));
  const int columns = std::max(1, static_cast<int>(camera.width_px / cell_px));
  const int rows = std::max(1, static_cast<int>(camera.height_px / cell_px));
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const double x_px = (column + 0.5) * camera.width_px / columns, y_px = (row + 0.5) * camera.height_px / rows;
      const auto place = place_at(rays, camera, x_px, y_px);
      if (place && holds(*place, camera.width_px, camera.height_px)) found.push_back(*place);
    }
  // Evenly, so that none of the picture is left out.
  const std::size_t wanted = std::min(found.size(), static_cast<std::size_t>(count));
  for (std::size_t k = 0; k < wanted; ++k) places.push_back(found[k * found.size() / wanted]);
  return places;
}

Rig with_places(Rig rig, std::span<const SeenPlace> places) {
  for (std::size_t k = 0; k < places.size(); ++k) {
    Point point;
    point.name = fmt::format("seen {}", k + 1);
    point.position_world_m = places[k].position_world_m;
    point.normal_world = places[k].normal_world;
    rig.points.push_back(std::move(point));
  }
  return rig;
}

std::vector<std::optional<SeenPlace>> places_by(const RayScene& rays, const Camera& camera,
                                                std::span<const SeenPlace> places) {
  std::vector<std::optional<SeenPlace>> by;
  for (const SeenPlace& place : places) {
    by.emplace_back();
    const auto at = pixel_of(camera, place.position_world_m);
    if (!at) continue;
    auto there = place_at(rays, camera, at->x_px, at->y_px);
    if (!there || there->material != place.material || !holds(*there, camera.width_px, camera.height_px) ||
        (there->position_world_m - place.position_world_m).norm() > kOnSurface_m)
      continue;
    by.back() = place;
    by.back()->x_px = at->x_px;
    by.back()->y_px = at->y_px;
  }
  return by;
}

double halo_reach_px(int height_px) { return 0.02 * height_px; }

std::vector<std::optional<SeenLight>> seen_light(const Picture& lit, const Picture& dark,
                                                 std::span<const std::optional<SeenPlace>> places) {
  LUXRIG_CHECK(lit.width_px == dark.width_px && lit.height_px == dark.height_px,
               "pictures of {} × {} and {} × {} pixels", lit.width_px, lit.height_px, dark.width_px, dark.height_px);
  const Difference difference(lit, dark);
  std::vector<std::optional<SeenLight>> seen;
  for (const auto& place : places) {
    LUXRIG_CHECK(!place || holds(*place, lit.width_px, lit.height_px), "a place at {}, {} of a picture of {} × {}",
                 place->x_px, place->y_px, lit.width_px, lit.height_px);
    seen.push_back(place ? std::optional(light_of(difference, *place)) : std::nullopt);
  }
  return seen;
}

}  // namespace luxrig
