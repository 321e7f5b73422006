#include "tools/luxrig/render_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "core/control/plan.h"
#include "core/rig/rig_file.h"
#include "core/scene/scene_builder.h"
#include "core/transport/rig_transport.h"
#include "tools/luxrig/command.h"
#include "tools/luxrig/picture_png.h"

namespace luxrig {
namespace {

constexpr int kMostPasses = 4096;

/// Those of a plan, whose placed lights are hung for it; or each fixture's highest.
Checked<std::vector<double>> levels_of(const RenderOptions& options, Rig& rig) {
  if (!options.plan) {
    std::vector<double> levels;
    for (const Fixture& fixture : rig.fixtures) levels.push_back(std::min(fixture.max_level, rig.limits.max_level));
    return levels;
  }
  std::ifstream in(*options.plan, std::ios::binary);
  std::stringstream text;
  if (in) text << in.rdbuf();
  if (!in)
    return tl::unexpected(std::vector{Problem{options.plan->string(), 0, 0, "cannot be read", "name a plan file"}});
  const auto plan = plan_from_json(text.str(), options.plan->string());
  if (!plan) return tl::unexpected(plan.error());
  return levels_when_hung(*plan, rig, options.plan->string());
}

/// Share of `wanted_m` in the picture with nothing in front; a wish seen from nearby or behind does not count.
double seen_share(const RayScene& scene, const Camera& camera, const std::vector<Receiver>& wanted) {
  const Vec3 ahead = (camera.target_world_m - camera.eye_world_m).normalized();
  const double half_fov_rad = camera.vertical_fov_rad / 2;
  double seen = 0;
  for (const Receiver& wish : wanted) {
    const Vec3 to_m = wish.position_world_m - camera.eye_world_m;
    if (to_m.norm() < 0.3 || to_m.normalized().dot(ahead) < std::cos(1.2 * half_fov_rad)) continue;
    if (scene.occluded(wish.position_world_m, wish.normal_world, camera.eye_world_m)) continue;
    seen += wish.normal_world.dot(to_m) < 0 ? 1.0 : 0.3;  // lit side towards us
  }
  return wanted.empty() ? 0 : seen / static_cast<double>(wanted.size());
}

/// Mean, over a coarse grid of the picture, of how far one sees, bounded: a view into a near wall is none.
double openness(const RayScene& scene, const Camera& camera, double far_m) {
  double sum = 0;
  for (int j = 0; j < 6; ++j)
    for (int i = 0; i < 8; ++i) {
      const auto hit = scene.nearest(
          camera.eye_world_m, ray_direction(camera, (i + 0.5) * camera.width_px / 8, (j + 0.5) * camera.height_px / 6),
          Vec3::Zero());
      if (hit) sum += std::min(hit->distance_m / far_m, 1.0) / 48;
    }
  return sum;
}

}  // namespace

Camera automatic_camera(const RayScene& scene, const Rig& rig, int width_px, int height_px, double vertical_fov_rad) {
  std::vector<Receiver> wanted;
  for (const Point& point : rig.points) wanted.push_back({point.position_world_m, point.normal_world});
  if (wanted.empty())
    for (const Emitter& emitter : emitters_of(rig))
      wanted.push_back({emitter.world_from_lamp.translation_m, Vec3::Zero()});
  Eigen::AlignedBox3d room = scene.bounds_world_m();
  for (const Receiver& wish : wanted) room.extend(wish.position_world_m);
  if (room.isEmpty()) room = Eigen::AlignedBox3d(Vec3::Constant(-1), Vec3::Constant(1));
  Vec3 centre_m = room.center();
  if (!wanted.empty()) {
    centre_m.setZero();
    for (const Receiver& wish : wanted) centre_m += wish.position_world_m / static_cast<double>(wanted.size());
  }
  const double far_m = std::max(room.diagonal().norm() / 2, 1e-6);
  Camera best;
  double best_score = -1;
  for (const double high : {0.55, 0.75})
    for (const double out : {0.35, 0.45})
      for (int side = 0; side < 8; ++side) {
        const double angle_rad = kPi / 4 * side;
        // On the rim of the room's rectangle, seen from its middle.
        const Vec3 rim(std::clamp(1.5 * std::cos(angle_rad), -1.0, 1.0),
                       std::clamp(1.5 * std::sin(angle_rad), -1.0, 1.0), 0);
        Camera camera;
        camera.eye_world_m = room.center() + out * rim.cwiseProduct(room.sizes());
        camera.eye_world_m.z() = room.min().z() + high * room.sizes().z();
        camera.target_world_m = centre_m;
        camera.vertical_fov_rad = vertical_fov_rad;
        camera.width_px = width_px;
        camera.height_px = height_px;
        if ((camera.target_world_m - camera.eye_world_m).norm() < 1e-6 * far_m) continue;
        const double score = seen_share(scene, camera, wanted) + 0.5 * openness(scene, camera, far_m);
        if (score > best_score) {
          best_score = score;
          best = camera;
        }
      }
  return best;
}

Checked<std::pair<Rig, std::vector<double>>> load_rig_for_picture(const RenderOptions& options) {
  auto rig = load_rig(options.rig);
  if (!rig) return tl::unexpected(rig.error());
  auto levels = levels_of(options, *rig);
  if (!levels) return tl::unexpected(levels.error());
  return std::pair{std::move(*rig), std::move(*levels)};
}

int run_render(const RenderOptions& options) {
  if (options.show) return run_show(options);
  const auto loaded = load_rig_for_picture(options);
  if (!loaded) return report(loaded.error());
  const auto& [rig, levels] = *loaded;
  const auto scene = build_scene(rig);
  if (!scene) return report(scene.error());
  const RayScene rays(*scene);
  const std::vector<Emitter> emitters = all_emitters_of(rig);
  std::vector<double> all_levels = levels;
  all_levels.resize(emitters.size(), 1.0);  // daylight

  Camera camera = automatic_camera(rays, rig, options.width_px, options.height_px,
                                   rad_from_deg(options.vertical_fov_deg.value_or(60)));
  if (options.eye_world_m) camera.eye_world_m = *options.eye_world_m;
  if (options.target_world_m) camera.target_world_m = *options.target_world_m;
  PictureOptions how;
  how.threads = options.threads;
  how.wanted_relative_error = options.max_error;
  how.watch.stop = stop_on_signals();
  how.most_passes = options.passes.value_or(kMostPasses);
  const Progress progress = progress_line("rendering");
  const auto start = std::chrono::steady_clock::now();
  how.after_pass = [&](double done, double) {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double by_time = options.passes ? 0 : seconds / options.seconds;
    progress(std::min(1.0, std::max(done, by_time)));
    return by_time < 1;
  };
  const auto picture = render_picture(rays, emitters, all_levels, camera, how);
  if (!picture) {
    fmt::print(stderr, "luxrig render: {}\n", picture.error().detail);
    return 2;
  }
  const std::string title = fmt::format("{}{}", rig.name, options.plan ? "" : " (all at full)");
  const std::string trouble = options.false_colour
                                  ? write_false_colour(*picture, title, options.max_lx, options.output_png)
                                  : write_photograph(*picture, title, options.grey_cd_m2, options.output_png);
  if (!trouble.empty()) {
    fmt::print(stderr, "{}:0:0: picture not written ({}): name a file in a folder that exists and can be written\n",
               options.output_png.string(), trouble);
    return 1;
  }
  fmt::print("{}: {} samples per pixel, noise {:.2g} of a pixel's lux (root mean square)\n",
             options.output_png.string(), picture->passes, picture->relative_error);
  return 0;
}

}  // namespace luxrig
