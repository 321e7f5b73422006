#include "core/tasks/seen_task.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/highlight/picture/object_view.h"
#include "core/parallel.h"
#include "core/scene/object_scene.h"

namespace luxrig {
namespace {

/// Of a picture from one camera; several views are coarser, so that all take as long as one.
constexpr int kFine_px = 96, kFineOfSeveral_px = 64, kQuick_px = 48, kQuickOfSeveral_px = 32;
/// A visitor's view of the object, where no camera is named.
constexpr double kViewFov_rad = rad_from_deg(35), kViewFill = 0.9;
/// Reflected light is smooth: its mean over this many places, to this error.
constexpr std::size_t kReflectedPlaces = 32;
constexpr double kReflectedError = 0.1;

/// Lux of the sample of the object that is nearest and faces alike.
std::vector<float> spread_over(const SeenContrast& seen, const StudiedObject& object, std::span<const double> lux,
                               int threads) {
  std::vector<float> spread(seen.samples().size(), 0);
  if (std::ranges::all_of(lux, [](double one) { return one == 0; })) return spread;
  const double scale_m = object.study.surface.diagonal_m() / 4;  // facing away counts as so far
  parallel_for(spread.size(), threads, [&](std::size_t s) {
    const OrientedPoint& at = seen.samples()[s];
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < lux.size(); ++i) {
      const OrientedPoint& known = object.samples.points[i];
      const double apart_m2 = (known.position_world_m - at.position_world_m).squaredNorm() +
                              scale_m * scale_m * (known.normal - at.normal).squaredNorm();
      if (apart_m2 >= nearest) continue;
      nearest = apart_m2;
      spread[s] = static_cast<float>(lux[i]);
    }
  });
  return spread;
}

std::vector<Vec3> eyes_of(const ReliefSurroundings& around, const StudiedObject& object, const ReliefSpec& relief,
                          const RayScene& alone) {
  if (relief.camera) return {around.rig.cameras[*relief.camera].position_world_m};
  std::vector<Vec3> shown_world_m;
  const TargetSurface& surface = object.study.surface;
  for (std::uint32_t i = 0; i < surface.points_m.size(); ++i) shown_world_m.push_back(surface.point_world_m(i));
  std::vector<Sight> wanted;
  for (const OrientedPoint& point : object.study.points) wanted.push_back({point.position_world_m, point.normal});
  const CutAwayCamera view =
      camera_that_sees(around.rays, shown_world_m, wanted, kViewFill, kViewFov_rad, kFine_px, kFine_px);
  return eyes_around(alone, view.camera.eye_world_m);
}

}  // namespace

Result<SeenObject> seen_object(const ReliefSurroundings& around, const StudiedObject& object, const ReliefSpec& relief,
                               std::span<const double> fixed_lux, const ComputeOptions& options) {
  const auto mesh = object_scene(around.scene, around.rig.scene.objects[relief.object].name);
  if (!mesh) return tl::unexpected(mesh.error());
  const RayScene alone(*mesh);
  const std::vector<Vec3> eyes = eyes_of(around, object, relief, alone);
  const auto contrast_at = [&](int across_px) -> Result<std::shared_ptr<const SeenContrast>> {
    SeenViewOptions how;
    how.run() = options.of_part();
    how.across_px = across_px;
    how.surroundings = relief.role == LightRole::background;
    std::vector<SeenView> views;
    for (const Vec3& eye_world_m : eyes) {
      auto view = see_object(around.rays, alone, eye_world_m, how);
      if (!view) view = see_object(alone, alone, eye_world_m, how);
      if (!view) return tl::unexpected(view.error());
      views.push_back(std::move(*view));
    }
    return std::make_shared<const SeenContrast>(std::move(views), wishes_of(relief));
  };
  const bool several = eyes.size() > 1;
  auto fine = contrast_at(several ? kFineOfSeveral_px : kFine_px),
       quick = contrast_at(several ? kQuickOfSeveral_px : kQuick_px);
  if (!fine) return tl::unexpected(fine.error());
  if (!quick) return tl::unexpected(quick.error());
  const Vec3 middle_world_m = object.study.surface.centroid_world_m();
  SeenObject seen{std::move(*fine), std::move(*quick), {}, {}, {}, {}, LightWindow({}, {}, {})};
  seen.fixed_lux = spread_over(*seen.fine, object, fixed_lux, options.threads);
  seen.quick_fixed_lux = spread_over(*seen.quick, object, fixed_lux, options.threads);
  auto asked = asked_of_light(relief, *seen.fine, middle_world_m, eyes[0], seen.fixed_lux),
       quick_asked = asked_of_light(relief, *seen.quick, middle_world_m, eyes[0], seen.quick_fixed_lux);
  if (!asked) return tl::unexpected(asked.error());
  seen.asked = std::move(*asked);
  if (quick_asked) {
    seen.quick_asked = std::move(*quick_asked);
  } else {
    seen.quick = seen.fine;  // too coarse to tell what is asked
    seen.quick_fixed_lux = seen.fixed_lux;
    seen.quick_asked = seen.asked;
  }
  seen.window = LightWindow(relief.set_up, relief.role, set_up_frame(*seen.fine, middle_world_m, eyes[0]));
  return seen;
}

