#include "core/highlight/seen/seen_view.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/check.h"
#include "core/parallel.h"
#include "core/picture/picture.h"

namespace luxrig {
namespace {

constexpr double kNearestEye_m = 1e-3;
/// Share of the picture's longer side that the object takes: its edge needs a border.
constexpr double kFill = 0.92, kFillAmongSurroundings = 0.5;
/// A very near eye sees the object at most so wide (half angle).
const double kWidestSlope = std::tan(rad_from_deg(70));
/// The room's surface and the object's own are the same within this many errors of both (ray_scene.h).
constexpr double kSameSurface = 8;
constexpr double kVisitorTurn_rad = rad_from_deg(40);

/// Looks at the object's middle from the eye and shows all of its triangles.
Camera camera_on(const RayScene& object, const Vec3& eye_world_m, const SeenViewOptions& options) {
  const double fill = options.surroundings ? kFillAmongSurroundings : kFill;
  Camera camera;
  camera.eye_world_m = eye_world_m;
  camera.target_world_m = object.bounds_world_m().center();
  camera.width_px = camera.height_px = 2;
  camera.vertical_fov_rad = kPi / 2;  // one pixel per slope of 1
  const Vec3 ahead = ray_direction(camera, 1, 1), right = (ray_direction(camera, 2, 1) - ray_direction(camera, 0, 1)),
             up = (ray_direction(camera, 1, 0) - ray_direction(camera, 1, 2));
  const Vec3 x = right.normalized(), y = up.normalized();
  double slope_x = 0, slope_y = 0;
  for (std::uint32_t t = 0; t < object.triangles(); ++t)
    for (const Vec3& corner : object.corners_world_m(t)) {
      const Vec3 to_m = corner - eye_world_m;
      const double depth_m = to_m.dot(ahead);
      if (!(depth_m > 0)) continue;
      slope_x = std::max(slope_x, std::abs(to_m.dot(x)) / depth_m);
      slope_y = std::max(slope_y, std::abs(to_m.dot(y)) / depth_m);
    }
  const double least = 1e-9 + 0.02 * std::max(slope_x, slope_y);
  slope_x = std::clamp(slope_x / fill, least, kWidestSlope);
  slope_y = std::clamp(slope_y / fill, least, kWidestSlope);
  const double px_per_slope = options.across_px / (2 * std::max(slope_x, slope_y));
  camera.width_px = std::max(8, static_cast<int>(std::ceil(2 * slope_x * px_per_slope)));
  camera.height_px = std::max(8, static_cast<int>(std::ceil(2 * slope_y * px_per_slope)));
  camera.vertical_fov_rad = 2 * std::atan(camera.height_px / (2 * px_per_slope));
  return camera;
}

struct PixelHit {
  std::optional<Hit> hit;
  bool of_object = false;
};

PixelHit hit_at(const RayScene& room, const RayScene& object, const Camera& camera, std::size_t pixel) {
  const auto width = static_cast<std::size_t>(camera.width_px);
  const Vec3 direction =
      ray_direction(camera, static_cast<double>(pixel % width) + 0.5, static_cast<double>(pixel / width) + 0.5);
  PixelHit seen{room.nearest(camera.eye_world_m, direction, Vec3::Zero())};
  if (!seen.hit) return seen;
  const auto own = object.nearest(camera.eye_world_m, direction, Vec3::Zero());
  const double error_m =
      room.surface_error_m(seen.hit->position_world_m) + object.surface_error_m(seen.hit->position_world_m);
  // A grazing ray moves along the surface by more than the surface's error.
  const double grazing = std::max(0.05, std::abs(direction.dot(seen.hit->normal_world)));
  seen.of_object = own && std::abs(own->distance_m - seen.hit->distance_m) <= kSameSurface * error_m / grazing;
  return seen;
}

bool borders_on_object(std::span<const PixelHit> hits, int width_px, int height_px, int x, int y) {
  for (int v = std::max(0, y - 1); v <= std::min(height_px - 1, y + 1); ++v)
    for (int u = std::max(0, x - 1); u <= std::min(width_px - 1, x + 1); ++u)
      if (hits[static_cast<std::size_t>(v * width_px + u)].of_object) return true;
  return false;
}

}  // namespace

Result<SeenView> see_object(const RayScene& room, const RayScene& object, const Vec3& eye_world_m,
                            const SeenViewOptions& options) {
  LUXRIG_CHECK(options.across_px >= 16 && options.across_px <= 1024, "{} pixels", options.across_px);
  if (!eye_world_m.allFinite()) return refusal("the place that the object is seen from is not finite");
  if (object.triangles() == 0) return refusal("the object has no triangles: there is no surface to see");
  if ((object.bounds_world_m().center() - eye_world_m).norm() < kNearestEye_m)
    return refusal("the eye is in the middle of the object that it should see");
  const Camera camera = camera_on(object, eye_world_m, options);
  SeenView view;
  view.width_px = camera.width_px;
  view.height_px = camera.height_px;
  std::vector<PixelHit> hits(static_cast<std::size_t>(view.width_px) * static_cast<std::size_t>(view.height_px));
  const auto width = static_cast<std::size_t>(view.width_px);
  parallel_for(static_cast<std::size_t>(view.height_px), options.threads, [&](std::size_t row) {
    for (std::size_t x = 0; x < width; ++x) hits[row * width + x] = hit_at(room, object, camera, row * width + x);
  });
  view.sample_of_pixel.assign(hits.size(), SeenView::kNothing);
  const auto take = [&](std::size_t pixel) {
    view.sample_of_pixel[pixel] = static_cast<std::uint32_t>(view.samples.size());
    view.samples.push_back({hits[pixel].hit->position_world_m, hits[pixel].hit->normal_world});
    view.reflectance.push_back(static_cast<float>(room.material_of(hits[pixel].hit->triangle).luminous_reflectance()));
  };
  for (std::size_t p = 0; p < hits.size(); ++p)
    if (hits[p].of_object) take(p);
  view.object_samples = view.samples.size();
  if (view.object_samples == 0) return refusal("nothing of the object is in sight from there");
  for (int y = 0; y < view.height_px; ++y)
    for (int x = 0; x < view.width_px; ++x) {
      const auto p = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
      if (hits[p].hit && !hits[p].of_object &&
          (options.surroundings || borders_on_object(hits, view.width_px, view.height_px, x, y)))
        take(p);
    }
  return view;
}

std::vector<Vec3> eyes_around(const RayScene& object, const Vec3& eye_world_m) {
  const Vec3 middle_world_m = object.bounds_world_m().center();
  std::vector<Vec3> eyes = {eye_world_m};
  for (const double turn_rad : {-kVisitorTurn_rad, kVisitorTurn_rad})
    eyes.push_back(middle_world_m + Eigen::AngleAxisd(turn_rad, Vec3::UnitZ()) * Vec3(eye_world_m - middle_world_m));
  return eyes;
}

}  // namespace luxrig
