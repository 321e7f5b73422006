#include "tools/luxrig/camera/camera_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/picture/pfm.h"
#include "core/rig/rig_file.h"
#include "core/text/nearest.h"
#include "drivers/camera/camera_source.h"
#include "tools/command_line/completion.h"
#include "tools/command_line/installed.h"
#include "tools/luxrig/camera/camera_series.h"
#include "tools/luxrig/commands.h"
#include "tools/process/clock.h"
#include "tools/process/files.h"
#include "tools/terminal/command.h"

namespace luxrig {
namespace {

struct OpenCamera {
  Rig rig;
  std::size_t index = 0;
  std::unique_ptr<CameraSource> source;
  [[nodiscard]] const PictureCamera& spec() const { return rig.cameras[index]; }
};

Checked<OpenCamera> open_camera(const CameraArguments& arguments) {
  auto rig = load_rig(arguments.rig);
  if (!rig) return tl::unexpected(std::move(rig.error()));
  if (auto problems = check_cameras(*rig); !problems.empty()) return tl::unexpected(std::move(problems));
  const auto refuse = [&](std::string what, std::string mend) {
    return tl::unexpected(std::vector<Problem>{{rig->file.string(), 0, 0, std::move(what), std::move(mend)}});
  };
  std::vector<std::string_view> names;
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < rig->cameras.size(); ++i) {
    const PictureCamera& camera = rig->cameras[i];
    if (!arguments.sim && arguments.camera == camera.name && camera.taking.source == PictureSource::none)
      return refuse(fmt::format("camera \"{}\" has no source of pictures", camera.name),
                    "write source = \"v4l2\" or \"files\"");
    if (!arguments.sim && camera.taking.source == PictureSource::none) continue;
    names.push_back(camera.name);
    if (arguments.camera.empty() || arguments.camera == camera.name) found.push_back(i);
  }
  if (found.empty() && arguments.sim && names.empty())
    return refuse("there is no [[camera]] to see the scene with", "add one: rigs/REFERENCE.md");
  if (found.empty())
    return refuse(arguments.camera.empty() ? "no [[camera]] has a source of pictures"
                                           : fmt::format("there is no camera \"{}\" with a source", arguments.camera),
                  mend_for_unknown(arguments.camera, names, "write source = \"v4l2\" or \"files\" in a [[camera]]"));
  if (found.size() > 1)
    return refuse(fmt::format("{} cameras have a source of pictures", found.size()), "name one with --camera");
  OpenCamera open{std::move(*rig), found.front(), nullptr};
  if (!arguments.sim) open.source = make_camera(open.rig, open.index);
  return open;
}

/// As a file of linear light: dark noise below 0 becomes 0 there.
Picture picture_without_negatives(const TakenPicture& taken) {
  Picture picture;
  picture.width_px = taken.width_px;
  picture.height_px = taken.height_px;
  picture.luminance_cd_m2 = taken.light;
  for (Vec3f& pixel : picture.luminance_cd_m2) pixel = pixel.cwiseMax(0.0f);
  return picture;
}

std::string line_text(const LinearityFit& fit) {
  return fmt::format("{:.2f} % rms off a straight line, {:.2f} % at worst", 100 * fit.rms_residual,
                     100 * fit.worst_residual);
}

nlohmann::json linearity_json(const LinearityFit& fit) {
  return {{"rms", fit.rms_residual},
          {"worst", fit.worst_residual},
          {"dark_level", fit.dark_share},
          {"used_from", fit.used_from},
          {"used_to", fit.used_to},
          {"exposures_off", fit.step_residual},
          {"dark_level_error", fit.dark_standard_error}};
}

void print_json(const PictureCamera& camera, const CameraCheck& check) {
  nlohmann::json out = {{"camera", camera.name},
                        {"good", check.good},
                        {"linear", check.linear},
                        {"usable", check.usable},
                        {"saturation", check.saturation},
                        {"saturates", check.saturates},
                        {"flicker", check.flicker},
                        {"as_it_is", linearity_json(check.as_it_is)},
                        {"as_configured", linearity_json(check.as_configured)},
                        {"findings", nlohmann::json::array()}};
  if (check.curve)
    out["response"] = {{"like", check.shape.name},
                       {"exponent", check.shape.exponent},
                       {"off_that", check.shape.rms},
                       {"through_it", linearity_json(check.through_curve)}};
  if (check.noise)
    out["noise"] = {{"electrons_per_count", check.noise->electrons_per_count},
                    {"relative_error", check.noise->relative_error},
                    {"full_electrons", check.noise->full_electrons},
                    {"read_noise_electrons", check.noise->read_noise_electrons}};
  for (const CameraFinding& finding : check.findings)
    out["findings"].push_back({{"what", finding.what}, {"mend", finding.mend}});
  fmt::print("{}\n", out.dump(1, ' ', false, nlohmann::json::error_handler_t::replace));
}

void print_text(const CameraCheck& check, int counts) {
  const LinearityFit& line = check.as_it_is;
  if (line.used_to > 0) {
    fmt::print("  samples     {}, from {:.1f} to {:.1f} % of full scale\n", line_text(line), 100 * line.used_from,
               100 * line.used_to);
    if (check.linear)
      fmt::print("  dark level  {:.3f} ± {:.3f} % of full scale, {:.2f} counts\n", 100 * line.dark_share,
                 100 * line.dark_standard_error, line.dark_share * counts);
    fmt::print("  saturation  {}{:.1f} % of full scale\n", check.saturates ? "" : "above ", 100 * check.saturation);
  }
  if (check.curve) {
    fmt::print(
        "  response    like {}, {:.1f} % rms off that; light grows as samples to the power {:.3f}; through it {}\n",
        check.shape.name, 100 * check.shape.rms, check.shape.exponent, line_text(check.through_curve));
    fmt::print("  rig file    with the response it states {}\n", line_text(check.as_configured));
  }
  if (check.noise) {
    const PhotonTransfer& noise = *check.noise;
    fmt::print("  noise       {:.3g} electrons per count, ± {:.1f} %; full at {:.0f} electrons, read noise {:.1f}\n",
               noise.electrons_per_count, 100 * noise.relative_error, noise.full_electrons, noise.read_noise_electrons);
  } else {
    fmt::print("  noise       cannot be told: it is smaller than a count, or does not grow with light\n");
  }
  fmt::print("  flicker     {:.2f} % from picture to picture\n", 100 * check.flicker);
  for (const CameraFinding& finding : check.findings) fmt::print("  {}: {}\n", finding.what, finding.mend);
}

int run_camera_shot(const CameraArguments& arguments) {
  auto camera = open_camera(arguments);
  if (!camera) return report(camera.error());
  CameraSource& source = *camera->source;
  const Progress progress = progress_line("picture");
  if (auto active = source.activate(now()); !active) return report(active.error());
  const auto taken = source.take(now());
  source.deactivate(now());
  if (!taken) return report(taken.error());
  if (auto written = write_file(*arguments.output, to_pfm(picture_without_negatives(*taken))); !written)
    return report(written.error());
  double sum = 0, most = 0;
  for (const Vec3f& pixel : taken->light) {
    const Vec3 light = pixel.cast<double>();
    const double luminance = 0.2126 * light.x() + 0.7152 * light.y() + 0.0722 * light.z();
    sum += luminance;
    most = std::max(most, luminance);
  }
  const double mean = sum / static_cast<double>(taken->light.size());
  const char* unit = taken->calibrated ? "cd/m²" : "of full scale";
  const std::string exposure =
      taken->exposure_s > 0 ? fmt::format("exposed {:g} ms", 1000 * taken->exposure_s) : "exposure not known";
  if (arguments.json) {
    nlohmann::json out = {{"camera", camera->spec().name},
                          {"file", arguments.output->string()},
                          {"width_px", taken->width_px},
                          {"height_px", taken->height_px},
                          {"mean", mean},
                          {"largest", most},
                          {"unit", taken->calibrated ? "cd/m2" : "share of full scale"},
                          {"saturated_share", taken->saturated_share}};
    if (taken->exposure_s > 0) out["exposure_ms"] = 1000 * taken->exposure_s;
    fmt::print("{}\n", out.dump(1, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    fmt::print("{}: {} x {} pixels, {}, mean {:.4g} {}, largest {:.4g}, {:.2f} % saturated: {}\n", camera->spec().name,
               taken->width_px, taken->height_px, exposure, mean, unit, most, 100 * taken->saturated_share,
               arguments.output->string());
  }
  return kExitOk;
}

int run_camera_check(const CameraArguments& arguments) {
  auto camera = open_camera(arguments);
  if (!camera) return report(camera.error());
  if (arguments.levels || arguments.sim)
    return run_camera_levels(arguments, camera->rig, camera->index, camera->source.get());
  SeriesWanted wanted;
  if (arguments.shortest_ms) wanted.shortest_s = *arguments.shortest_ms / 1000;
  if (arguments.longest_ms) wanted.longest_s = *arguments.longest_ms / 1000;
  wanted.steps = arguments.steps;
  wanted.frames = arguments.frames;
  const auto series = camera->spec().taking.source == PictureSource::files
                          ? series_of_files(camera->spec())
                          : take_series(*camera->source, camera->spec(), wanted, progress_line("exposures"));
  if (!series) return report(series.error());
  const auto curve = curve_of(camera->spec().taking);
  if (!curve) return report(curve.error());
  const auto check = check_camera(*series, *curve);
  if (!check) return report(check.error());
  if (arguments.output) {
    if (!check->curve)
      return report(
          Fault{Cause::invalid, camera->spec().name, "no response could be measured, so none is written", {}});
    if (auto written = write_file(*arguments.output, to_csv(*check->curve)); !written) return report(written.error());
  }
  if (arguments.json) {
    print_json(camera->spec(), *check);
  } else {
    fmt::print("{}: {} exposures from {:.3g} to {:.3g} ms, {} pictures of each\n", camera->spec().name,
               series->steps.size(), 1000 * series->steps.front().exposure_s, 1000 * series->steps.back().exposure_s,
               series->steps.front().frames.size());
    print_text(*check, series->full_scale_counts);
    fmt::print("{}: {}\n", camera->spec().name,
               check->good     ? "its pictures are linear light"
               : check->usable ? "its pictures are not linear light yet, but can be"
                               : "its pictures are no measure of light");
  }
  return check->good ? kExitOk : kExitFailed;
}

Action declare_camera(CLI::App& command) {
  const auto camera = std::make_shared<CameraArguments>();
  command.require_subcommand(1);
  const auto add_shared = [&camera](CLI::App& one) {
    add_rig_option(one, camera->rig);
    one.add_option("--camera", camera->camera, "its name (else the only one with a source)");
    one.add_flag("--json", camera->json, "print JSON");
  };
  auto* shot = command.add_subcommand("shot", "take one picture, as linear light (PFM)");
  add_shared(*shot);
  shot->add_option("-o,--output", camera->output, "PFM file")->required()->check(offers_files());
  auto* check = command.add_subcommand(
      "check", "linearity, dark level, saturation and noise, from a series of exposures of a still scene");
  add_shared(*check);
  check->add_option("-o,--output", camera->output, "write the measured response here (CSV), for response_file")
      ->check(offers_files());
  check->add_option("--shortest-ms", camera->shortest_ms, "shortest exposure")->check(CLI::PositiveNumber);
  check->add_option("--longest-ms", camera->longest_ms, "longest exposure")->check(CLI::PositiveNumber);
  check->add_option("--steps", camera->steps, "exposures")->check(CLI::Range(3, 40));
  check->add_option("--frames", camera->frames, "pictures of each")->check(CLI::Range(3, 100));
  check->add_flag("--levels", camera->levels,
                  "by known dimmer levels of a fixture of the rig, which its daemon drives, instead of by exposures; "
                  "of source = \"files\": levels stand in their names (wall_40pct_1.png)");
  check->add_option("--fixture", camera->fixture, "with --levels: what lights the scene (else the only one)");
  check->add_option("--port", camera->port, "with --levels: of the daemon");
  check->add_option("--token", camera->token, "with --levels: file with the daemon's token, if it is another user's")
      ->check(offers_files());
  check->add_flag("--sim", camera->sim, "by levels, with a simulated rig and its camera");
  check->add_option("--sim-seed", camera->sim_seed, "of the simulated rig");
  return [camera, shot] { return *shot ? run_camera_shot(*camera) : run_camera_check(*camera); };
}

}  // namespace

const Command kCameraCommand{"camera", command_group::kDevices,
                             "take a picture with a rig's camera, or check that camera", declare_camera};

}  // namespace luxrig
