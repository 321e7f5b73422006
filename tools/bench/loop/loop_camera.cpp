#include "tools/bench/loop/loop_camera.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/calibration/camera_pose.h"
#include "core/calibration/exposures.h"
#include "core/picture/rig_camera.h"
#include "tools/luxrig/room_view.h"

namespace luxrig {
namespace {

constexpr int kPlaces = 90;  // of all cameras, that are no points of the rig
constexpr int kWidth_px = 640, kHeight_px = 400;
constexpr int kPasses = 8;  // 25 pixels of a place: 200 samples
constexpr double kBracket = 16;
constexpr double kFieldOfView_rad = 1.2;

/// Median over what a sees.
double apart_px(const RayScene& rays, const Camera& a, const Camera& b) {
  constexpr int kAcross = 20;
  std::vector<double> apart;
  for (int i = 0; i < kAcross * kAcross; ++i) {
    const double x_px = (i % kAcross + 0.5) / kAcross * a.width_px, y_px = (i / kAcross + 0.5) / kAcross * a.height_px;
    const auto hit = rays.nearest(a.eye_world_m, ray_direction(a, x_px, y_px), Vec3::Zero());
    if (!hit) continue;
    if (const auto place = pixel_of(b, hit->position_world_m))
      apart.push_back(std::hypot(place->x_px - x_px, place->y_px - y_px));
  }
  if (apart.empty()) return NAN;
  const auto middle = apart.begin() + static_cast<std::ptrdiff_t>(apart.size() / 2);
  std::nth_element(apart.begin(), middle, apart.end());
  return *middle;
}

PictureCamera camera_of_the_room(const Session& session) {
  std::vector<Joints> joints;
  for (const Fixture& fixture : session.rig.fixtures) joints.push_back(fixture.joints);
  const Camera view = automatic_camera(*session.rays, session.rig, joints, kWidth_px, kHeight_px, kFieldOfView_rad);
  PictureCamera camera;
  camera.name = "bench";
  camera.position_world_m = view.eye_world_m;
  camera.aim_world_m = view.target_world_m;
  camera.vertical_fov_rad = view.vertical_fov_rad;
  camera.width_px = view.width_px;
  camera.height_px = view.height_px;
  return camera;
}

}  // namespace

Result<SeenRig> see(const Session& session) {
  std::vector<PictureCamera> cameras = session.rig.cameras;
  if (cameras.empty()) cameras.push_back(camera_of_the_room(session));
  SeenRig seen;
  std::vector<SeenPlace> all;
  for (const PictureCamera& camera : cameras) {
    auto places =
        seen_places(*session.rays, view_of(camera), session.rig.points, kPlaces / static_cast<int>(cameras.size()));
    seen.each.push_back({camera, places, session.rig.points.size() + all.size()});
    all.insert(all.end(), places.begin(), places.end());
  }
  seen.places = all.size();
  auto with = session_of(with_places(session.rig, all));
  if (!with) return tl::unexpected(Fault{Cause::invalid, "", with.error().front().text(), {}});
  seen.session = std::move(*with);
  return seen;
}

Photographer::Photographer(const SeenBy& seen, std::size_t index, const Session& stated, const sim::World& world,
                           const RayScene& true_rays, const sim::Deviations& deviations)
    : seen_(seen),
      stated_(stated),
      world_(world),
      true_rays_(true_rays),
      seed_(deviations.seed),
      truth_(sim::draw_camera(stated.rig, seen.camera, index, deviations, &true_rays)) {}

Result<Picture> Photographer::bracket() {
  sim::Shot shot;
  shot.seed = seed_;
  shot.passes = kPasses;
  shot.number = shots_++;
  const auto light = sim::light_on_sensor(true_rays_, stated_.rig, world_.fixtures(),
                                          {world_.levels(), world_.joints()}, truth_, shot);
  if (!light) return tl::unexpected(light.error());
  std::vector<Picture> exposures{sim::exposed(*light, sim::Sensor{}, shot)};
  shot.underexposed = kBracket;
  shot.number = shots_++;
  exposures.push_back(sim::exposed(*light, sim::Sensor{}, shot));
  return merged_exposures(exposures);
}

Result<void> Photographer::look() {
  const auto picture = bracket();
  if (!picture) return tl::unexpected(picture.error());
  const Camera stated = view_of(seen_.camera);
  taken_.stated_off_px = apart_px(true_rays_, truth_.view, stated);
  const auto found = find_camera(*stated_.rays, stated, *picture);
  if (!found) {
    taken_.refused = found.error().detail;
    taken_.places.resize(seen_.places.size());
    return {};
  }
  taken_.off_px = apart_px(true_rays_, truth_.view, found->camera);
  taken_.places = places_by(*stated_.rays, found->camera, seen_.places);
  return {};
}

Result<void> Photographer::take(std::size_t fixture) {
  const auto picture = bracket();
  if (!picture) return tl::unexpected(picture.error());
  Picture dark = *picture;  // this rig has no other light
  for (Vec3f& pixel : dark.luminance_cd_m2) pixel.setZero();
  taken_.of_lamp.resize(stated_.rig.fixtures.size());
  taken_.of_lamp[fixture] = seen_light(*picture, dark, taken_.places);
  return {};
}

}  // namespace luxrig
