#include "tools/bench/highlight/picture_reading.h"

#include <algorithm>
#include <cmath>

#include "core/highlight/picture/picture_contrast.h"
#include "core/photometry/light_colour.h"

namespace luxrig {
namespace {

constexpr double kGrey = 0.18, kPaperBlack = 0.01, kInShadow = 0.25;

double lightness(double of_white) {
  return of_white > 216.0 / 24389 ? 116 * std::cbrt(of_white) - 16 : 24389.0 / 27 * of_white;
}

}  // namespace

PictureReading read_picture(const Picture& picture, const Camera& camera, const RayScene& room, const RayScene& object,
                            std::span<const OrientedPoint> relief, double window_m) {
  const auto width = static_cast<std::size_t>(picture.width_px), height = static_cast<std::size_t>(picture.height_px);
  std::vector<double> cd_m2(width * height);
  std::vector<bool> of_object(width * height);
  double sum = 0, pixels = 0;
  for (std::size_t p = 0; p < cd_m2.size(); ++p) {
    cd_m2[p] = luminance_of_rgb(picture.luminance_cd_m2[p].cast<double>());
    const Vec3 ray = ray_direction(camera, static_cast<double>(p % width) + 0.5, static_cast<double>(p / width) + 0.5);
    const auto own = object.nearest(camera.eye_world_m, ray, Vec3::Zero()),
               any = room.nearest(camera.eye_world_m, ray, Vec3::Zero());
    of_object[p] = own && own->distance_m < any->distance_m + 1e-3;
    if (!of_object[p]) continue;
    sum += cd_m2[p];
    ++pixels;
  }
  PictureReading reading;
  if (!(sum > 0)) return {0, 0, 1};
  const double white_cd_m2 = sum / pixels / kGrey;
  for (std::size_t p = 0; p < cd_m2.size(); ++p) {
    const double of_white = cd_m2[p] / white_cd_m2;
    if (of_object[p] && (of_white > 1 || of_white < kPaperBlack)) reading.clipped += 1 / pixels;
    cd_m2[p] = of_white;
  }
  double points = 0;
  for (const OrientedPoint& point : relief) {
    const auto place = seen_place(camera, room, point);
    if (!place) continue;
    const double half_px = std::max(2.0, window_m * place->px_per_m);
    const auto within = [](double at, std::size_t size) {
      return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(size)));
    };
    double mean = 0, squares = 0, here = 0, count = 0;
    for (std::size_t y = within(place->y_px - half_px, height); y < within(place->y_px + half_px, height); ++y)
      for (std::size_t x = within(place->x_px - half_px, width); x < within(place->x_px + half_px, width); ++x) {
        if (!of_object[y * width + x]) continue;
        const double value = lightness(std::min(cd_m2[y * width + x], 1.0)) / 100;
        mean += value;
        squares += value * value;
        ++count;
      }
    here = cd_m2[within(place->y_px, height - 1) * width + within(place->x_px, width - 1)];
    if (!(count > 0)) continue;
    ++points;
    reading.contrast += std::sqrt(std::max(0.0, squares / count - mean * mean / count / count));
    reading.lit += here >= kInShadow * kGrey ? 1 : 0;
  }
  reading.contrast /= std::max(1.0, points);
  reading.lit /= std::max(1.0, points);
  return reading;
}

}  // namespace luxrig
