#include "core/tasks/directions_task.h"

#include <fmt/format.h>

#include <cmath>

#include "core/highlight/distant/relief_lights.h"
#include "core/highlight/lights/set_up.h"
#include "core/highlight/shadow/relief_contrast.h"
#include "core/scene/object_scene.h"

namespace luxrig {
namespace {

PlannedDirection planned_direction(const Vec3& towards, const Vec3& object_world_m, double distance_m) {
  PlannedDirection planned;
  planned.towards_world = towards;
  planned.azimuth_rad = std::atan2(towards.y(), towards.x());
  planned.elevation_rad = std::atan2(towards.z(), std::hypot(towards.x(), towards.y()));
  planned.position_world_m = object_world_m + distance_m * towards;
  return planned;
}

/// Directions of a set-up as its camera sees the object.
Result<LightWindow> window_of(const Session& session, const RayScene& object, const ReliefSpec& relief,
                              const Vec3& middle_world_m, const ComputeOptions& options) {
  if (!relief.camera) return LightWindow({}, {}, {});
  const Vec3& eye_world_m = session.rig.cameras[*relief.camera].position_world_m;
  SeenViewOptions how;
  how.run() = options.of_part();
  auto view = see_object(*session.rays, object, eye_world_m, how);
  if (!view) return tl::unexpected(view.error());
  std::vector<SeenView> views;
  views.push_back(std::move(*view));
  return LightWindow(relief.set_up, LightRole::any,
                     set_up_frame(SeenContrast(std::move(views), {}), middle_world_m, eye_world_m));
}

/// The peak of a parabola may lie beside the directions that it went through: pulls it back.
Vec3 pulled_into(const LightWindow& window, const Vec3& towards) {
  constexpr int kSteps = 64;
  const Vec3 middle = window.middle(window.side_of(towards));
  for (int k = 0; k < kSteps; ++k)
    if (const Vec3 at = (towards + (middle - towards) * k / kSteps).normalized(); window.has(at)) return at;
  return middle;
}

}  // namespace

Result<HeldLights> find_directions(const Session& session, const Task& task, const ComputeOptions& options) {
  const DirectionsSpec& spec = task.directions;
  const auto refuse = [&](const Fault& fault) { return in_words(fault, fmt::format("task \"{}\"", task.name)); };
  const auto object = study_object(session, spec.relief, options);
  if (!object) return tl::unexpected(object.error());
  const ReliefStudy& study = object->study;
  const auto others = scene_without_object(session.scene, session.rig.scene.objects[spec.relief.object].name);
  if (!others) return refuse(others.error());
  const RayScene environment(*others);
  const Vec3 middle_world_m = study.surface.centroid_world_m();

  const auto mesh = object_scene(session.scene, session.rig.scene.objects[spec.relief.object].name);
  if (!mesh) return refuse(mesh.error());
  const auto window = window_of(session, RayScene(*mesh), spec.relief, middle_world_m, options);
  if (!window) return refuse(window.error());

  const Stage stage(options.watch.without_stop(), task.name, "judging directions");
  ReliefLightOptions of_search;
  of_search.run() = options.of_part();
  of_search.lift_m = 1e-4 * study.surface.diagonal_m();
  int side = 0;  // of a set-up with a light on either
  of_search.may_light = [&](const Vec3& towards) {
    return window->has(towards) && (side == 0 || window->side_of(towards) == side) &&
           !environment.occluded(middle_world_m, Vec3::Zero(), middle_world_m + spec.distance_m * towards);
  };
  const auto search = ReliefLightSearch::make(study.surface, study.rays, study.interest, of_search);
  if (!search) return refuse(search.error());
  HeldLights found;
  ReliefLights chosen;
  if (window->lights()) {
    for (const int of_side : window->lights() == 2 ? std::vector{-1, 1} : std::vector{0}) {
      side = of_side;
      const auto of_one = ReliefLightSearch::make(study.surface, study.rays, study.interest, of_search);
      if (!of_one) return refuse(of_one.error());
      const auto one = of_one->lights(1);
      if (!one) return refuse(one.error());
      for (const Vec3& towards : one->directions) chosen.directions.push_back(pulled_into(*window, towards));
    }
    if (chosen.directions.size() < static_cast<std::size_t>(*window->lights())) chosen.directions.clear();
  } else if (spec.lights) {
    auto lights = search->lights(*spec.lights);
    if (!lights) return refuse(lights.error());
    chosen = std::move(*lights);
  } else {
    auto count = search->count_lights(spec.max_lights);
    if (!count) return refuse(count.error());
    found.exposed_by_count = std::move(count->exposed_contrast);
    if (!count->by_number.empty()) chosen = std::move(count->by_number[count->best]);
  }
  if (chosen.directions.empty())
    return refusal(fmt::format(
        "task \"{}\": {}in every direction something stands nearer than {:g} m, or no light brings out anything: lower "
        "distance_m",
        task.name, window->open() ? "" : window->words() + ", and there ", spec.distance_m));

  std::vector<DistantBeam> beams;
  for (const Vec3& towards : chosen.directions) {
    found.directions.push_back(planned_direction(towards, middle_world_m, spec.distance_m));
    beams.push_back({towards, 1});
  }
  const ReliefContrast all = relief_contrast(study.surface, study.rays, study.interest, beams, of_search.lift_m,
                                             options.threads, study.features.cluster_of_point);
  found.local_contrast_lx = all.local_contrast_lx;
  found.coverage = all.features_with_transition;
  found.exposed_contrast = search->exposed_contrast_of(chosen.directions);
  return found;
}

}  // namespace luxrig
