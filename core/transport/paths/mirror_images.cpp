#include "core/transport/paths/mirror_images.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "core/transport/bsdf.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxPlanes = 64, kMaxImages = 4096;
/// Planes smaller than this share of the largest are left to other ways.
constexpr double kMinArea = 1e-3;
/// Rougher surfaces show no highlights that other ways would miss.
constexpr double kMaxAlpha = 0.25;
/// Images that bring less than this share of the total are not searched for.
constexpr double kMinImageShare = 1e-3;
/// Triangles are in one plane if normals agree to this, and offsets to this share of the scene's size.
constexpr double kSameNormal = 1e-5, kSameOffset = 1e-6;

/// GGX slopes (B. Walter et al. 2007).
double slope_density(double squared, double alpha) {
  const double a2 = alpha * alpha, t = 1 + squared / a2;
  return 1 / (kPi * a2 * t * t);
}

/// Share of the light from slopes beyond a distance.
double slope_tail(double squared, double alpha) { return 1 / (1 + squared / (alpha * alpha)); }

ImageChoice choice_of_images(const std::vector<double>& weights) {
  ImageChoice choice;
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  if (!(sum > 0) || !std::isfinite(sum)) return choice;
  double kept = 0, up_to = 0;
  for (const double w : weights) kept += w >= kMinImageShare * sum ? w : 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (!(weights[i] >= kMinImageShare * sum)) continue;
    up_to += weights[i] / kept;
    choice.images.push_back({static_cast<std::uint32_t>(i), up_to});
  }
  return choice;
}

}  // namespace

double ImageChoice::probability(std::uint32_t image) const {
  const auto at = std::lower_bound(images.begin(), images.end(), image,
                                   [](const Image& one, std::uint32_t wanted) { return one.image < wanted; });
  if (at == images.end() || at->image != image) return 0;
  return at == images.begin() ? at->up_to : at->up_to - (at - 1)->up_to;
}

MirrorImages::MirrorImages(const RayScene& scene, const EmitterSampler& lamps)
    : lamps_(lamps), places_(lamps.luminous_places()) {
  if (places_ == 0 || places_ > kMaxImages) return;
  find_planes(scene);
  std::vector<double> weights;
  for (const Plane& plane : planes_)
    for (std::size_t p = 0; p < places_; ++p) weights.push_back(plane.area_m2 * plane.specular * lamps.place_share(p));
  from_anywhere_ = choice_of_images(weights);
}

void MirrorImages::find_planes(const RayScene& scene) {
  const auto materials = scene.materials();
  const auto shows = [&](const Material& m) { return m.specular_reflectance > 0 && Bsdf::alpha_of(m) <= kMaxAlpha; };
  if (std::none_of(materials.begin(), materials.end(), shows)) return;
  const Vec3 centre_world_m = scene.bounds_world_m().center();
  const double size_m = std::max(scene.bounds_world_m().diagonal().norm(), 1e-100);
  std::map<std::tuple<std::uint32_t, long, long, long, long>, std::uint32_t> known;
  std::vector<std::uint32_t> found_of(scene.triangles(), kNoPlane);
  std::vector<Plane> found;
  for (std::uint32_t t = 0; t < found_of.size(); ++t) {
    const std::uint32_t material = scene.material_index_of(t);
    if (!shows(materials[material])) continue;
    const auto [a, b, c] = scene.corners_world_m(t);
    const Vec3 twice = (b - a).cross(c - a);
    const double area_m2 = 0.5 * twice.norm();
    if (!(area_m2 > 0)) continue;
    Vec3 normal = twice / (2 * area_m2);
    Eigen::Index largest = 0;
    normal.cwiseAbs().maxCoeff(&largest);
    if (normal[largest] < 0) normal = -normal;
    const auto step = [](double x, double of) { return std::lround(x / of); };
    const double offset_m = normal.dot(a - centre_world_m);
    const auto [at, is_new] = known.try_emplace({material, step(normal.x(), kSameNormal), step(normal.y(), kSameNormal),
                                                 step(normal.z(), kSameNormal), step(offset_m, kSameOffset * size_m)},
                                                static_cast<std::uint32_t>(found.size()));
    if (is_new) {
      const Frame frame(normal);
      found.push_back({normal,
                       normal.dot(a),
                       material,
                       Bsdf::alpha_of(materials[material]),
                       materials[material].specular_reflectance,
                       0,
                       frame.tangent,
                       frame.bitangent,
                       {}});
    }
    Plane& plane = found[at->second];
    plane.area_m2 += area_m2;
    for (const Vec3& corner : {a, b, c})
      plane.bounds_m.extend(Eigen::Vector2d(plane.across_world.dot(corner), plane.along_world.dot(corner)));
    found_of[t] = at->second;
  }
  std::vector<std::uint32_t> order(found.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return found[a].area_m2 * found[a].specular > found[b].area_m2 * found[b].specular;
  });
  std::vector<std::uint32_t> kept_as(found.size(), kNoPlane);
  for (const std::uint32_t at : order) {
    if (planes_.size() == std::min(kMaxPlanes, kMaxImages / places_)) break;
    if (found[at].area_m2 < kMinArea * found[order.front()].area_m2) continue;
    kept_as[at] = static_cast<std::uint32_t>(planes_.size());
    planes_.push_back(found[at]);
  }
  plane_of_.assign(found_of.size(), kNoPlane);
  for (std::size_t t = 0; t < found_of.size(); ++t)
    if (found_of[t] != kNoPlane) plane_of_[t] = kept_as[found_of[t]];
}

