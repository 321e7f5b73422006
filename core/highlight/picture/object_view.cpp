#include "core/highlight/picture/object_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.h"

namespace luxrig {
namespace {

/// As in ray_direction.
struct CameraAxes {
  Vec3 ahead, right, up;
};

CameraAxes camera_axes(const Vec3& ahead) {
  const Vec3 up_hint = std::abs(ahead.z()) > 0.999 ? Vec3::UnitY() : Vec3::UnitZ();
  const Vec3 right = ahead.cross(up_hint).normalized();
  return {ahead, right, right.cross(ahead)};
}

}  // namespace

std::optional<PicturePlace> place_in_picture(const Camera& camera, const Vec3& place_world_m) {
  const CameraAxes axes = camera_axes((camera.target_world_m - camera.eye_world_m).normalized());
  const Vec3 to_m = place_world_m - camera.eye_world_m;
  const double ahead_m = to_m.dot(axes.ahead);
  if (!(ahead_m > 0)) return std::nullopt;
  const double px_per_slope = camera.height_px / (2 * std::tan(camera.vertical_fov_rad / 2));
  return PicturePlace{camera.width_px / 2.0 + px_per_slope * to_m.dot(axes.right) / ahead_m,
                      camera.height_px / 2.0 - px_per_slope * to_m.dot(axes.up) / ahead_m, ahead_m};
}

Camera camera_that_shows(std::span<const Vec3> points_world_m, const Vec3& towards_eye, double fill,
                         double vertical_fov_rad, int width_px, int height_px) {
  LUXRIG_CHECK(!points_world_m.empty() && fill > 0 && fill <= 1, "{} points, fill {}", points_world_m.size(), fill);
  LUXRIG_CHECK(towards_eye.norm() > 0, "no direction");
  const CameraAxes axes = camera_axes(-towards_eye.normalized());
  const double slope_up = fill * std::tan(vertical_fov_rad / 2), slope_right = slope_up * width_px / height_px;
  // A point is within the wanted rectangle if ±(x - x_eye) ≤ slope · (z - z_eye): keep the tightest on each side.
  constexpr double kNone = -std::numeric_limits<double>::infinity();
  double left = kNone, right = kNone, below = kNone, above = kNone, middle_z = 0;
  const Vec3& first = points_world_m.front();
  for (const Vec3& point : points_world_m) {
    const Vec3 from_m = point - first;
    const double x = from_m.dot(axes.right), y = from_m.dot(axes.up), z = from_m.dot(axes.ahead);
    right = std::max(right, x - slope_right * z);
    left = std::max(left, -x - slope_right * z);
    above = std::max(above, y - slope_up * z);
    below = std::max(below, -y - slope_up * z);
    middle_z += z / static_cast<double>(points_world_m.size());
  }
  double back_m = std::max((right + left) / (2 * slope_right), (above + below) / (2 * slope_up));
  if (!(back_m + middle_z > 1e-9)) back_m = 1 - middle_z;
  Camera camera;
  camera.vertical_fov_rad = vertical_fov_rad;
  camera.width_px = width_px;
  camera.height_px = height_px;
  camera.eye_world_m = first + (right - left) / 2 * axes.right + (above - below) / 2 * axes.up - back_m * axes.ahead;
  camera.target_world_m = camera.eye_world_m + (back_m + middle_z) * axes.ahead;
  return camera;
}

namespace {

/// Extra share that a view from a less usual height must show.
constexpr double kWorthwhileShare = 0.01;

double share_in_sight(const RayScene& scene, const CutAwayCamera& view, std::span<const Sight> wanted) {
  double seen = 0, all = 0;
  const Vec3& eye = view.camera.eye_world_m;
  for (const Sight& sight : wanted) {
    all += sight.weight;
    const Vec3 to_eye_m = eye - sight.position_world_m;
    const double facing = sight.normal.isZero(0) ? 1 : sight.normal.dot(to_eye_m.normalized());
    if (!(facing > 0)) continue;
    const Vec3 cut_world_m = eye - view.near_m * to_eye_m.normalized();
    if (!scene.occluded(sight.position_world_m, sight.normal, cut_world_m)) seen += facing * sight.weight;
  }
  return all > 0 ? seen / all : 0;
}

}  // namespace

CutAwayCamera camera_that_sees(const RayScene& scene, std::span<const Vec3> shown_world_m,
                               std::span<const Sight> wanted, double fill, double vertical_fov_rad, int width_px,
                               int height_px) {
  CutAwayCamera best;
  best.seen = -1;
  for (const double height_deg : {22.5, 5.0, 45.0, -15.0})
    for (int side = 0; side < 16; ++side) {
      const double around_rad = kPi / 8 * side, up_rad = rad_from_deg(height_deg);
      const Vec3 towards_eye(std::cos(up_rad) * std::cos(around_rad), std::cos(up_rad) * std::sin(around_rad),
                             std::sin(up_rad));
      CutAwayCamera view;
      view.camera = camera_that_shows(shown_world_m, towards_eye, fill, vertical_fov_rad, width_px, height_px);
      view.near_m = std::numeric_limits<double>::infinity();
      for (const Vec3& point : shown_world_m)
        view.near_m = std::min(view.near_m, (point - view.camera.eye_world_m).norm());
      view.near_m *= 0.98;
      view.seen = share_in_sight(scene, view, wanted);
      if (view.seen > best.seen + kWorthwhileShare) best = view;
    }
  return best;
}

}  // namespace luxrig
