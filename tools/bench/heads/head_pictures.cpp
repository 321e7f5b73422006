#include "tools/bench/heads/head_pictures.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "sim/world/random.h"

namespace luxrig {
namespace {

constexpr double kRoom_lx = 20;  ///< of the room's own light, which the pictures with and without the lamp share
constexpr double kMirrorShare = 0.85, kMirrorLike = 0.3;
constexpr double kFullWell = 20000, kReadNoise = 5, kExposed = 0.8;
constexpr double kSteps = 4095;
constexpr std::size_t kNoiseValues = 1 << 20;
constexpr double kNearestBounce_m = 0.4;

/// Paint is not the same all over, and it is of patches this large.
constexpr double kUneven = 0.03, kPatch_m = 0.25;

/// Paint at a place over its mean: random at the corners of a grid, and linear between.
double unevenness(const Vec3& at_m, std::uint64_t seed) {
  const Vec3 in_cells = at_m / kPatch_m;
  const Vec3 cell = in_cells.array().floor().matrix(), within = in_cells - cell;
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double share = 1;
    std::uint64_t key = seed;
    for (int axis = 0; axis < 3; ++axis) {
      const int step = corner >> axis & 1;
      share *= step ? within[axis] : 1 - within[axis];
      key = sim::mix64(key ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(cell[axis]) + step));
    }
    sum += share * (static_cast<double>(key >> 11) * 0x1p-52 - 1);
  }
  return 1 + std::sqrt(3.0) * kUneven * sum;
}

}  // namespace

HeadPictures::HeadPictures(const RayScene& rays, const Camera& camera, const Mat3& camera_turn, std::uint64_t seed)
    : rays_(rays), width_px_(camera.width_px), height_px_(camera.height_px), taken_(seed) {
  find_mirror();
  for (int y = 0; y < height_px_; ++y)
    for (int x = 0; x < width_px_; ++x)
      seen_.push_back(seen_along(camera.eye_world_m, camera_turn * ray_direction(camera, x + 0.5, y + 0.5), 1));
  std::mt19937_64 random(seed);
  std::normal_distribution<float> normal;
  noise_.resize(kNoiseValues);
  for (float& value : noise_) value = normal(random);
}

void HeadPictures::find_mirror() {
  for (std::uint32_t t = 0; t < rays_.triangles(); ++t) {
    if (rays_.material_of(t).specular_reflectance < kMirrorLike) continue;
    const auto corners = rays_.corners_world_m(t);
    const Vec3 along_m = corners[1] - corners[0], up_m = corners[2] - corners[0];
    Vec3 normal = along_m.cross(up_m).normalized();
    const Vec3 centre_m = rays_.bounds_world_m().center();
    if (normal.dot(centre_m - corners[0]) < 0) normal = -normal;
    mirrors_.push_back({corners[0], along_m, up_m, normal});  // a triangle: see by_mirror_lx
  }
}

std::optional<HeadPictures::Seen> HeadPictures::seen_along(const Vec3& from_m, const Vec3& direction,
                                                           float share) const {
  const auto hit = rays_.nearest(from_m, direction, Vec3::Zero());
  if (!hit) return std::nullopt;
  const Material& paint = rays_.material_of(hit->triangle);
  if (paint.specular_reflectance > kMirrorLike && share == 1) {
    const Vec3 back = direction - 2 * direction.dot(hit->normal_world) * hit->normal_world;
    return seen_along(hit->position_world_m + 1e-3 * back, back, static_cast<float>(kMirrorShare));
  }
  return Seen{hit->position_world_m, hit->normal_world,
              static_cast<float>(paint.luminous_reflectance() * unevenness(hit->position_world_m, taken_)), share};
}

double HeadPictures::direct_lx(const Seen& at, const Beam& beam) const {
  const Vec3 to_m = at.position_m - beam.world_from_lamp.translation_m;
  const double square_m2 = to_m.squaredNorm();
  const Vec3 direction = to_m / std::sqrt(square_m2);
  const double cosine = -direction.dot(at.normal);
  if (!(cosine > 0)) return 0;
  const double candela = beam.intensity->intensity_cd(beam.world_from_lamp.inverse_direction(direction));
  if (!(candela > 0) || rays_.occluded(at.position_m, at.normal, beam.world_from_lamp.translation_m)) return 0;
  return candela * cosine / square_m2;
}

