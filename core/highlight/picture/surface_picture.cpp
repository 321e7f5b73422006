#include "core/highlight/picture/surface_picture.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "core/check.h"
#include "core/highlight/picture/object_view.h"
#include "core/parallel.h"
#include "core/transport/progress.h"

namespace luxrig {
namespace {

constexpr float kNothingSeen = std::numeric_limits<float>::infinity();

void blend(Vec3f& under, const Vec3f& over, double opacity) { under += static_cast<float>(opacity) * (over - under); }

}  // namespace

Vec3 SurfaceCorners::normal(const TargetSurface& surface) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < 3; ++i) sum += weights[i] * surface.normals[points[i]];
  return sum.norm() > 1e-9 ? Vec3(sum.normalized()) : Vec3(Vec3::Zero());
}

double SurfaceCorners::value(std::span<const double> of_points) const {
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) sum += weights[i] * of_points[points[i]];
  return sum;
}

std::optional<SurfaceCorners> corners_at(const Scene& target, const TargetSurface& surface, const Hit& hit) {
  std::array<Vec3, 3> way_m;  // from the place to the corners
  SurfaceCorners corners{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t vertex = target.triangles[hit.triangle][i];
    corners.points[i] = surface.point_of_vertex[vertex];
    if (corners.points[i] == TargetSurface::kNone) return std::nullopt;
    way_m[i] = target.vertex_world_m(vertex) - hit.position_world_m;
  }
  const Vec3 area = (way_m[1] - way_m[0]).cross(way_m[2] - way_m[0]);
  if (!(area.squaredNorm() > 0)) return std::nullopt;
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    // Weight = area of the opposite part; rounding may put the place slightly outside.
    corners.weights[i] = std::max(0.0, way_m[(i + 1) % 3].cross(way_m[(i + 2) % 3]).dot(area) / area.squaredNorm());
    sum += corners.weights[i];
  }
  if (!(sum > 0)) return std::nullopt;
  for (double& weight : corners.weights) weight /= sum;
  return corners;
}

SurfacePicture::SurfacePicture(const Camera& camera, int samples_per_edge, double near_m, const Vec3f& background_rgb)
    : camera_(camera),
      per_edge_(samples_per_edge),
      width_(camera.width_px * samples_per_edge),
      height_(camera.height_px * samples_per_edge),
      near_m_(near_m) {
  LUXRIG_CHECK(camera.width_px >= 1 && camera.height_px >= 1 && camera.width_px <= 16384 && camera.height_px <= 16384,
               "{} × {} pixels", camera.width_px, camera.height_px);
  LUXRIG_CHECK(samples_per_edge >= 1 && samples_per_edge <= 8, "{} samples", samples_per_edge);
  samples_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), {kNothingSeen, background_rgb});
}

Vec3 SurfacePicture::ray_of(int x, int y) const {
  return ray_direction(camera_, (x + 0.5) / per_edge_, (y + 0.5) / per_edge_);
}

SurfacePicture::Sample& SurfacePicture::at(int x, int y) {
  return samples_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
}

bool SurfacePicture::draw(const RayScene& scene, const ColourOf& colour_of, int threads, const Watch& watch) {
  CallingThreadProgress progress(watch, 0, 1, static_cast<std::size_t>(height_));
  parallel_for(static_cast<std::size_t>(height_), threads, [&](std::size_t row) {
    if (watch.stop.stop_requested()) return;
    for (int x = 0; x < width_; ++x) {
      const Vec3 direction = ray_of(x, static_cast<int>(row));
      auto hit = scene.nearest(camera_.eye_world_m + near_m_ * direction, direction, Vec3::Zero());
      if (!hit) continue;
      hit->distance_m += near_m_;
      Sample& sample = at(x, static_cast<int>(row));
      if (hit->distance_m >= static_cast<double>(sample.distance_m)) continue;
      sample = {static_cast<float>(hit->distance_m), colour_of(*hit, -direction)};
    }
    progress.one_done();
  });
  if (watch.stop.stop_requested()) return false;
  progress.report_end();
  return true;
}

/// All samples that may show a ball: the rectangle around the corners of its cube, or everything when the cube reaches
/// behind the eye.
SurfacePicture::Area SurfacePicture::area_of(const Vec3& centre_world_m, double radius_m) const {
  Area area{width_, 0, height_, 0};
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 sign((corner & 1) ? 1 : -1, (corner & 2) ? 1 : -1, (corner & 4) ? 1 : -1);
    const auto place = place_in_picture(camera_, centre_world_m + radius_m * sign);
    if (!place) return {0, width_, 0, height_};
    const double x = std::clamp(per_edge_ * place->x_px, -1.0, width_ + 1.0);
    const double y = std::clamp(per_edge_ * place->y_px, -1.0, height_ + 1.0);
    area.left = std::min(area.left, static_cast<int>(std::floor(x)));
    area.right = std::max(area.right, static_cast<int>(std::ceil(x)));
    area.top = std::min(area.top, static_cast<int>(std::floor(y)));
    area.bottom = std::max(area.bottom, static_cast<int>(std::ceil(y)));
  }
  return {std::max(0, area.left), std::min(width_, area.right), std::max(0, area.top), std::min(height_, area.bottom)};
}

