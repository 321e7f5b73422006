#include "core/calibration/seen_surface.h"

#include <cmath>
#include <numeric>

#include "core/check.h"
#include "core/parallel.h"

namespace luxrig {
namespace {

const double kLeastCosine = std::cos(rad_from_deg(78));
constexpr double kDarkestSurface = 0.05, kGlossiest = 0.03;
/// Neighbours on one plane, up to rounding and the facets of round things.
constexpr float kOnePlaneFacing = 0.9995f, kOffSamePlane_m = 0.005f;

SurfacePixel pixel_at(const RayScene& rays, const Camera& camera, int x_px, int y_px) {
  const double x = x_px + 0.5, y = y_px + 0.5;
  const Vec3 ray = ray_direction(camera, x, y);
  const auto hit = rays.nearest(camera.eye_world_m, ray, Vec3::Zero());
  if (!hit) return {};
  const Material& paint = rays.material_of(hit->triangle);
  const double cosine = -ray.dot(hit->normal_world);
  if (cosine < kLeastCosine || paint.luminous_reflectance() < kDarkestSurface ||
      paint.specular_reflectance > kGlossiest)
    return {};
  // The solid angle of the pixel by its sides, so for any lens.
  const Vec3 across = ray_direction(camera, x + 0.5, y) - ray_direction(camera, x - 0.5, y);
  const Vec3 down = ray_direction(camera, x, y + 0.5) - ray_direction(camera, x, y - 0.5);
  SurfacePixel pixel;
  pixel.position_m = (hit->position_world_m - camera.eye_world_m).cast<float>();
  pixel.normal = hit->normal_world.cast<float>();
  pixel.area_m2 = static_cast<float>(across.cross(down).norm() * hit->distance_m * hit->distance_m / cosine);
  pixel.reflectance = static_cast<float>(paint.luminous_reflectance());
  pixel.material = rays.material_index_of(hit->triangle);
  return pixel;
}

bool of_one_plane(const SurfacePixel& a, const SurfacePixel& b) {
  return a.seen() && b.seen() && a.material == b.material && a.normal.dot(b.normal) > kOnePlaneFacing &&
         std::abs((a.position_m - b.position_m).dot(a.normal)) < kOffSamePlane_m;
}

std::size_t root_of(std::vector<std::size_t>& parent, std::size_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/// Numbers the planes, by union of neighbours.
void number_planes(SeenSurface& seen) {
  const auto width = static_cast<std::size_t>(seen.camera.width_px);
  std::vector<std::size_t> parent(seen.pixels.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  for (std::size_t i = 0; i < parent.size(); ++i) {
    if (i % width > 0 && of_one_plane(seen.pixels[i - 1], seen.pixels[i]))
      parent[root_of(parent, i)] = root_of(parent, i - 1);
    if (i >= width && of_one_plane(seen.pixels[i - width], seen.pixels[i]))
      parent[root_of(parent, i)] = root_of(parent, i - width);
  }
  std::vector<std::uint32_t> number(parent.size(), 0);
  std::vector<bool> numbered(parent.size(), false);
  for (std::size_t i = 0; i < parent.size(); ++i) {
    const std::size_t root = root_of(parent, i);
    if (!numbered[root]) {
      numbered[root] = true;
      number[root] = static_cast<std::uint32_t>(seen.plane_pixels.size());
      seen.plane_pixels.push_back(0);
    }
    seen.pixels[i].plane = number[root];
    ++seen.plane_pixels[number[root]];
  }
}

}  // namespace

SeenSurface seen_surface(const RayScene& rays, const Camera& camera, int threads) {
  LUXRIG_CHECK(camera.width_px > 0 && camera.height_px > 0, "a picture of {} × {} pixels", camera.width_px,
               camera.height_px);
  SeenSurface seen;
  seen.camera = camera;
  const auto width = static_cast<std::size_t>(camera.width_px), height = static_cast<std::size_t>(camera.height_px);
  seen.pixels.resize(width * height);
  parallel_for(height, threads, [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x)
      seen.pixels[y * width + x] = pixel_at(rays, camera, static_cast<int>(x), static_cast<int>(y));
  });
  number_planes(seen);
  return seen;
}

}  // namespace luxrig
