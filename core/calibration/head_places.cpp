#include "core/calibration/head_places.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace luxrig {
namespace {

constexpr int kPlaceColumns = 24, kPlaceRows = 15, kRimPlaces = 12;
constexpr double kLeastCosineAtPlace = 0.25, kNearest_m = 0.5;
/// The beam may be so much off the place by what is not known yet.
constexpr double kBeamMargin_rad = rad_from_deg(1);
constexpr int kSearchAims = 14, kSearchPlaces = 30;
constexpr double kApart_rad = rad_from_deg(8);
/// The pan shows only where the beam is not along its axis.
constexpr double kLeastSearchTilt_rad = rad_from_deg(15);
/// Nearer to the border of the picture, a beam is cut if the head hangs a little off.
constexpr double kSearchBorder = 0.12;
constexpr double kSameSurface_m = 0.2;
/// A kind with one more oddity is so much less likely; one that an aim would have shown is, too.
constexpr double kPerOddity = 0.1, kNotShown = 0.3;

/// Half angle within which a beam is above a third of its peak.
double beam_radius_rad(const IntensityDistribution& intensity) {
  double angle_rad = 0;
  while (angle_rad < kPi / 4 &&
         intensity.intensity_cd(Vec3(std::sin(angle_rad), 0, -std::cos(angle_rad))) > intensity.max_intensity_cd() / 3)
    angle_rad += rad_from_deg(0.25);
  return angle_rad;
}

/// Directions evenly on a cone.
Vec3 on_cone(const Vec3& axis, double angle_rad, double about_rad) {
  const Vec3 aside = axis.unitOrthogonal();
  return std::cos(angle_rad) * axis +
         std::sin(angle_rad) * (std::cos(about_rad) * aside + std::sin(about_rad) * axis.cross(aside));
}

/// What the camera sees at a place; nullptr = nothing, or something before it.
const SurfacePixel* seen_at(const SeenSurface& surface, const Vec3& place_world_m, double border) {
  const auto at = pixel_of(surface.camera, place_world_m);
  if (!at) return nullptr;
  const double x = at->x_px / surface.camera.width_px, y = at->y_px / surface.camera.height_px;
  if (!(x > border && x < 1 - border && y > border && y < 1 - border)) return nullptr;
  const SurfacePixel& pixel = surface.at(static_cast<int>(at->x_px), static_cast<int>(at->y_px));
  if (!pixel.seen() || (surface.position_world_m(pixel) - place_world_m).norm() > kSameSurface_m) return nullptr;
  return &pixel;
}

std::optional<HeadPlace> place_at_pixel(const SeenSurface& surface, const RayScene& rays, const HeadSetup& setup,
                                        const SurfacePixel& pixel) {
  if (!pixel.seen()) return std::nullopt;
  const Vec3 pivot_m = setup.stated.translation_m;
  HeadPlace place{surface.position_world_m(pixel), pixel.normal.cast<double>(), surface.is_large(pixel.plane)};
  const Vec3 to_m = place.position_world_m - pivot_m;
  const double distance_m = to_m.norm();
  if (distance_m < kNearest_m || -to_m.dot(place.normal_world) < kLeastCosineAtPlace * distance_m ||
      rays.occluded(place.position_world_m, place.normal_world, pivot_m))
    return std::nullopt;
  // The rim, and a ring within, as a thing may stand there.
  for (int k = 0; k < 2 * kRimPlaces; ++k) {
    const double angle_rad = (setup.beam_radius_rad + kBeamMargin_rad) * (k % 2 ? 0.55 : 1.0);
    const Vec3 along = on_cone(to_m / distance_m, angle_rad, kPi * k / kRimPlaces);
    const auto hit = rays.nearest(pivot_m, along, Vec3::Zero());
    const SurfacePixel* rim = hit ? seen_at(surface, hit->position_world_m, 0) : nullptr;
    if (!rim) return std::nullopt;
    place.on_one_plane = place.on_one_plane && rim->plane == pixel.plane;
  }
  return place;
}

/// Per kind, whether the beam would be seen.
std::vector<std::uint8_t> kinds_that_show(const SeenSurface& surface, const RayScene& rays,
                                          std::span<const HeadPose> heads, const Joints& sent) {
  std::vector<std::uint8_t> shows;
  for (const HeadPose& head : heads) {
    const auto hit = rays.nearest(head.pivot_world_m(), head.beam_world(sent, {}), Vec3::Zero());
    shows.push_back(hit && seen_at(surface, hit->position_world_m, kSearchBorder));
  }
  return shows;
}

}  // namespace

