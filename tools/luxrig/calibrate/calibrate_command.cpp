// calibrate: what the rig file says wrongly, measured by luxmeters that hang or are held, while the daemon runs.
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>

#include "core/calibration/hand_place.h"
#include "core/calibration/meter_run.h"
#include "core/calibration/rig_light.h"
#include "core/output/dimming.h"
#include "tools/command_line/installed.h"
#include "tools/luxrig/calibrate/daemon_rig.h"
#include "tools/luxrig/calibrate/hand_meter.h"
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
  bool meters = false, hand = false;                ///< neither = meters
  std::optional<std::filesystem::path> meter_file;  ///< of the meter in the hand
  std::optional<std::filesystem::path> file;        ///< none = calibration.json beside the rig file
};

/// Share of full light at which the goals' error is told.
constexpr double kLevelOfUse = 0.4;

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

std::string known_words(const GoalError& error) {
  return fmt::format("{:.1f} %, at the worst to {:.1f} %", 100 * error.rms, 100 * error.worst);
}

/// What is being measured, by whichever means.
struct Measuring {
  const Session& session;
  DaemonRig& daemon;
  RigLight& light;
  HandLevels levels;
  std::vector<LampCurve> curves;  ///< per fixture
  std::stop_token stop;
  bool any = false;  ///< something is measured
};

Fault during(const LampStep& step, const Rig& rig, const Fault& fault) {
  return {fault.cause, "", words_of(step, rig) + ": " + fault.detail, {}};
}

Result<void> by_hanging_meters(Measuring& measuring) {
  const Rig& rig = measuring.session.rig;
  MeterRun run(rig, measuring.levels.brightest);
  const Progress progress = progress_line("measuring");
  while (const auto step = run.next()) {
    if (progress) progress(static_cast<double>(run.done()) / static_cast<double>(run.steps()));
    const auto sent = measuring.daemon.light(levels_of(*step, rig), measuring.stop);
    if (!sent) return tl::unexpected(during(*step, rig, sent.error()));
    const auto readings = measuring.daemon.read(measuring.stop);
    if (!readings) return tl::unexpected(during(*step, rig, readings.error()));
    run.take((*sent)[step->fixture], *readings);
  }
  measuring.curves = run.curves();
  measuring.any = true;
  return measuring.light.learn(run.readings());
}

/// One place; false = the person is done.
Result<bool> at_place(Measuring& measuring, HandPlace place, HandMeter& meter) {
  const Rig& rig = measuring.session.rig;
  std::vector<std::optional<double>> lux(place.steps.size());
  bool done = false;
  for (std::size_t k = 0; k < place.steps.size(); ++k) {
    LampStep& step = place.steps[k];
    const auto sent = measuring.daemon.light(levels_of(step, rig), measuring.stop);
    if (!sent) return tl::unexpected(during(step, rig, sent.error()));
    step.level = (*sent)[step.fixture];
    const auto answer = meter.ask(
        fmt::format("{} of {}, {}", k + 1, place.steps.size(), words_of(step, rig)), DaemonRig::kHoldAgain,
        [&] { return measuring.daemon.hold_again(); }, measuring.stop);
    if (!answer) return tl::unexpected(answer.error());
    done = answer->what == HandAnswer::What::done;
    if (done || answer->what == HandAnswer::What::other_place) break;
    if (answer->what == HandAnswer::What::reading) lux[k] = answer->lux;
  }
  // Without the dark, light of no lamp would count as theirs.
  const auto readings = lux.front() ? readings_at(rig, place, lux, measuring.curves) : std::vector<LightReading>{};
  if (readings.empty()) return !done;
  if (auto learnt = measuring.light.learn(readings); !learnt) return tl::unexpected(learnt.error());
  const GoalError now = measuring.light.error_of_goals(measuring.levels.use);
  fmt::print("Now the light at {} goals is known to {}.\n\n", now.goals, known_words(now));
  measuring.any = true;
  return !done;
}

Result<void> by_hand(Measuring& measuring, HandMeter meter) {
  const Rig& rig = measuring.session.rig;
  fmt::print("Type each reading in lux{}. s skips a lamp, n goes to another place, q ends.\n\n",
             meter.has_file() ? ", or Enter alone to take it from the meter's file" : "");
  std::vector<std::size_t> been;
  while (const auto place = next_hand_place(rig, measuring.light, measuring.levels, measuring.curves, been)) {
    const Point& point = rig.points[place->point];
    fmt::print("Hold the luxmeter at \"{}\": x {:.2f} m, y {:.2f} m, {:.2f} m high, {}.\n", point.name,
               point.position_world_m.x(), point.position_world_m.y(), point.position_world_m.z(),
               facing_words(point.normal_world));
    const auto more = at_place(measuring, *place, meter);
    if (!more) return tl::unexpected(more.error());
    if (!*more) return {};
    been.push_back(place->point);
  }
  fmt::print("There is no further place that would help.\n");
  return {};
}

