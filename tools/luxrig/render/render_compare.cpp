#include "tools/luxrig/render/render_compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/highlight/picture/object_view.h"
#include "core/picture/rig_camera.h"
#include "core/scene/object_scene.h"
#include "core/tasks/rig_transport.h"
#include "core/tasks/scene_builder.h"
#include "tools/luxrig/render/render_show.h"
#include "tools/terminal/command.h"
#include "tools/terminal/picture_png.h"

namespace luxrig {
namespace {

constexpr double kObjectFill = 0.9;
constexpr std::size_t kPlacesSeen = 2000;
constexpr double kKey_rad = rad_from_deg(45);

/// What is lit, and how.
struct Lit {
  const char* title;
  HungPlan hung;
};

struct Shown {
  RayScene rays, object;
  std::vector<Vec3> places_world_m;  ///< on the object
  Vec3 middle_world_m;
};

Result<Shown> shown_object(const Rig& rig, const RenderOptions& options) {
  const auto name = object_to_show(rig, options.object);
  if (!name) return tl::unexpected(name.error());
  auto scene = build_scene(rig);
  if (!scene) return refusal(scene.error().front().text());
  const auto object = object_scene(*scene, *name);
  if (!object) return tl::unexpected(object.error());
  RayScene rays(*scene), alone(*object);
  std::vector<Vec3> places;
  const std::size_t step = std::max<std::size_t>(1, object->vertices_m.size() / kPlacesSeen);
  for (std::size_t v = 0; v < object->vertices_m.size(); v += step)
    places.push_back(object->origin_world_m + object->vertices_m[v].cast<double>());
  if (places.empty()) return refusal(fmt::format("object {} has no surface", *name));
  const Vec3 middle = alone.bounds_world_m().center();
  return Shown{std::move(rays), std::move(alone), std::move(places), middle};
}

bool sees(const Shown& shown, const Vec3& eye_world_m) {
  const auto hit = shown.rays.nearest(eye_world_m, (shown.middle_world_m - eye_world_m).normalized(), Vec3::Zero());
  const auto own = shown.object.nearest(eye_world_m, (shown.middle_world_m - eye_world_m).normalized(), Vec3::Zero());
  return hit && own && own->distance_m < hit->distance_m * (1 + 1e-6) + 1e-6;
}

/// As asked for; else from the first camera of the rig that sees it; else from where most of it is in sight.
Camera camera_of(const Rig& rig, const Shown& shown, const RenderOptions& options) {
  const double fov_rad = rad_from_deg(options.vertical_fov_deg.value_or(kShowFov_deg));
  std::optional<Vec3> eye = options.eye_world_m;
  for (const PictureCamera& camera : rig.cameras)
    if (!eye && sees(shown, camera.position_world_m)) eye = camera.position_world_m;
  const int width_px = options.width_px / 3;
  if (!eye) {
    std::vector<Sight> wanted;
    for (const Vec3& place : shown.places_world_m) wanted.push_back({place});
    return camera_that_sees(shown.rays, shown.places_world_m, wanted, kObjectFill, fov_rad, width_px, options.height_px)
        .camera;
  }
  // What fills the picture from there.
  Camera camera =
      camera_that_shows(shown.places_world_m, *eye - shown.middle_world_m, kObjectFill, fov_rad, width_px, options.height_px);
  const double as_far = (camera.eye_world_m - shown.middle_world_m).norm() / (*eye - shown.middle_world_m).norm();
  camera.vertical_fov_rad = 2 * std::atan(std::tan(0.5 * fov_rad) * as_far);
  camera.eye_world_m = *eye;
  if (options.target_world_m) camera.target_world_m = *options.target_world_m;
  return camera;
}

/// The brightest lamp of a plan, alone, from 45° beside the viewer and 45° up, as far from the object as the lit lamps
/// are, or as walls allow.
std::optional<HungPlan> key_light(const HungPlan& plan, const Shown& shown, const Camera& camera) {
  double far_m = 0, most_lm = 0;
  int lit = 0;
  std::optional<std::size_t> luminaire;
  for (std::size_t f = 0; f < plan.rig.fixtures.size(); ++f) {
    const double lumens = plan.look.levels[f] * plan.rig.luminaires[plan.rig.fixtures[f].luminaire].lumens;
    if (!(lumens > 0)) continue;
    far_m += (plan.rig.fixtures[f].world_from_mount.translation_m - shown.middle_world_m).norm();
    ++lit;
    if (lumens <= most_lm) continue;
    most_lm = lumens;
    luminaire = plan.rig.fixtures[f].luminaire;
  }
  if (!luminaire) return std::nullopt;
  far_m /= lit;
  const Vec3 to_viewer = camera.eye_world_m - shown.middle_world_m;
  const double azimuth_rad = std::atan2(to_viewer.y(), to_viewer.x()) + kKey_rad;
  const Vec3 towards(std::cos(kKey_rad) * std::cos(azimuth_rad), std::cos(kKey_rad) * std::sin(azimuth_rad),
                     std::sin(kKey_rad));
  const double out_m = 0.5 * shown.object.bounds_world_m().diagonal().norm();
  if (const auto wall = shown.rays.nearest(shown.middle_world_m + out_m * towards, towards, Vec3::Zero()))
    far_m = std::min(far_m, out_m + 0.95 * wall->distance_m);
  HungPlan key = plan;
  key.rig.fixtures.push_back(
      hung_light(key.rig, "key", *luminaire, shown.middle_world_m + far_m * towards, shown.middle_world_m));
  key.look.levels.assign(key.rig.fixtures.size(), 0.0);
  key.look.levels.back() = 1;
  key.look.joints = hung_look(key.rig).joints;
  return key;
}

/// Only what the picture shows of the object, to meter on.
Picture of_object(const Picture& picture, const Shown& shown, const Camera& camera) {
  Picture alone = picture;
  for (int y = 0; y < picture.height_px; ++y)
    for (int x = 0; x < picture.width_px; ++x) {
      const Vec3 direction = ray_direction(camera, x + 0.5, y + 0.5);
      const auto own = shown.object.nearest(camera.eye_world_m, direction, Vec3::Zero());
      const auto hit = own ? shown.rays.nearest(camera.eye_world_m, direction, Vec3::Zero()) : std::nullopt;
      if (hit && own->distance_m < hit->distance_m * (1 + 1e-6) + 1e-6) continue;
      const auto pixel = static_cast<std::size_t>(y * picture.width_px + x);
      alone.luminance_cd_m2[pixel].setZero();
      alone.illuminance_lx[pixel] = -1;
    }
  return alone;
}

}  // namespace

int run_compare(const RenderOptions& options) {
  RenderOptions as_hung = options;
  as_hung.plan.reset();
  auto before = load_rig_for_picture(as_hung);
  if (!before) return report(before.error());
  auto after = load_rig_for_picture(options);
  if (!after) return report(after.error());
  const auto refuse = [](const Fault& fault) {
    fmt::print(stderr, "luxrig render: {}\n", fault.detail);
    return kExitBadInput;
  };
  const auto shown = shown_object(after->rig, options);
  if (!shown) return refuse(shown.error());
  const Camera camera = camera_of(after->rig, *shown, options);
  auto key = key_light(*after, *shown, camera);
  if (!key) return refuse(Fault{Cause::invalid, "", "the plan lights nothing, so there is nothing to compare", {}});
  std::vector<Lit> all;
  all.push_back({"before: as it hangs, all at full", std::move(*before)});
  all.push_back({"after: as planned", std::move(*after)});
  all.push_back({"one key light, 45° beside and up", std::move(*key)});

  const Progress progress = progress_line("rendering");
  const auto stop = stop_on_signals();
  std::vector<Picture> pictures;
  std::vector<Photograph> photographs;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Rig& rig = all[k].hung.rig;
    const std::vector<Emitter> emitters = all_emitters_of(rig, all[k].hung.look.joints);
    std::vector<double> levels = all[k].hung.look.levels;
    levels.resize(emitters.size(), 1.0);  // daylight
    auto picture = picture_in_time(shown->rays, emitters, levels, camera, options,
                                   {progress, stop, static_cast<int>(k), static_cast<int>(all.size())});
    if (!picture) return refuse(picture.error());
    std::string words;
    const PhotographLook look = look_of(options, of_object(*picture, *shown, camera), emitters, levels, words);
    fmt::print("{}: noise {:.2g} of a pixel's lux; {}", all[k].title, picture->relative_error, words);
    pictures.push_back(std::move(*picture));
    photographs.push_back({nullptr, all[k].title, look});
  }
  for (std::size_t k = 0; k < pictures.size(); ++k) photographs[k].picture = &pictures[k];
  if (const std::string trouble = write_photographs(photographs, options.output); !trouble.empty()) {
    fmt::print(stderr, "{}:0:0: picture not written ({}): name a file in a folder that exists and can be written\n",
               options.output.string(), trouble);
    return kExitFailed;
  }
  fmt::print("{}\n", options.output.string());
  return kExitOk;
}

}  // namespace luxrig
