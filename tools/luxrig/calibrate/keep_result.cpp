#include "tools/luxrig/calibrate/keep_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/calibration/ageing.h"
#include "core/calibration/calibration_report.h"
#include "core/calibration/meter_run.h"
#include "core/output/dimming.h"
#include "core/tasks/rig_version.h"
#include "tools/process/files.h"
#include "tools/process/utc_time.h"
#include "tools/terminal/table.h"

namespace luxrig {
namespace {

/// The old file stays beside the new one, under the time it was made.
Result<void> keep_old(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return {};
  const auto text = read_file(file);
  const auto old =
      text ? calibration_from_json(*text, file.string()) : Checked<Calibration>(tl::unexpected(text.error()));
  std::string stamp = old ? old->made : utc_now() + "-unreadable";
  std::erase_if(stamp, [](char c) { return c == ':' || c == '/'; });
  const auto kept = file.parent_path() / fmt::format("{}-{}{}", file.stem().string(), stamp, file.extension().string());
  std::error_code error;
  std::filesystem::copy_file(file, kept, std::filesystem::copy_options::overwrite_existing, error);
  if (!error) return {};
  return tl::unexpected(Fault{Cause::system, "", kept.string() + " cannot be written: " + error.message(), {}});
}

/// 0 = the rig as found cannot be built: what is known of its points will not be used.
std::uint64_t version_as_found(const Session& stated, const Calibration& found) {
  auto rig = calibrated(stated.rig, found, "what was found");
  const auto session = rig ? session_of(std::move(*rig)) : tl::unexpected(rig.error());
  return session ? version_of(session->rig, session->scene).light : 0;
}

/// Of each camera that measured: the light of the look that the daemon went back to; of every lamp at its level of use if
/// that look is dark.
std::vector<LuxMap> maps_of(const Measuring& measuring, std::span<const double> look, const Calibration& found,
                            const ComputeOptions& compute) {
  std::vector<double> level(look.begin(), look.end());
  const bool lit = std::any_of(level.begin(), level.end(), [](double one) { return one > 0; });
  if (!lit)
    for (std::size_t f = 0; f < level.size(); ++f) level[f] = level_of_share(measuring.curves[f].of_level, kLevelOfUse);
  auto maps = lux_maps_of(measuring.session, measuring.cameras, measuring.seen, measuring.light, measuring.curves,
                          level, found, compute);
  if (!maps) {  // what was measured is still worth its report
    fmt::print(stderr, "luxrig: there is no map of the light: {}\n", maps.error().detail);
    return {};
  }
  for (LuxMap& map : *maps)
    map.light = lit ? "the look in force" : fmt::format("every lamp at {:.0f} % of its light", 100 * kLevelOfUse);
  return std::move(*maps);
}

/// calibration.json -> calibration-report.html
std::filesystem::path beside(const std::filesystem::path& file, const std::string& ending) {
  return file.parent_path() / (file.stem().string() + ending);
}

/// Of LightUnknowns' instruments, one that stands for a lamp's slope.
std::string slope_words(const LightUnknowns& known, std::size_t instrument) {
  const double slope = known.meter_gain(instrument);
  return fmt::format("1 % of level changes its light by {:.2f} ± {:.2f} %", slope,
                     known.meter_gain_standard_error(instrument));
}

void print_report(const Measuring& measuring, const GoalError& before, const CalibrationReport& told) {
  const Rig& rig = measuring.session.rig;
  const LightUnknowns& known = measuring.light.known();
  const char* note = "";
  Table lamps({"fixture", ">output", ">± se", ">moved cm", ">± se", ">turned °", ">± se", "dimmer"});
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    const Eigen::VectorXd off = known.mount(f), error = known.mount_standard_error(f);
    const MeasuredCurve& curve = measuring.curves[f].of_level;
    const bool measured = known.gain_is_measured(f);
    const bool sloped = std::find(measuring.slope_of.begin(), measuring.slope_of.end(), f) != measuring.slope_of.end();
    if (measured && known.read_at(f) < 1)
      note = "* as its light says at the level where it was read; at full light it may be another\n";
    lamps.row({rig.fixtures[f].name,
               measured ? fmt::format("{:.3f}{}", known.gain(f), known.read_at(f) < 1 ? " *" : "") : "",
               measured ? fmt::format("{:.3f}", known.gain_standard_error(f)) : "not measured",
               fmt::format("{:.1f}", 100 * off.head<3>().norm()), fmt::format("{:.1f}", 100 * error.head<3>().norm()),
               fmt::format("{:.1f}", deg_from_rad(off.tail<3>().norm())),
               fmt::format("{:.1f}", deg_from_rad(error.tail<3>().norm())),
               sloped          ? slope_words(known, *measuring.first_slope + f)
               : curve.empty() ? "not measured"
                               : fmt::format("{:.0f} % of its light at half level", 100 * share_at_level(curve, 0.5))});
  }
  for (const CalibratedFixture& fixture : told.found.fixtures)
    if (const std::string aged = ageing_words(fixture); !aged.empty())
      fmt::print("\"{}\" gives {}.\n", fixture.name, aged);
  fmt::print("{}{}\nThe light at {} goals was known to {}. Now it is known to {}.\n", lamps.text(), note, before.goals,
             known_words(before), known_words(measuring.light.error_of_goals(measuring.levels.use)));
  if (told.variance) fmt::print("What is left of its variance: {}.\n", budget_words(told.variance));
  if (told.to_settle.empty()) return;
  std::string names;
  for (const std::string& point : told.to_settle) names += (names.empty() ? "\"" : ", \"") + point + "\"";
  fmt::print("A luxmeter at {} would settle most of the rest: luxrig calibrate{} --hand.\n", names,
             rig.luxmeters.empty() ? "" : " --meters");
}

}  // namespace

