#include "core/highlight/picture/picture_contrast.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/photometry/light_colour.h"

namespace luxrig {
namespace {

/// Summed-area table from one corner of the picture: any window costs four look-ups.
class WindowSums {
 public:
  WindowSums(const Picture& picture)
      : width_(static_cast<std::size_t>(picture.width_px) + 1),
        sums_(width_ * (static_cast<std::size_t>(picture.height_px) + 1), Eigen::Vector2d(Eigen::Vector2d::Zero())) {
    for (std::size_t y = 1; y * width_ < sums_.size(); ++y)
      for (std::size_t x = 1; x < width_; ++x) {
        const double value = luminance_of_rgb(picture.luminance_cd_m2[(y - 1) * (width_ - 1) + x - 1].cast<double>());
        const Eigen::Vector2d here(value, value * value);
        sums_[y * width_ + x] =
            here + sums_[(y - 1) * width_ + x] + sums_[y * width_ + x - 1] - sums_[(y - 1) * width_ + x - 1];
      }
  }
  /// Sum and sum of squares over x0 ≤ x < x1, y0 ≤ y < y1.
  [[nodiscard]] Eigen::Vector2d of(std::size_t x0, std::size_t y0, std::size_t x1, std::size_t y1) const {
    return sums_[y1 * width_ + x1] - sums_[y0 * width_ + x1] - sums_[y1 * width_ + x0] + sums_[y0 * width_ + x0];
  }

 private:
  std::size_t width_;
  std::vector<Eigen::Vector2d> sums_;
};

}  // namespace

std::optional<PixelPlace> seen_place(const Camera& camera, const RayScene& scene, const OrientedPoint& point) {
  if (point.normal.dot(camera.eye_world_m - point.position_world_m) <= 0) return std::nullopt;
  const auto place = pixel_of(camera, point.position_world_m);
  if (!place || scene.occluded(point.position_world_m, point.normal, camera.eye_world_m)) return std::nullopt;
  return place;
}

PictureContrast picture_contrast(const Picture& picture, const Camera& camera, const RayScene& scene,
                                 std::span<const OrientedPoint> points, double scale_m) {
  LUXRIG_CHECK(scale_m > 0, "scale {}", scale_m);
  LUXRIG_CHECK(picture.width_px == camera.width_px && picture.height_px == camera.height_px, "{} x {} pixels",
               picture.width_px, picture.height_px);
  const WindowSums sums(picture);
  PictureContrast contrast;
  for (const OrientedPoint& point : points) {
    const auto place = seen_place(camera, scene, point);
    if (!place) continue;
    const double half_px = std::max(1.0, scale_m * place->px_per_m);
    const auto clamped = [](double at, int size) {
      return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(size)));
    };
    const std::size_t x0 = clamped(std::floor(place->x_px - half_px), picture.width_px),
                      x1 = clamped(std::ceil(place->x_px + half_px), picture.width_px),
                      y0 = clamped(std::floor(place->y_px - half_px), picture.height_px),
                      y1 = clamped(std::ceil(place->y_px + half_px), picture.height_px);
    const Eigen::Vector2d sum = sums.of(x0, y0, x1, y1);
    const auto count = static_cast<double>((x1 - x0) * (y1 - y0));
    const double mean = sum[0] / count, variance = std::max(0.0, sum[1] / count - mean * mean);
    ++contrast.seen;
    if (!(mean > 0)) continue;
    contrast.local_contrast += std::sqrt(variance) / mean;
    contrast.mean_cd_m2 += mean;
  }
  if (contrast.seen > 0) {
    contrast.local_contrast /= static_cast<double>(contrast.seen);
    contrast.mean_cd_m2 /= static_cast<double>(contrast.seen);
  }
  return contrast;
}

}  // namespace luxrig
