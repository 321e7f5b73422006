#include "tools/luxrig/render/render_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>

#include "core/photometry/light_colour.h"
#include "core/picture/rig_camera.h"
#include "core/plan/plan.h"
#include "core/rig/rig_file.h"
#include "core/tasks/rig_transport.h"
#include "core/tasks/scene_builder.h"
#include "core/text/nearest.h"
#include "tools/command_line/choice.h"
#include "tools/command_line/completion.h"
#include "tools/command_line/installed.h"
#include "tools/luxrig/commands.h"
#include "tools/luxrig/open_session.h"
#include "tools/luxrig/render/dark_picture.h"
#include "tools/luxrig/render/render_compare.h"
#include "tools/luxrig/room_view.h"
#include "tools/terminal/command.h"
#include "tools/terminal/exposure.h"
#include "tools/terminal/picture_png.h"
#include "tools/terminal/png_canvas.h"

namespace luxrig {
namespace {

constexpr int kMaxPasses = 4096;

/// That of a plan, after its placed lights are hung; or each fixture at its highest level.
Checked<HungPlan> look_to_render(const RenderOptions& options, const Rig& rig) {
  if (!options.plan) {
    HungPlan highest{rig, hung_look(rig)};
    for (const Fixture& fixture : rig.fixtures) highest.look.levels.push_back(rig.max_level(fixture));
    return highest;
  }
  std::ifstream in(*options.plan, std::ios::binary);
  std::stringstream text;
  if (in) text << in.rdbuf();
  if (!in)
    return tl::unexpected(std::vector{Problem{options.plan->string(), 0, 0, "cannot be read", "name a plan file"}});
  const auto plan = plan_from_json(text.str(), options.plan->string());
  if (!plan) return tl::unexpected(plan.error());
  return hang_plan(*plan, rig, options.plan->string());
}

}  // namespace

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

Result<Picture> picture_in_time(const RayScene& rays, const std::vector<Emitter>& emitters,
                                const std::vector<double>& levels, const Camera& camera, const RenderOptions& options,
                                const PartOfPictures& part) {
  PictureOptions how;
  how.threads = options.threads;
  how.wanted_relative_error = options.max_error;
  how.watch.stop = part.stop;
  how.max_passes = options.passes.value_or(kMaxPasses);
  const auto start = std::chrono::steady_clock::now();
  how.after_pass = [&](double done, double) {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double by_time = options.passes ? 0 : seconds * part.of / options.seconds;
    part.progress((part.number + std::min(1.0, std::max(done, by_time))) / part.of);
    return by_time < 1;
  };
  return render_picture(rays, emitters, levels, camera, how);
}

Checked<HungPlan> load_rig_for_picture(const RenderOptions& options) {
  auto rig = load_rig(options.rig);
  if (rig) rig = with_calibration(std::move(*rig));
  if (!rig) return tl::unexpected(rig.error());
  tell_calibration(*rig);
  return look_to_render(options, *rig);
}

Result<std::optional<Camera>> camera_named(const Rig& rig, const RenderOptions& options) {
  if (!options.camera) return std::optional<Camera>();
  std::vector<std::string_view> names;
  for (const PictureCamera& camera : rig.cameras) {
    names.push_back(camera.name);
    if (camera.name != *options.camera) continue;
    Camera view = view_of(camera);
    if (options.sized) {
      view.width_px = options.width_px;
      view.height_px = options.height_px;
    }
    return std::optional(view);
  }
  return refusal(fmt::format("the rig has no camera \"{}\": {}", *options.camera,
                             mend_for_unknown(*options.camera, names, "add a [[camera]] of that name")));
}

namespace {

int run_render(const RenderOptions& options) {
  if (!is_picture_name(options.output)) {
    fmt::print(stderr, "{}:0:0: this ending is no kind of picture that is written: end its name in .png or .jpg\n",
               options.output.string());
    return kExitBadInput;
  }
  if (options.show) return run_show(options);
  if (options.compare) return run_compare(options);
  const auto loaded = load_rig_for_picture(options);
  if (!loaded) return report(loaded.error());
  const Rig& rig = loaded->rig;
  const auto scene = build_scene(rig);
  if (!scene) return report(scene.error());
  const RayScene rays(*scene);
  const std::vector<Emitter> emitters = all_emitters_of(rig, loaded->look.joints);
  std::vector<double> all_levels = loaded->look.levels;
  all_levels.resize(emitters.size(), 1.0);  // daylight

  const auto of_rig = camera_named(rig, options);
  if (!of_rig) {
    fmt::print(stderr, "luxrig render: {}\n", of_rig.error().detail);
    return kExitBadInput;
  }
  Camera camera = *of_rig ? **of_rig
                          : automatic_camera(rays, rig, loaded->look.joints, options.width_px, options.height_px,
                                             rad_from_deg(options.vertical_fov_deg.value_or(60)));
  if (options.eye_world_m) camera.eye_world_m = *options.eye_world_m;
  if (options.target_world_m) camera.target_world_m = *options.target_world_m;
  const auto picture = picture_in_time(rays, emitters, all_levels, camera, options,
                                       {progress_line("rendering"), stop_on_signals(), 0, 1});
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

/// The command line as typed, before it is parsed.
struct RenderLine {
  RenderOptions options;
  std::filesystem::path plan;
  std::vector<double> eye_m, target_m;
  std::string false_colour, exposure, white_balance;
};

void add_how_it_looks(CLI::App& command, RenderLine& line, CLI::Option* with_false_colour) {
  command
      .add_option("--exposure", line.exposure,
                  "stops brighter (+1) or darker (-1) than metered, or the luminance shown white: 300cd/m2")
      ->check(CLI::Validator(
          [](std::string& text) {
            return exposure_of(text) ? "" : "write stops from -20 to 20 (+1), or a luminance (300cd/m2)";
          },
          ""))
      ->excludes(with_false_colour);
  command
      .add_option("--white-balance", line.white_balance,
                  "what is shown neutral: light as of the lamps in use (lamps, the default), daylight, or a colour "
                  "temperature (2700K)")
      ->check(CLI::Validator(
          [](std::string& text) {
            return white_balance_of(text) ? "" : "write lamps, daylight, or 1667 to 25000 with or without K";
          },
          ""))
      ->excludes(with_false_colour);
}

Action declare_render(CLI::App& command) {
  const auto line = std::make_shared<RenderLine>();
  RenderOptions& render = line->options;
  add_rig_option(command, render.rig);
  auto* with_plan =
      command.add_option("PLAN", line->plan, "levels of this plan (else every fixture at its highest level)")
          ->check(offers_files());
  command.add_option("-o,--output", render.output, "picture to write: .png or .jpg")->required()->check(offers_files());
  auto* with_false_colour =
      command.add_option("--false-colour", line->false_colour, "lux: a map of illuminance with a scale")
          ->check(one_of({"lux"}));
  auto* with_show =
      add_choice<std::optional<ShowWhat>, ShowWhat>(
          command, "--show", render.show,
          "why: an object's curvature, its interest points, its features, the histogram of shadow directions, the "
          "domain where lights may hang; or where the beams go",
          {{"curvature", ShowWhat::curvature},
           {"interest", ShowWhat::interest},
           {"features", ShowWhat::features},
           {"histogram", ShowWhat::histogram},
           {"domain", ShowWhat::domain},
           {"beams", ShowWhat::beams}})
          ->excludes(with_false_colour);
  auto* with_compare =
      command
          .add_flag("--compare", render.compare,
                    "an object in three lights side by side: as it hangs, as planned, one key light from 45°")
          ->needs(with_plan)
          ->excludes(with_show)
          ->excludes(with_false_colour);
  auto* with_object = command.add_option("--object", render.object,
                                         "with --show or --compare: which object (else the only one from a mesh file)");
  command.add_option("--lights", render.lights, "with --show histogram: so many directions are chosen")
      ->check(CLI::Range(1, 64))
      ->needs(with_show);
  auto* with_width = command.add_option("--width", render.width_px, "pixels")->check(CLI::Range(16, 8192));
  auto* with_height = command.add_option("--height", render.height_px, "pixels")->check(CLI::Range(16, 8192));
  auto* with_eye = command.add_option("--eye", line->eye_m, "x y z [m] of the viewer")->expected(3);
  auto* with_target = command.add_option("--target", line->target_m, "x y z [m] looked at")->expected(3);
  auto* with_fov =
      command.add_option("--fov-deg", render.vertical_fov_deg, "vertical field of view (60; with --show 30)")
          ->check(CLI::Range(1.0, 170.0));
  command
      .add_option("--camera", render.camera,
                  "as this [[camera]] of the rig sees it, as large as its picture unless width and height are given")
      ->excludes(with_show)
      ->excludes(with_compare)
      ->excludes(with_eye)
      ->excludes(with_target)
      ->excludes(with_fov);
  add_how_it_looks(command, *line, with_false_colour);
  command.add_option("--max-lx", render.max_lx, "top of the false-colour scale")->check(CLI::PositiveNumber);
  command.add_option("--max-error", render.max_error, "noise at which the picture is done")
      ->check(CLI::Range(1e-4, 1.0));
  command.add_option("--seconds", render.seconds, "or after this time")->check(CLI::PositiveNumber);
  command.add_option("--passes", render.passes, "or after so many samples per pixel, whatever the time")
      ->check(CLI::Range(1, 65536));
  command.add_option("--threads", render.threads, "threads (0: one per core)")->check(CLI::Range(0, 1024));
  command.footer(
      "As a photograph, as a false-colour map of lux, or with --show as a drawing of\n"
      "why its lights are where they are.");
  return [line, with_plan, with_eye, with_target, with_object, with_show, with_compare, with_width, with_height] {
    if (*with_object && !*with_show && !*with_compare) {
      fmt::print(stderr, "luxrig render: --object requires --show or --compare\n");
      return kExitBadInput;
    }
    RenderOptions options = line->options;
    const auto& eye = line->eye_m;
    const auto& target = line->target_m;
    options.sized = *with_width || *with_height;
    if (*with_plan) options.plan = line->plan;
    if (*with_eye) options.eye_world_m = Vec3(eye[0], eye[1], eye[2]);
    if (*with_target) options.target_world_m = Vec3(target[0], target[1], target[2]);
    options.false_colour = !line->false_colour.empty();
    if (!line->exposure.empty()) options.exposure = *exposure_of(line->exposure);
    if (!line->white_balance.empty()) options.white_balance = *white_balance_of(line->white_balance);
    return run_render(options);
  };
}

}  // namespace

const Command kRenderCommand{"render", command_group::kSet,
                             "a picture of the lit rig, or of its lux, or of why it is lit so", declare_render};

}  // namespace luxrig