void SurfacePicture::draw(std::span<const Disc> discs) {
  std::vector<std::size_t> order(discs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) {
    return (discs[i].centre_world_m - camera_.eye_world_m).squaredNorm();
  });
  for (const std::size_t i : order) {
    const Disc& disc = discs[i];
    const Vec3 to_m = disc.centre_world_m - camera_.eye_world_m;
    const Vec3 normal = disc.normal.isZero(0) ? Vec3(to_m.normalized()) : disc.normal;
    if (!place_in_picture(camera_, disc.centre_world_m)) continue;
    const Area area = area_of(disc.centre_world_m, disc.radius_m);
    for (int y = area.top; y < area.bottom; ++y)
      for (int x = area.left; x < area.right; ++x) {
        const Vec3 direction = ray_of(x, y);
        const double slope = direction.dot(normal);
        if (std::abs(slope) < 1e-6) continue;
        const double distance_m = to_m.dot(normal) / slope;
        if (distance_m < near_m_ || (distance_m * direction - to_m).squaredNorm() > disc.radius_m * disc.radius_m)
          continue;
        Sample& sample = at(x, y);
        if (distance_m - disc.lift_m <= static_cast<double>(sample.distance_m))
          blend(sample.rgb, disc.rgb, disc.opacity);
      }
  }
}

void SurfacePicture::draw(const DrawnLine& line) {
  // Cuts off the part behind the eye's plane.
  const Vec3 ahead = (camera_.target_world_m - camera_.eye_world_m).normalized();
  Vec3 from_m = line.from_world_m - camera_.eye_world_m, to_m = line.to_world_m - camera_.eye_world_m;
  if (from_m.dot(ahead) > to_m.dot(ahead)) std::swap(from_m, to_m);
  const double min_m = 1e-3 * (to_m - from_m).norm();
  if (!(to_m.dot(ahead) > min_m)) return;
  if (from_m.dot(ahead) < min_m) from_m += (min_m - from_m.dot(ahead)) / (to_m - from_m).dot(ahead) * (to_m - from_m);
  const auto from = place_in_picture(camera_, camera_.eye_world_m + from_m);
  const auto to = place_in_picture(camera_, camera_.eye_world_m + to_m);
  if (!from || !to) return;
  const Eigen::Vector2d a = per_edge_ * Eigen::Vector2d(from->x_px, from->y_px);
  const Eigen::Vector2d b = per_edge_ * Eigen::Vector2d(to->x_px, to->y_px);
  const double half = per_edge_ * line.width_px / 2, length2 = std::max((b - a).squaredNorm(), 1e-12);
  const auto first = [half](double p, double q) {
    return std::max(0, static_cast<int>(std::min({p, q, 1e9}) - half - 1));
  };
  const auto last = [half](double p, double q, int size) {
    return static_cast<int>(std::clamp(std::max(p, q) + half + 2, 0.0, static_cast<double>(size)));
  };
  for (int y = first(a.y(), b.y()); y < last(a.y(), b.y(), height_); ++y)
    for (int x = first(a.x(), b.x()); x < last(a.x(), b.x(), width_); ++x) {
      const Eigen::Vector2d here(x + 0.5, y + 0.5);
      const double along = std::clamp((here - a).dot(b - a) / length2, 0.0, 1.0);
      if ((here - a - along * (b - a)).squaredNorm() > half * half) continue;
      // Even steps in the picture are not even in space: 1 / ahead is linear along the line in the picture.
      const double share = along * from->ahead_m / ((1 - along) * to->ahead_m + along * from->ahead_m);
      const double distance_m = (from_m + share * (to_m - from_m)).norm();
      Sample& sample = at(x, y);
      const bool seen = distance_m - line.lift_m <= static_cast<double>(sample.distance_m);
      blend(sample.rgb, line.rgb, seen ? 1 : line.hidden_opacity);
    }
}

bool SurfacePicture::shows(const Vec3& place_world_m, double lift_m) const {
  const auto place = place_in_picture(camera_, place_world_m);
  if (!place || place->x_px < 0 || place->y_px < 0) return false;
  const int x = static_cast<int>(per_edge_ * place->x_px), y = static_cast<int>(per_edge_ * place->y_px);
  if (x >= width_ || y >= height_) return false;
  const double distance_m = (place_world_m - camera_.eye_world_m).norm();
  const auto index = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  return distance_m >= near_m_ && distance_m - lift_m <= static_cast<double>(samples_[index].distance_m);
}

ColourPicture SurfacePicture::resolved() const {
  ColourPicture picture{camera_.width_px, camera_.height_px, {}};
  picture.rgb.reserve(static_cast<std::size_t>(camera_.width_px) * static_cast<std::size_t>(camera_.height_px));
  const auto count = static_cast<float>(per_edge_ * per_edge_);
  for (int y = 0; y < camera_.height_px; ++y)
    for (int x = 0; x < camera_.width_px; ++x) {
      Vec3f sum = Vec3f::Zero();
      for (int j = 0; j < per_edge_; ++j)
        for (int i = 0; i < per_edge_; ++i)
          sum += samples_[static_cast<std::size_t>(y * per_edge_ + j) * static_cast<std::size_t>(width_) +
                          static_cast<std::size_t>(x * per_edge_ + i)]
                     .rgb;
      picture.rgb.push_back(sum / count);
    }
  return picture;
}

}  // namespace luxrig