JointRange with_run_up(const JointRange& range) {
  JointRange inner = range;
  inner.pan_min_rad += kRunUp_rad;
  inner.pan_max_rad -= kRunUp_rad;
  inner.tilt_min_rad += kRunUp_rad;
  inner.tilt_max_rad -= kRunUp_rad;
  return inner;
}

bool may_aim(const HeadSetup& setup, const Joints& aim, const Approach& from) {
  return !setup.barred || !(setup.barred(aim) || setup.barred(run_up_to(aim, from)));
}

HeadSetup head_setup(const Rig& rig, std::size_t fixture, const HeadPriors& priors) {
  const Fixture& head = rig.fixtures[fixture];
  HeadSetup setup;
  setup.stated = head.world_from_mount;
  setup.range = head.range;
  setup.pan_speed_rad_s = head.pan_speed_rad_s;
  setup.tilt_speed_rad_s = head.tilt_speed_rad_s;
  setup.beam_radius_rad = beam_radius_rad(*rig.luminaires[head.luminaire].intensity);
  setup.priors = priors;
  return setup;
}

std::vector<HeadPlace> head_places(const SeenSurface& surface, const RayScene& rays, const HeadSetup& setup) {
  std::vector<HeadPlace> places;
  for (int row = 0; row < kPlaceRows; ++row)
    for (int column = 0; column < kPlaceColumns; ++column) {
      const int x_px = (2 * column + 1) * surface.camera.width_px / (2 * kPlaceColumns);
      const int y_px = (2 * row + 1) * surface.camera.height_px / (2 * kPlaceRows);
      if (const auto place = place_at_pixel(surface, rays, setup, surface.at(x_px, y_px))) places.push_back(*place);
    }
  return places;
}

std::vector<Joints> search_aims(const SeenSurface& surface, const RayScene& rays, const HeadSetup& setup,
                                std::span<const HeadPlace> places) {
  std::vector<HeadPose> heads;
  std::vector<double> likely;
  for (const HeadKind& kind : head_kinds()) {
    heads.push_back(start_of(setup.stated, kind));
    likely.push_back(std::pow(kPerOddity, kind.oddities()));
  }
  struct AimCandidate {
    Joints joints;
    std::vector<std::uint8_t> shows;
  };
  std::vector<AimCandidate> candidates;
  const JointRange range = with_run_up(setup.range);
  const std::size_t step = std::max<std::size_t>(1, places.size() / kSearchPlaces);
  for (std::size_t p = 0; p < places.size(); p += step)
    for (const HeadPose& head : heads) {
      const auto joints = head.joints_towards(places[p].position_world_m - head.pivot_world_m(), {}, range, {});
      if (!joints || std::abs(std::sin(joints->tilt_rad)) < std::sin(kLeastSearchTilt_rad)) continue;
      if (!may_aim(setup, *joints, {})) continue;
      candidates.push_back({*joints, kinds_that_show(surface, rays, heads, *joints)});
    }
  std::vector<Joints> aims;
  for (int k = 0; k < kSearchAims; ++k) {
    const AimCandidate* best = nullptr;
    double most = 0;
    for (const AimCandidate& candidate : candidates) {
      double gain = 0;
      for (std::size_t h = 0; h < heads.size(); ++h) gain += candidate.shows[h] ? likely[h] : 0;
      if (gain <= most) continue;
      most = gain;
      best = &candidate;
    }
    if (!best) break;
    const Joints chosen = best->joints;
    aims.push_back(chosen);
    for (std::size_t h = 0; h < heads.size(); ++h)
      if (best->shows[h]) likely[h] *= kNotShown;
    // What it did not show, its neighbours do not show either.
    std::erase_if(candidates, [&](const AimCandidate& c) {
      return std::abs(c.joints.pan_rad - chosen.pan_rad) < kApart_rad &&
             std::abs(c.joints.tilt_rad - chosen.tilt_rad) < kApart_rad;
    });
  }
  return aims;
}

}  // namespace luxrig