/// The lamp's mirror image lights what it sees through the mirror.
double HeadPictures::by_mirror_lx(const Seen& at, const Beam& beam) const {
  const Vec3 lamp_m = beam.world_from_lamp.translation_m;
  double lux = 0;
  for (const Mirror& mirror : mirrors_) {
    const double behind_m = (lamp_m - mirror.corner_m).dot(mirror.normal);
    if (!(behind_m > 0) || (at.position_m - mirror.corner_m).dot(mirror.normal) < 1e-3) continue;
    const Vec3 image_m = lamp_m - 2 * behind_m * mirror.normal;
    const Vec3 to_m = at.position_m - image_m;
    const double crosses = behind_m / to_m.dot(mirror.normal);
    const Vec3 on_m = image_m + crosses * to_m - mirror.corner_m;
    // Barycentric coordinates in the triangle.
    const double aa = mirror.along_m.squaredNorm(), ab = mirror.along_m.dot(mirror.up_m),
                 bb = mirror.up_m.squaredNorm();
    const double a = on_m.dot(mirror.along_m), b = on_m.dot(mirror.up_m), whole = aa * bb - ab * ab;
    const double u = (bb * a - ab * b) / whole, v = (aa * b - ab * a) / whole;
    if (!(u >= 0 && v >= 0 && u + v <= 1)) continue;
    const Vec3 from_lamp = (on_m + mirror.corner_m - lamp_m).normalized();
    const double square_m2 = to_m.squaredNorm(), cosine = -to_m.dot(at.normal) / std::sqrt(square_m2);
    if (!(cosine > 0)) continue;
    const double candela = beam.intensity->intensity_cd(beam.world_from_lamp.inverse_direction(from_lamp));
    lux += kMirrorShare * candela * cosine / square_m2;
  }
  return lux;
}

Picture HeadPictures::take(const std::optional<Beam>& beam) {
  Picture picture;
  picture.width_px = width_px_;
  picture.height_px = height_px_;
  picture.luminance_cd_m2.assign(seen_.size(), Vec3f::Zero());
  // Where the axis falls, it is a lamp itself.
  std::optional<Seen> bounce;
  if (beam)
    bounce = seen_along(beam->world_from_lamp.translation_m, beam->world_from_lamp.direction(-Vec3::UnitZ()), 1);
  std::vector<double> luminance(seen_.size(), 0.0);
  double most = 0;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    if (!seen_[i]) continue;
    const Seen& at = *seen_[i];
    double lux = kRoom_lx;
    if (beam) lux += direct_lx(at, *beam) + by_mirror_lx(at, *beam);
    if (bounce) {
      const Vec3 to_m = at.position_m - bounce->position_m;
      const double square_m2 = std::max(to_m.squaredNorm(), kNearestBounce_m * kNearestBounce_m);
      const double leaves = to_m.normalized().dot(bounce->normal), arrives = -to_m.normalized().dot(at.normal);
      if (leaves > 0 && arrives > 0)
        lux += beam->intensity->flux_lm() * static_cast<double>(bounce->reflectance * bounce->share) / kPi * leaves *
               arrives / square_m2;
    }
    luminance[i] = lux * static_cast<double>(at.reflectance * at.share) / kPi;
    most = std::max(most, luminance[i]);
  }
  if (!(most > 0)) return picture;
  const double full = most / kExposed;
  std::size_t at = static_cast<std::size_t>((taken_++ * 0x9e3779b97f4a7c15U) >> 20);
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const double electrons = luminance[i] / full * kFullWell;
    const double noise =
        std::sqrt(electrons + kReadNoise * kReadNoise) * static_cast<double>(noise_[at++ % kNoiseValues]);
    const double share = std::clamp((electrons + noise) / kFullWell, 0.0, 1.0);
    picture.luminance_cd_m2[i].setConstant(static_cast<float>(std::round(share * kSteps) / kSteps * full));
  }
  return picture;
}

}  // namespace luxrig