std::optional<MirrorImages::Image> MirrorImages::image(const Plane& plane, std::size_t place_of_lamp,
                                                       const Vec3& from_world_m) const {
  const Vec3& lamp_world_m = lamps_.place_world_m(place_of_lamp);
  double height_m = plane.normal_world.dot(from_world_m) - plane.offset_m;
  double lamp_height_m = plane.normal_world.dot(lamp_world_m) - plane.offset_m;
  Image image;
  image.normal_world = height_m < 0 ? Vec3(-plane.normal_world) : plane.normal_world;
  if (height_m < 0) height_m = -height_m, lamp_height_m = -lamp_height_m;
  const double heights_m = height_m + lamp_height_m;
  if (!(height_m > 1e-6 * heights_m) || !(lamp_height_m > 1e-6 * heights_m)) return std::nullopt;
  const Vec3 from_foot_world_m = from_world_m - height_m * image.normal_world;
  const Vec3 along_m = lamp_world_m - lamp_height_m * image.normal_world - from_foot_world_m;
  const double across_distance_m = along_m.norm();
  image.way_m = std::hypot(across_distance_m, heights_m);
  const double cosine = heights_m / image.way_m;
  image.foot_world_m = from_foot_world_m + height_m / heights_m * along_m;
  image.along_world = across_distance_m > 1e-9 * heights_m ? Vec3(along_m / across_distance_m) : plane.along_world;
  image.across_world = image.normal_world.cross(image.along_world);
  const double to_lamp_m = image.way_m * lamp_height_m / heights_m;
  const double k = heights_m * heights_m / (image.way_m * height_m * lamp_height_m) / (2 * cosine);
  image.per_slope_across = k;
  image.per_slope_along = k * cosine * cosine;
  image.alpha = std::hypot(plane.alpha, lamps_.radius_m(place_of_lamp) / (2 * to_lamp_m * cosine));
  return image;
}

double MirrorImages::density_per_m2(const Image& image, const Vec3& position_world_m) {
  const Vec3 off_m = position_world_m - image.foot_world_m;
  const double along = image.per_slope_along * image.along_world.dot(off_m);
  const double across = image.per_slope_across * image.across_world.dot(off_m);
  return slope_density(along * along + across * across, image.alpha) * image.per_slope_along * image.per_slope_across;
}

double MirrorImages::density_per_m2(const ImageChoice& choice, const Vec3& from_world_m, std::uint32_t plane,
                                    std::size_t place_of_lamp, const Vec3& position_world_m) const {
  if (plane == kNoPlane || place_of_lamp >= places_) return 0;
  const double probability =
      choice.probability(plane * static_cast<std::uint32_t>(places_) + static_cast<std::uint32_t>(place_of_lamp));
  if (!(probability > 0)) return 0;
  const auto image = this->image(planes_[plane], place_of_lamp, from_world_m);
  return image ? probability * density_per_m2(*image, position_world_m) : 0;
}

MirrorImages::ImagePoint MirrorImages::draw(const ImageChoice& choice, const Vec3& from_world_m, double select,
                                            double u, double v) const {
  ImagePoint place;
  if (choice.images.empty()) return place;
  const auto at = std::min(std::upper_bound(choice.images.begin(), choice.images.end(), select,
                                            [](double s, const ImageChoice::Image& one) { return s < one.up_to; }),
                           choice.images.end() - 1);
  const std::size_t plane = at->image / places_, lamp = at->image % places_;
  const auto image = this->image(planes_[plane], lamp, from_world_m);
  if (!image) return place;
  const double slope = image->alpha * std::sqrt(u / (1 - u)), angle_rad = 2 * kPi * v;
  place.position_world_m = image->foot_world_m +
                           slope * std::cos(angle_rad) / image->per_slope_along * image->along_world +
                           slope * std::sin(angle_rad) / image->per_slope_across * image->across_world;
  const Plane& on = planes_[plane];
  const Eigen::Vector2d in_plane_m(on.across_world.dot(place.position_world_m),
                                   on.along_world.dot(place.position_world_m));
  if (!on.bounds_m.contains(in_plane_m)) return place;
  place.normal_world = image->normal_world;
  place.place_of_lamp = lamp;
  place.density_per_m2 = choice.probability(at->image) * density_per_m2(*image, place.position_world_m);
  if (place.density_per_m2 > 0 && std::isfinite(place.density_per_m2)) place.plane = static_cast<std::uint32_t>(plane);
  return place;
}

ImageChoice MirrorImages::seen_from(const Vec3& position_world_m, const Vec3& normal_world) const {
  std::vector<double> weights;
  for (const Plane& plane : planes_)
    for (std::size_t p = 0; p < places_; ++p) {
      weights.push_back(0);
      const auto image = this->image(plane, p, position_world_m);
      if (!image) continue;
      const Vec3 towards_foot_m = image->foot_world_m - position_world_m;
      const double cosine = normal_world.dot(towards_foot_m) / towards_foot_m.norm();
      // Outside the plane's own area only such distant slopes contribute.
      const Eigen::Vector2d foot_m(plane.across_world.dot(image->foot_world_m),
                                   plane.along_world.dot(image->foot_world_m));
      const double off = image->per_slope_along * plane.bounds_m.exteriorDistance(foot_m);
      const double shown = slope_tail(off * off, image->alpha);
      const Vec3 leaving = (image->foot_world_m - lamps_.place_world_m(p)).normalized();
      weights.back() = plane.specular * lamps_.importance_cd(p, leaving) * std::max(cosine, 0.05) * shown /
                       (image->way_m * image->way_m);
    }
  return choice_of_images(weights);
}

}  // namespace luxrig
