#include "tools/luxrig/render_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "core/control/plan.h"
#include "core/photometry/light_colour.h"
#include "core/rig/rig_file.h"
#include "core/scene/scene_builder.h"
#include "core/transport/rig_transport.h"
#include "tools/luxrig/command.h"
#include "tools/luxrig/dark_picture.h"
#include "tools/luxrig/exposure.h"
#include "tools/luxrig/picture_png.h"
#include "tools/luxrig/png_canvas.h"
#include "tools/luxrig/room_view.h"

namespace luxrig {
namespace {

constexpr int kMostPasses = 4096;

/// Those of a plan, whose placed lights are hung for it; or each fixture's highest.
Checked<std::vector<double>> levels_of(const RenderOptions& options, Rig& rig) {
  if (!options.plan) {
    std::vector<double> levels;
    for (const Fixture& fixture : rig.fixtures) levels.push_back(rig.max_level(fixture));
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

/// As asked for or metered, and in words what that is.
PhotographLook look_of(const RenderOptions& options, const Picture& picture, std::span<const Emitter> emitters,
                       std::span<const double> levels, std::string& words) {
  PhotographLook look;
  const Exposure& exposure = options.exposure;
  look.white_cd_m2 = exposure.white_cd_m2.value_or(metered_white_cd_m2(picture) / std::exp2(exposure.stops));
  std::string of = "daylight (D65)";
  if (options.white_balance.cct_k) {
    look.white_rgb = rgb_of_cct(*options.white_balance.cct_k);
    of = fmt::format("{:.0f} K", *options.white_balance.cct_k);
  } else if (options.white_balance.of_lamps) {
    const LampWhite lamps = white_of_lamps(emitters, levels);
    look.white_rgb = lamps.rgb;
    if (lamps.cct_k) of = fmt::format("{:.0f} K, as the lamps", *lamps.cct_k);
  }
  words = fmt::format("white is {:.3g} cd/m2 (the same again: --exposure {:.3g}cd/m2) of {}\n", look.white_cd_m2,
                      look.white_cd_m2, of);
  return look;
}

}  // namespace

Checked<std::pair<Rig, std::vector<double>>> load_rig_for_picture(const RenderOptions& options) {
  auto rig = load_rig(options.rig);
  if (!rig) return tl::unexpected(rig.error());
  auto levels = levels_of(options, *rig);
  if (!levels) return tl::unexpected(levels.error());
  return std::pair{std::move(*rig), std::move(*levels)};
}

int run_render(const RenderOptions& options) {
  if (!is_picture_name(options.output)) {
    fmt::print(stderr, "{}:0:0: this ending is no kind of picture that is written: end its name in .png or .jpg\n",
               options.output.string());
    return kExitBadInput;
  }
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
  std::string shown;
  std::string trouble;
  if (options.false_colour) {
    trouble = write_false_colour(*picture, title, options.max_lx, options.output);
  } else {
    const PhotographLook look = look_of(options, *picture, emitters, all_levels, shown);
    trouble = write_photograph(*picture, title, look, options.output);
  }
  if (!trouble.empty()) {
    fmt::print(stderr, "{}:0:0: picture not written ({}): name a file in a folder that exists and can be written\n",
               options.output.string(), trouble);
    return 1;
  }
  fmt::print("{}: {} samples per pixel, noise {:.2g} of a pixel's lux (root mean square)\n{}", options.output.string(),
             picture->passes, picture->relative_error, shown);
  const std::string dark = why_dark(
      *picture, rays, rig, emitters, all_levels,
      options.plan ? "in " + options.plan->filename().string() : std::string("at the highest levels the rig allows"));
  if (!dark.empty()) fmt::print("{}\n", dark);
  return 0;
}

}  // namespace luxrig
