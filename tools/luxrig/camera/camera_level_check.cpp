// camera check --levels: the camera and the dimmer, from pictures at known levels.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/text/nearest.h"
#include "tools/luxrig/camera/camera_command.h"
#include "tools/luxrig/camera/camera_levels.h"
#include "tools/process/clock.h"
#include "tools/terminal/command.h"

namespace luxrig {
namespace {

constexpr const char* kNotTold =
    "a power that the camera has (gamma) from one that the dimmer has: exposures tell them apart";

/// The fixture by its name, or the only one.
Checked<std::size_t> fixture_of(const Rig& rig, const std::string& name) {
  const auto refuse = [&](std::string what, std::string mend) {
    return tl::unexpected(std::vector<Problem>{{rig.file.string(), 0, 0, std::move(what), std::move(mend)}});
  };
  std::vector<std::string_view> names;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    const bool wanted = rig.fixtures[f].name == name || (name.empty() && rig.fixtures.size() == 1);
    if (wanted && rig.fixtures[f].switched)
      return refuse(fmt::format("fixture \"{}\" is on or off, and has no levels to compare", rig.fixtures[f].name),
                    "name one that dims with --fixture, or take exposures instead of --levels");
    if (wanted) return f;
    names.push_back(rig.fixtures[f].name);
  }
  if (name.empty())
    return refuse(fmt::format("{} fixtures could light the scene", names.size()), "name one with --fixture");
  return refuse(fmt::format("there is no fixture \"{}\"", name),
                mend_for_unknown(name, names, "the rig has no fixture"));
}

nlohmann::json level_check_json(const LevelCheck& check) {
  nlohmann::json out = {{"good", check.good},
                        {"camera_told", check.camera_told},
                        {"camera_linear", check.camera_linear},
                        {"exponent", check.exponent},
                        {"exponent_error", check.exponent_error},
                        {"light_off_level", {{"rms", check.line_rms}, {"worst", check.line_worst}}},
                        {"light_off_power", check.power_rms},
                        {"other_light", check.other_light},
                        {"flicker", check.flicker},
                        {"not_told", kNotTold},
                        {"levels", nlohmann::json::array()},
                        {"findings", nlohmann::json::array()}};
  if (check.camera_told) out["places_off_proportion"] = {{"rms", check.camera_rms}, {"worst", check.camera_worst}};
  for (const SeenLevel& seen : check.seen)
    out["levels"].push_back({{"level", seen.level}, {"light", seen.light}, {"standard_error", seen.standard_error}});
  for (const CameraFinding& finding : check.findings)
    out["findings"].push_back({{"what", finding.what}, {"mend", finding.mend}});
  return out;
}

void print_level_check(const LevelCheck& check) {
  if (check.camera_told)
    fmt::print(
        "  camera      places {:.2f} % rms off growing in proportion, {:.2f} % at worst, whatever the dimmer does\n",
        100 * check.camera_rms, 100 * check.camera_worst);
  fmt::print(
      "  light       {:.2f} % rms off the level, {:.2f} % at worst; grows as the level to the power {:.3f} ± {:.3f}, "
      "{:.2f} % rms off that\n",
      100 * check.line_rms, 100 * check.line_worst, check.exponent, check.exponent_error, 100 * check.power_rms);
  fmt::print("  not told    {}\n", kNotTold);
  fmt::print("  other light {:.1f} % of the light at the highest level\n", 100 * check.other_light);
  fmt::print("  flicker     {:.2f} % from picture to picture\n", 100 * check.flicker);
  for (const CameraFinding& finding : check.findings) fmt::print("  {}: {}\n", finding.what, finding.mend);
}

}  // namespace

int run_camera_levels(const CameraArguments& arguments, const Rig& rig, std::size_t camera, CameraSource* source) {
  const PictureCamera& spec = rig.cameras[camera];
  LevelsWanted wanted;
  wanted.steps = arguments.steps;
  wanted.frames = arguments.frames;
  const auto curve = curve_of(spec.taking);
  if (!curve) return report(curve.error());
  const bool from_files = !arguments.sim && spec.taking.source == PictureSource::files;
  std::string lit_by = "files";
  if (!from_files) {
    const auto fixture = fixture_of(rig, arguments.fixture);
    if (!fixture) return report(fixture.error());
    wanted.fixture = *fixture;
    lit_by = fmt::format("fixture \"{}\"", rig.fixtures[wanted.fixture].name);
  }
  const auto by_daemon = [&]() -> Result<LevelSeries> {
    if (auto active = source->activate(now()); !active) return tl::unexpected(active.error());
    const auto light = make_daemon_light(rig, wanted.fixture, arguments.port, arguments.token);
    auto series = take_level_series(
        *light, [&] { return source->take_raw(now()); }, *curve, wanted, progress_line("levels"));
    source->deactivate(now());
    return series;
  };
  const auto series = from_files      ? level_series_of_files(spec, *curve)
                      : arguments.sim ? simulated_level_series(rig, arguments.rig, camera, arguments.sim_seed, wanted,
                                                               progress_line("levels"))
                                      : by_daemon();
  if (!series) return report(series.error());
  const auto check = check_by_levels(*series);
  if (!check) return report(check.error());
  if (arguments.json) {
    nlohmann::json out = level_check_json(*check);
    out["camera"] = spec.name;
    fmt::print("{}\n", out.dump(1, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    fmt::print("{}: {} levels from {:.3g} to {:.3g} by {}, and none, {} pictures of each\n", spec.name,
               series->steps.size(), series->steps.front().level, series->steps.back().level, lit_by,
               series->steps.front().frames.size());
    print_level_check(*check);
    fmt::print("{}: {}\n", spec.name,
               check->good            ? "its pictures are linear light, and the dimmer is as stated"
               : check->camera_linear ? "its pictures are linear light, or a power of it; the dimmer is not as stated, "
                                        "or the camera is that power"
               : check->camera_told   ? "its pictures are not linear light"
                                      : "whether its pictures are linear light was not told");
  }
  return check->good ? kExitOk : kExitFailed;
}

}  // namespace luxrig
