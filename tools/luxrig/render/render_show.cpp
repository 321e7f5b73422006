#include "tools/luxrig/render/render_show.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include "core/scene/object_scene.h"
#include "core/tasks/scene_builder.h"
#include "core/text/nearest.h"
#include "tools/terminal/command.h"

namespace luxrig {
namespace {

/// From this many triangles on, a line reports that their curvature is being computed: it may take over two seconds.
constexpr std::size_t kManyTriangles = 50'000;

/// From the middle of an object to where its viewer stands: the side of the measurement points around it, else of the
/// lamps. Never from below or from straight above.
Vec3 side_of_interest(const Rig& rig, const Vec3& middle_world_m, double diagonal_m) {
  Vec3 sum = Vec3::Zero();
  for (const Point& point : rig.points) {
    const Vec3 way_m = point.position_world_m - middle_world_m;
    if (way_m.norm() < 1.5 * diagonal_m && way_m.norm() > 0) sum += way_m.normalized() + point.normal_world;
  }
  if (std::hypot(sum.x(), sum.y()) < 1e-3) {
    for (const Fixture& fixture : rig.fixtures) {
      const Vec3 way_m = fixture.world_from_lamp().translation_m - middle_world_m;
      if (way_m.norm() > 0) sum += way_m.normalized();
    }
  }
  Vec3 level(sum.x(), sum.y(), 0);
  if (level.norm() < 1e-3) level = -Vec3::UnitY();
  return (level.normalized() + std::tan(rad_from_deg(12)) * Vec3::UnitZ()).normalized();
}

Checked<ShownRig> open_shown_rig(const RenderOptions& options) {
  auto rig = load_rig_for_picture(options);
  if (!rig) return tl::unexpected(rig.error());
  auto scene = build_scene(rig->rig);
  if (!scene) return tl::unexpected(scene.error());
  return ShownRig{std::move(rig->rig), std::move(*scene), std::move(rig->look)};
}

Result<ShownObject> open_shown_object(const ShownRig& rig, const RenderOptions& options) {
  const auto name = object_to_show(rig.rig, options.object);
  if (!name) return tl::unexpected(name.error());
  auto target = object_scene(rig.scene, *name);
  auto rest = scene_without_object(rig.scene, *name);
  if (!target) return tl::unexpected(target.error());
  if (!rest) return tl::unexpected(rest.error());
  if (target->triangles.size() >= kManyTriangles)
    fmt::print(stderr, "relief of {} ({} triangles) ...\n", *name, target->triangles.size());
  ReliefStudyOptions how;
  how.threads = options.threads;
  how.watch.stop = stop_on_signals();
  auto study = study_relief(*target, how);
  if (!study) {
    Fault fault = study.error();
    fault.detail = fmt::format("{}: {}", *name, fault.detail);
    return tl::unexpected(fault);
  }
  const Vec3 viewer = side_of_interest(rig.rig, study->surface.centroid_world_m(), study->surface.diagonal_m());
  return ShownObject{*name, std::move(*target), std::move(*rest), std::move(*study), viewer};
}

Result<Figure> figure_of(const ShownRig& rig, const RenderOptions& options) {
  if (*options.show == ShowWhat::beams) {
    auto figure = beam_figure(rig, options);
    if (figure) figure->title = fmt::format("{}: where the beams go", rig.rig.name);
    return figure;
  }
  const auto object = open_shown_object(rig, options);
  if (!object) return tl::unexpected(object.error());
  const auto drawn = [&]() -> Result<Figure> {
    switch (*options.show) {
      case ShowWhat::curvature:
        return curvature_figure(*object, options);
      case ShowWhat::interest:
        return interest_figure(*object, options);
      case ShowWhat::features:
        return feature_figure(*object, options);
      case ShowWhat::histogram:
        return histogram_figure(rig, *object, options);
      case ShowWhat::domain:
      case ShowWhat::beams:
        return domain_figure(rig, *object, options);
    }
    return refusal("nothing to show");
  };
  constexpr const char* kSubjects[] = {"how its surface bends", "its recessed places", "its features",
                                       "directions from which its relief casts shadows",
                                       "where lights would bring out its relief"};
  auto figure = drawn();
  if (figure)
    figure->title =
        fmt::format("{}, {}: {}", rig.rig.name, object->name, kSubjects[static_cast<std::size_t>(*options.show)]);
  return figure;
}

}  // namespace

Result<std::string> object_to_show(const Rig& rig, const std::optional<std::string>& wanted) {
  std::vector<std::string_view> all, meshes;
  for (const SceneObject& object : rig.scene.objects) {
    all.push_back(object.name);
    if (object.mesh) meshes.push_back(object.name);
  }
  if (wanted) {
    for (const std::string_view name : all)
      if (name == *wanted) return *wanted;
    return refusal(fmt::format(
        "there is no object \"{}\": {}", *wanted,
        mend_for_unknown(*wanted, meshes.empty() ? all : meshes, "add one to the rig file with [[scene.object]]")));
  }
  if (meshes.size() == 1) return std::string(meshes.front());
  if (meshes.empty())
    return refusal("the rig has no object from a mesh file whose relief could be shown: add one with [[scene.object]]");
  return refusal(fmt::format("which object? --object takes one of: {}", fmt::join(meshes, ", ")));
}

CutAwayCamera as_asked(CutAwayCamera chosen, const RenderOptions& options) {
  if (options.eye_world_m) {
    chosen.camera.eye_world_m = *options.eye_world_m;
    chosen.near_m = 0;
  }
  if (options.target_world_m) chosen.camera.target_world_m = *options.target_world_m;
  return chosen;
}

Vec3f shaded(const Vec3& rgb, const Vec3& normal, const Vec3& towards_eye) {
  return ((0.55 + 0.45 * std::abs(normal.dot(towards_eye))) * rgb).cast<float>();
}

Result<ShadowEdges> shown_shadow_edges(const ShownObject& object, const RenderOptions& options) {
  ShadowEdgeOptions how;
  how.threads = options.threads;
  how.watch = {stop_on_signals(), progress_line("shadow edges")};
  return find_shadow_edges(object.study.rays, object.study.points, how);
}

std::string relief_words(const ReliefStudy& study) {
  return fmt::format("Curvature at a scale of {:.3g} mm; {} interest points.", 1e3 * study.scale_m,
                     study.interest.size());
}

int run_show(const RenderOptions& options) {
  const auto rig = open_shown_rig(options);
  if (!rig) return report(rig.error());
  const auto figure = figure_of(*rig, options);
  if (!figure) {
    fmt::print(stderr, "luxrig render: {}\n", figure.error().detail);
    return figure.error().cause == Cause::cancelled ? kExitFailed : kExitBadInput;
  }
  const std::string trouble = write_figure(*figure, options.output);
  if (!trouble.empty()) {
    fmt::print(stderr, "{}:0:0: picture not written ({}): name a file in a folder that exists and can be written\n",
               options.output.string(), trouble);
    return kExitFailed;
  }
  fmt::print("{}: {}\n", options.output.string(), figure->title);
  return kExitOk;
}

}  // namespace luxrig