LitPlaces lit_places(const StudiedObject& object, const ReliefSpec& relief, const SeenObject* seen, AimWishes& wishes) {
  LitPlaces places{&object.samples, &object.study.features, {}};
  if (!seen || (relief.role != LightRole::background && relief.role != LightRole::rim)) return places;
  places.own = std::make_unique<WantedPlaces>(wanted_places(*seen->fine, seen->asked.role, kAimPoints));
  places.samples = &places.own->samples;
  places.features = &places.own->features;
  // The object's own places are among the limits.
  wishes.max_object_lx = std::numeric_limits<double>::infinity();
  wishes.fixed_lux.clear();
  return places;
}

Result<std::vector<double>> reflected_lx_of(const ReliefSurroundings& around, const StudiedObject& object,
                                            std::span<const HangingHead> heads, const ComputeOptions& options) {
  std::vector<double> reflected_lx(heads.size(), 0);
  if (options.model == Model::direct) return reflected_lx;
  const std::vector<OrientedPoint>& samples = object.samples.points;
  std::vector<Receiver> receivers;
  const std::size_t places = std::min(kReflectedPlaces, samples.size());
  for (std::size_t k = 0; k < places; ++k) {
    const OrientedPoint& at = samples[k * samples.size() / places];
    receivers.push_back({at.position_world_m, at.normal});
  }
  std::vector<Emitter> lamps;
  const Vec3 middle_world_m = object.study.surface.centroid_world_m();
  for (const HangingHead& head : heads) {
    const Vec3 towards = middle_world_m - head.world_from_mount.translation_m;
    const auto joints = head.moves ? pan_tilt_towards(head.world_from_mount, towards, head.range, head.present)
                                   : std::optional(head.present);
    lamps.push_back({head.zoom.front().intensity, lamp_pose(head, joints.value_or(head.present))});
  }
  EvaluateOptions wanted;
  wanted.floor_of_mean = kReflectedError;
  ComputeOptions all = options, direct = options;
  all.watch.progress = direct.watch.progress = nullptr;
  all.max_error = direct.max_error = std::max(options.max_error, kReflectedError);
  all.worst_error = direct.worst_error = std::nullopt;
  direct.model = Model::direct;
  const auto by_all = light_of(around.rays, receivers, lamps, wanted, all),
             by_direct = light_of(around.rays, receivers, lamps, wanted, direct);
  if (!by_all) return tl::unexpected(by_all.error());
  if (!by_direct) return tl::unexpected(by_direct.error());
  for (std::size_t k = 0; k < heads.size(); ++k) {
    const Eigen::VectorXd level =
        Eigen::VectorXd::Unit(static_cast<Eigen::Index>(heads.size()), static_cast<Eigen::Index>(k));
    reflected_lx[k] = std::max(0.0, (by_all->lux(level) - by_direct->lux(level)).mean());
  }
  return reflected_lx;
}

Result<void> wish_what_is_seen(const ReliefSurroundings& around, const StudiedObject& object, const SeenObject& seen,
                               std::span<HangingHead> heads, AimWishes& wishes, const ComputeOptions& options) {
  ComputeOptions to_the_end = options;  // a stop ends the search for aims with the best so far
  to_the_end.watch = options.watch.without_stop();
  const auto reflected_lx = reflected_lx_of(around, object, heads, to_the_end);
  if (!reflected_lx) return tl::unexpected(reflected_lx.error());
  for (std::size_t k = 0; k < heads.size(); ++k) heads[k].reflected_lx = (*reflected_lx)[k];
  wishes.measure = AimMeasure::seen;
  wishes.seen = seen.fine;
  wishes.seen_quick = seen.quick;
  wishes.seen_fixed_lux = seen.fixed_lux;
  wishes.seen_quick_fixed_lux = seen.quick_fixed_lux;
  wishes.role = seen.asked.role;
  wishes.quick_role = seen.quick_asked.role;
  return {};
}

}  // namespace luxrig
