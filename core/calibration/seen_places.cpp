#include "core/calibration/seen_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/check.h"

namespace luxrig {
namespace {

/// Seen more aslant, a pixel is a long streak, and hardly any paint is matt.
constexpr double kMostAslant_rad = 70 * std::numbers::pi / 180;
/// Darker paint shows noise, gloss and flare instead of light.
constexpr double kDarkest = 0.05;
constexpr double kGloss = 0.03;
/// All pixels of a place see the same plane.
constexpr double kSameNormal = 0.999, kOffPlane_m = 0.01;
/// So many candidates per place wanted: half of a room may be glossy, dark or aslant.
constexpr int kCandidates = 3;

std::optional<Hit> hit_at(const RayScene& rays, const Camera& camera, int x_px, int y_px) {
  return rays.nearest(camera.eye_world_m, ray_direction(camera, x_px + 0.5, y_px + 0.5), Vec3::Zero());
}

std::optional<SeenPlace> place_at(const RayScene& rays, const Camera& camera, int x_px, int y_px) {
  const auto middle = hit_at(rays, camera, x_px, y_px);
  if (!middle) return std::nullopt;
  const Material& paint = rays.material_of(middle->triangle);
  const Vec3 to_camera = (camera.eye_world_m - middle->position_world_m).normalized();
  if (middle->normal_world.dot(to_camera) < std::cos(kMostAslant_rad) || paint.luminous_reflectance() < kDarkest ||
      paint.specular_reflectance > kGloss)
    return std::nullopt;
  const std::uint32_t material = rays.material_index_of(middle->triangle);
  constexpr int kReach = kPlaceSide_px / 2;
  for (const int dx : {-kReach, kReach})
    for (const int dy : {-kReach, kReach}) {
      const auto corner = hit_at(rays, camera, x_px + dx, y_px + dy);
      if (!corner || rays.material_index_of(corner->triangle) != material ||
          corner->normal_world.dot(middle->normal_world) < kSameNormal ||
          std::abs((corner->position_world_m - middle->position_world_m).dot(middle->normal_world)) > kOffPlane_m)
        return std::nullopt;
    }
  return SeenPlace{middle->position_world_m, middle->normal_world, material, paint.luminous_reflectance(), x_px, y_px};
}

double luminance_of(const Vec3f& pixel) {
  return 0.2126 * static_cast<double>(pixel.x()) + 0.7152 * static_cast<double>(pixel.y()) +
         0.0722 * static_cast<double>(pixel.z());
}

}  // namespace

std::vector<SeenPlace> seen_places(const RayScene& rays, const Camera& camera, int count) {
  std::vector<SeenPlace> found;
  if (count <= 0) return found;
  const double cell_px = std::sqrt(static_cast<double>(camera.width_px) * camera.height_px / (kCandidates * count));
  const int columns = std::max(1, static_cast<int>(camera.width_px / cell_px));
  const int rows = std::max(1, static_cast<int>(camera.height_px / cell_px));
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const int x_px = static_cast<int>((column + 0.5) * camera.width_px / columns);
      const int y_px = static_cast<int>((row + 0.5) * camera.height_px / rows);
      if (const auto place = place_at(rays, camera, x_px, y_px)) found.push_back(*place);
    }
  // Evenly, so that none of the picture is left out.
  std::vector<SeenPlace> places;
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

SeenLight seen_light(const Picture& lit, const Picture& dark, const SeenPlace& place) {
  constexpr int kReach = kPlaceSide_px / 2;
  LUXRIG_CHECK(lit.width_px == dark.width_px && lit.height_px == dark.height_px && place.x_px >= kReach &&
                   place.y_px >= kReach && place.x_px + kReach < lit.width_px && place.y_px + kReach < lit.height_px,
               "a place at {}, {} of pictures of {} × {} and {} × {} pixels", place.x_px, place.y_px, lit.width_px,
               lit.height_px, dark.width_px, dark.height_px);
  double sum = 0, of_squares = 0;
  for (int y = place.y_px - kReach; y <= place.y_px + kReach; ++y)
    for (int x = place.x_px - kReach; x <= place.x_px + kReach; ++x) {
      const auto at =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(lit.width_px) + static_cast<std::size_t>(x);
      const double cd_m2 = luminance_of(lit.luminance_cd_m2[at]) - luminance_of(dark.luminance_cd_m2[at]);
      sum += cd_m2;
      of_squares += cd_m2 * cd_m2;
    }
  constexpr double kPixels = kPlaceSide_px * kPlaceSide_px;
  const double mean = sum / kPixels, variance = std::max(0.0, of_squares / kPixels - mean * mean) / (kPixels - 1);
  const double lux_per_cd_m2 = std::numbers::pi / place.reflectance;
  return {mean * lux_per_cd_m2, std::sqrt(variance) * lux_per_cd_m2};
}

}  // namespace luxrig
