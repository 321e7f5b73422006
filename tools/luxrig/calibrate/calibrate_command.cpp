// calibrate: what the rig file says wrongly, measured by the luxmeters, while the daemon runs.
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <memory>

#include "core/calibration/meter_run.h"
#include "core/calibration/rig_light.h"
#include "core/output/dimming.h"
#include "tools/command_line/installed.h"
#include "tools/luxrig/calibrate/daemon_rig.h"
#include "tools/luxrig/commands.h"
#include "tools/luxrig/compute_arguments.h"
#include "tools/luxrig/open_session.h"
#include "tools/process/files.h"
#include "tools/terminal/command.h"
#include "tools/terminal/table.h"
#include "tools/terminal/terminal_watch.h"

namespace luxrig {
namespace {

struct CalibrateArguments {
  std::filesystem::path rig;
  ClientArguments client;
  ComputeOptions compute;
  std::optional<std::filesystem::path> file;  ///< none = calibration.json beside the rig file
};

std::string utc_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now));
}

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

/// Expected error of the goals' light, as the standard error over the light: root mean square and worst.
struct GoalError {
  double rms = 0, worst = 0;
  std::size_t goals = 0;
};
GoalError error_of_goals(const Rig& rig, const LightUnknowns& known) {
  GoalError error;
  const Eigen::VectorXd level = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(rig.fixtures.size()), 0.4);
  for (std::size_t p = 0; p < rig.points.size(); ++p) {
    if (!rig.points[p].goal_lx) continue;
    const LightEstimate light = known.at(p, level);
    if (!(light.lux > 0)) continue;
    const double share = light.standard_error_lx / light.lux;
    error.rms += share * share;
    error.worst = std::max(error.worst, share);
    ++error.goals;
  }
  if (error.goals > 0) error.rms = std::sqrt(error.rms / static_cast<double>(error.goals));
  return error;
}

void print_report(const Session& session, const RigLight& light, const MeterRun& run, const GoalError& before) {
  const Rig& rig = session.rig;
  const LightUnknowns& known = light.known();
  Table lamps({"fixture", ">output", ">± se", ">moved cm", ">± se", ">turned °", ">± se", "dimmer"});
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    const Eigen::VectorXd off = known.mount(f), error = known.mount_standard_error(f);
    const MeasuredCurve& curve = run.curve(f);
    lamps.row({rig.fixtures[f].name, fmt::format("{:.3f}", known.gain(f)),
               fmt::format("{:.3f}", known.gain_standard_error(f)), fmt::format("{:.1f}", 100 * off.head<3>().norm()),
               fmt::format("{:.1f}", 100 * error.head<3>().norm()),
               fmt::format("{:.1f}", deg_from_rad(off.tail<3>().norm())),
               fmt::format("{:.1f}", deg_from_rad(error.tail<3>().norm())),
               curve.empty() ? "no meter sees it well enough"
                             : fmt::format("{:.0f} % of its light at half level", 100 * share_at_level(curve, 0.5))});
  }
  const GoalError now = error_of_goals(rig, known);
  fmt::print(
      "{}\nThe light at {} goals is known to {:.1f} % (root mean square; before: {:.1f} %), at the worst to "
      "{:.1f} % ({:.1f} %).\n",
      lamps.text(), now.goals, 100 * now.rms, 100 * before.rms, 100 * now.worst, 100 * before.worst);
  const Eigen::VectorXd level = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(rig.fixtures.size()), 0.4);
  const auto next = light.places_to_measure(level, 3, {});
  if (next.empty()) return;
  std::string names;
  for (const std::size_t p : next) names += (names.empty() ? "\"" : ", \"") + rig.points[p].name + "\"";
  fmt::print("A luxmeter at {} would settle most of the rest.\n", names);
}

std::string calibration_words(const std::string& made) {
  return made.empty() ? "no calibration" : fmt::format("the calibration of {}", made);
}

int run_calibrate(const CalibrateArguments& arguments) {
  const std::stop_token stop = stop_on_signals();  // before any thread
  const auto session = open_stated_session(arguments.rig);
  if (!session) return report(session.error());
  const Rig& rig = session->rig;
  if (rig.luxmeters.empty()) {
    fmt::print(stderr, "luxrig: the rig has no [[luxmeter]] to measure with\n");
    return kExitBadInput;
  }
  auto daemon = DaemonRig::of(arguments.client, rig);
  if (!daemon) return report_unreachable(daemon.error());
  // A calibrated daemon's levels are shares of true light. What is measured is over the rig file.
  const auto in_use = with_calibration(rig);
  if (!in_use) return report(in_use.error());
  if (daemon->calibrated() != in_use->calibrated)
    return report(Fault{Cause::invalid,
                        "",
                        fmt::format("the daemon lights by {}, {} holds {}; restart the daemon, and measure then",
                                    calibration_words(daemon->calibrated()), calibration_file(rig).string(),
                                    calibration_words(in_use->calibrated)),
                        {}});
  const auto level_of_daemon = [&](std::vector<double> level) {
    for (std::size_t f = 0; f < level.size(); ++f)
      level[f] = share_at_level(in_use->fixtures[f].measured_curve, level[f]);
    return level;
  };
  const auto level_of_file = [&](std::vector<double> level) {
    for (std::size_t f = 0; f < level.size(); ++f)
      level[f] = level_of_share(in_use->fixtures[f].measured_curve, level[f]);
    return level;
  };

  ComputeOptions compute = arguments.compute;
  compute.watch.stop = stop;
  TerminalWatch terminal;
  compute.watch.tell = terminal.tell();
  auto light = RigLight::of(*session, usual_priors(rig), compute);
  if (!light) return report(light.error());
  const GoalError before = error_of_goals(rig, light->known());

  MeterRun run(rig, light->stated_lux());
  const Progress progress = progress_line("measuring");
  while (const auto step = run.next()) {
    if (progress) progress(static_cast<double>(run.done()) / static_cast<double>(run.steps()));
    const auto seen = daemon->measure(level_of_daemon(step->level), stop);
    if (!seen) return report(Fault{seen.error().cause, "", step->what + ": " + seen.error().detail, {}});
    run.take(level_of_file(seen->level), seen->readings);
  }
  if (auto learnt = light->learn(run.readings()); !learnt) return report(learnt.error());

  const auto file = arguments.file.value_or(calibration_file(rig));
  if (auto kept = keep_old(file); !kept) return report(kept.error());
  if (auto written = write_file(file, to_json(calibration_of(*session, *light, run, utc_now()))); !written)
    return report(written.error());
  print_report(*session, *light, run, before);
  fmt::print("Written: {}\n{}\n", file.string(),
             arguments.file ? "It is in use once it lies beside the rig file, as calibration.json."
                            : "Start luxrig run anew to light the rig by it.");
  return kExitOk;
}

Action declare_calibrate(CLI::App& command) {
  const auto calibrate = std::make_shared<CalibrateArguments>();
  add_rig_option(command, calibrate->rig);
  add_client_without_json(command, calibrate->client);
  add_compute(command, calibrate->compute);
  command.add_option("--file", calibrate->file, "where to write it (else calibration.json beside the rig file)");
  return [calibrate] { return run_calibrate(*calibrate); };
}

}  // namespace

const Command kCalibrateCommand{"calibrate", command_group::kMeasure,
                                "what the rig file says wrongly, measured by the luxmeters", declare_calibrate};

}  // namespace luxrig
