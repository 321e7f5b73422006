#include <fmt/format.h>

#include <algorithm>

#include "tools/luxrig/render/render_show.h"
#include "tools/terminal/command.h"

namespace luxrig {
namespace {

const Vec3 kLitBeam(0.80, 0.35, 0.0), kDarkBeam(0.25, 0.35, 0.55), kBeamRoom = Vec3::Constant(0.84);

struct BeamAxis {
  std::string name;
  Vec3 from_world_m, to_world_m;
  bool lit;
};

/// From each lamp along its axis to the first surface; if there is none, as far as the scene is large.
std::vector<BeamAxis> beam_axes(const ShownRig& rig, const RayScene& rays) {
  const Eigen::AlignedBox3d bounds = rays.bounds_world_m();
  const double far_m = bounds.isEmpty() ? 3 : bounds.diagonal().norm();
  std::vector<BeamAxis> axes;
  for (std::size_t f = 0; f < rig.rig.fixtures.size(); ++f) {
    const Fixture& fixture = rig.rig.fixtures[f];
    const bool lit = rig.look.levels[f] > 0;
    if (fixture.housing && *fixture.housing != f) {
      // The emitters of a housing follow its first one and share its beam.
      if (!axes.empty()) axes.back().lit = axes.back().lit || lit;
      continue;
    }
    const Pose pose = fixture.world_from_lamp(rig.look.joints[f]);
    const Vec3 axis = pose.direction(-Vec3::UnitZ());
    const auto hit = rays.nearest(pose.translation_m, axis, Vec3::Zero());
    const std::string name = fixture.housing ? fixture.name.substr(0, fixture.name.rfind('/')) : fixture.name;
    axes.push_back({name, pose.translation_m, pose.translation_m + (hit ? hit->distance_m : far_m) * axis, lit});
  }
  return axes;
}

}  // namespace

Result<Figure> beam_figure(const ShownRig& rig, const RenderOptions& options) {
  const RayScene rays(rig.scene);
  const std::vector<BeamAxis> axes = beam_axes(rig, rays);
  if (axes.empty()) return refusal("the rig has no fixtures, and so no beams: give a plan with lights, or [[fixture]]");
  std::vector<Vec3> shown;
  std::vector<Sight> wanted;
  for (const BeamAxis& axis : axes) {
    shown.push_back(axis.from_world_m);
    shown.push_back(axis.to_world_m);
    // Slightly off the surface: the foot itself lies on it.
    wanted.push_back({axis.to_world_m + 0.01 * (axis.from_world_m - axis.to_world_m)});
    wanted.push_back({axis.from_world_m});
  }
  const double fov_rad = rad_from_deg(options.vertical_fov_deg.value_or(kShowFov_deg));
  const CutAwayCamera view =
      as_asked(camera_that_sees(rays, shown, wanted, 0.8, fov_rad, options.width_px, options.height_px), options);
  if (!((view.camera.target_world_m - view.camera.eye_world_m).norm() > 0))
    return refusal("camera's target lies in its eye");
  SurfacePicture picture(view.camera, kShowSamplesPerEdge, view.near_m, Vec3f::Ones());
  const bool done = picture.draw(
      rays, [](const Hit& hit, const Vec3& towards_eye) { return shaded(kBeamRoom, hit.normal_world, towards_eye); },
      options.threads, {stop_on_signals(), progress_line("drawing")});
  if (!done) return tl::unexpected(Fault{Cause::cancelled, "", "the drawing was stopped", {}});
  Figure figure;
  bool any_dark = false, any_lit = false;
  for (const BeamAxis& axis : axes) {
    const Vec3& rgb = axis.lit ? kLitBeam : kDarkBeam;
    (axis.lit ? any_lit : any_dark) = true;
    DrawnLine line{axis.from_world_m, axis.to_world_m, 2.5, rgb.cast<float>(), 0.25, 0};
    line.lift_m = 0.02 * (axis.to_world_m - axis.from_world_m).norm();
    picture.draw(line);
    const auto place = place_in_picture(view.camera, axis.from_world_m);
    const auto foot = place_in_picture(view.camera, axis.to_world_m);
    const auto within = [&](const std::optional<PicturePlace>& p) {
      return p && p->x_px >= 0 && p->y_px >= 0 && p->x_px < options.width_px && p->y_px < options.height_px;
    };
    if (within(foot)) figure.labels.push_back({foot->x_px, foot->y_px, FigureMark::cross, rgb, ""});
    if (within(place)) figure.labels.push_back({place->x_px, place->y_px, FigureMark::dot, rgb, axis.name});
  }
  figure.picture = picture.resolved();
  figure.caption = fmt::format(
      "The middle of each beam from its lamp to what it meets{}; paler where something stands "
      "before it.",
      options.plan ? ", as the plan has them" : ", as the rig file hangs them");
  if (any_lit) figure.key.push_back({FigureMark::line, kLitBeam, "lit"});
  if (any_dark) figure.key.push_back({FigureMark::line, kDarkBeam, "dark"});
  figure.key.push_back({FigureMark::dot, Vec3::Constant(0.3), "lamp"});
  figure.key.push_back({FigureMark::cross, Vec3::Constant(0.3), "what its axis meets"});
  return figure;
}

}  // namespace luxrig