Result<std::filesystem::path> keep_result(const MeasuredRig& measured, const ComputeOptions& compute) {
  const Measuring& measuring = measured.measuring;
  const Rig& rig = measuring.session.rig;
  const Calibration* const earlier = measured.earlier ? &*measured.earlier : nullptr;
  if (auto kept = keep_old(measured.file); !kept) return tl::unexpected(kept.error());
  Calibration found = calibration_of(measuring.session, measuring.light, measuring.curves, utc_now());
  found.simulated = measured.world;
  if (earlier) keep_first_outputs(*earlier, found);
  put_heads(rig, measured.heads, earlier, found);
  put_cameras(rig, measuring.cameras, measuring.seen, measuring.light, earlier, found);
  found.as_found = version_as_found(measuring.session, found);
  const std::string text = to_json(found);
  if (const auto read = calibration_from_json(text, measured.file.string()); !read)  // nobody could use it
    return tl::unexpected(Fault{
        Cause::invalid, "", "what was found is out of range, and the last one stays: " + read.error()[0].text(), {}});
  if (auto written = write_file(measured.file, text); !written) return tl::unexpected(written.error());
  CalibrationReport told = report_of(measured.with_places, measured.before, measuring.light, std::move(found),
                                     kLevelOfUse, measuring.no_points());
  told.by = measured.by;
  for (std::size_t k = 0; k < measuring.seen.each.size(); ++k)
    if (const auto& seen = measuring.seen.each[k])
      told.seen.push_back({rig.cameras[measuring.cameras.each[k].camera].name, seen->overflow});
  if (!measuring.cameras.each.empty()) {
    told.variance =
        budget_of_goals(rig, measuring.light.known(), measuring.levels.use, measuring.cameras.instruments());
    told.maps = maps_of(measuring, measured.look, told.found, compute);
  }
  const auto page = beside(measured.file, "-report.html");
  std::vector<std::pair<std::filesystem::path, std::string>> files{
      {page, to_html(told)}, {beside(measured.file, "-report.json"), to_json(told)}};
  for (std::size_t k = 0; k < told.maps.size(); ++k) {
    const std::string which = k == 0 ? "" : fmt::format("-{}", k + 1);
    files.emplace_back(beside(measured.file, "-lux" + which + ".png"), told.maps[k].lux_png);
    files.emplace_back(beside(measured.file, "-lux-error" + which + ".png"), told.maps[k].error_png);
  }
  for (const auto& [name, bytes] : files)
    if (auto written = write_file(name, bytes); !written) return tl::unexpected(written.error());
  print_report(measuring, measured.before.error_of_goals(measuring.levels.use), told);
  return page;
}

}  // namespace luxrig
