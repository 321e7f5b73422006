#include "core/tasks/directions_task.h"

#include <fmt/format.h>

#include <cmath>

#include "core/highlight/distant/relief_lights.h"
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

  const Stage stage(options.watch.without_stop(), task.name, "judging directions");
  ReliefLightOptions of_search;
  of_search.run() = options.of_part();
  of_search.lift_m = 1e-4 * study.surface.diagonal_m();
  of_search.may_light = [&](const Vec3& towards) {
    return !environment.occluded(middle_world_m, Vec3::Zero(), middle_world_m + spec.distance_m * towards);
  };
  const auto search = ReliefLightSearch::make(study.surface, study.rays, study.interest, of_search);
  if (!search) return refuse(search.error());
  HeldLights found;
  ReliefLights chosen;
  if (spec.lights) {
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
        "task \"{}\": in every direction something stands nearer than {:g} m, or no light brings out anything: lower "
        "distance_m",
        task.name, spec.distance_m));

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