void print_report(const Measuring& measuring, const GoalError& before) {
  const Rig& rig = measuring.session.rig;
  const LightUnknowns& known = measuring.light.known();
  Table lamps({"fixture", ">output", ">± se", ">moved cm", ">± se", ">turned °", ">± se", "dimmer"});
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    const Eigen::VectorXd off = known.mount(f), error = known.mount_standard_error(f);
    const MeasuredCurve& curve = measuring.curves[f].of_level;
    lamps.row({rig.fixtures[f].name, fmt::format("{:.3f}", known.gain(f)),
               known.gain_is_measured(f) ? fmt::format("{:.3f}", known.gain_standard_error(f)) : "not measured",
               fmt::format("{:.1f}", 100 * off.head<3>().norm()), fmt::format("{:.1f}", 100 * error.head<3>().norm()),
               fmt::format("{:.1f}", deg_from_rad(off.tail<3>().norm())),
               fmt::format("{:.1f}", deg_from_rad(error.tail<3>().norm())),
               curve.empty() ? "not measured"
                             : fmt::format("{:.0f} % of its light at half level", 100 * share_at_level(curve, 0.5))});
  }
  fmt::print("{}\nThe light at {} goals was known to {}. Now it is known to {}.\n", lamps.text(), before.goals,
             known_words(before), known_words(measuring.light.error_of_goals(measuring.levels.use)));
  const auto next = measuring.light.places_to_measure(measuring.levels.use, 3, {});
  if (next.empty()) return;
  std::string names;
  for (const std::size_t p : next) names += (names.empty() ? "\"" : ", \"") + rig.points[p].name + "\"";
  fmt::print("A luxmeter at {} would settle most of the rest: luxrig calibrate{} --hand.\n", names,
             rig.luxmeters.empty() ? "" : " --meters");
}

int run_calibrate(const CalibrateArguments& arguments) {
  const std::stop_token stop = stop_on_signals();  // before any thread
  const auto session = open_stated_session(arguments.rig);
  if (!session) return report(session.error());
  const Rig& rig = session->rig;
  const bool meters = arguments.meters || !arguments.hand;
  if (meters && rig.luxmeters.empty()) {
    fmt::print(stderr,
               "luxrig: the rig has no [[luxmeter]] to measure with; --hand asks for readings of one in your hand\n");
    return kExitBadInput;
  }
  auto daemon = DaemonRig::of(arguments.client, rig);
  if (!daemon) return report_unreachable(daemon.error());

  ComputeOptions compute = arguments.compute;
  compute.watch.stop = stop;
  TerminalWatch terminal;
  compute.watch.tell = terminal.tell();
  auto light = RigLight::of(*session, usual_priors(rig), compute);
  if (!light) return report(light.error());
  Measuring measuring{*session,
                      *daemon,
                      *light,
                      {kLevelOfUse * Eigen::VectorXd::Ones(static_cast<Eigen::Index>(rig.fixtures.size())),
                       brightest_levels(rig, light->stated_lux())},
                      std::vector<LampCurve>(rig.fixtures.size()),
                      stop,
                      false};
  const GoalError before = light->error_of_goals(measuring.levels.use);
  if (meters)
    if (auto measured = by_hanging_meters(measuring); !measured) return report(measured.error());
  if (arguments.hand)
    if (auto measured = by_hand(measuring, HandMeter(arguments.meter_file)); !measured) return report(measured.error());

  if (!measuring.any) {
    fmt::print(stderr, "luxrig: nothing was measured, so nothing is written\n");
    return kExitFailed;
  }
  const auto file = arguments.file.value_or(calibration_file(rig));
  if (auto kept = keep_old(file); !kept) return report(kept.error());
  const std::string text = to_json(calibration_of(*session, *light, measuring.curves, utc_now()));
  if (auto written = write_file(file, text); !written) return report(written.error());
  print_report(measuring, before);
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
  command.add_flag("--meters", calibrate->meters, "by the luxmeters that hang (default without --hand)");
  command.add_flag("--hand", calibrate->hand,
                   "by a luxmeter in your hand: it says where to hold it, you type readings");
  command.add_option("--meter-file", calibrate->meter_file,
                     "with --hand: file that the meter's program writes; Enter alone takes its last reading");
  command.add_option("--file", calibrate->file, "where to write it (else calibration.json beside the rig file)");
  return [calibrate] { return run_calibrate(*calibrate); };
}

}  // namespace

const Command kCalibrateCommand{"calibrate", command_group::kMeasure,
                                "what the rig file says wrongly, measured by luxmeters", declare_calibrate};

}  // namespace luxrig
