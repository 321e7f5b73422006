// calibrate: what the rig file says wrongly, measured by luxmeters that hang or are held, while the daemon runs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <memory>
#include <utility>

#include "core/calibration/meter_run.h"
#include "core/calibration/open_run.h"
#include "core/calibration/rig_light.h"
#include "tools/command_line/installed.h"
#include "tools/luxrig/calibrate/by_camera.h"
#include "tools/luxrig/calibrate/by_hand.h"
#include "tools/luxrig/calibrate/by_heads.h"
#include "tools/luxrig/calibrate/by_open_hours.h"
#include "tools/luxrig/calibrate/daemon_rig.h"
#include "tools/luxrig/calibrate/head_motions.h"
#include "tools/luxrig/calibrate/heads_by_meters.h"
#include "tools/luxrig/calibrate/keep_result.h"
#include "tools/luxrig/calibrate/measuring.h"
#include "tools/luxrig/calibrate/simulated_run.h"
#include "tools/luxrig/commands.h"
#include "tools/luxrig/compute_arguments.h"
#include "tools/luxrig/open_session.h"
#include "tools/luxrigd/run_options.h"
#include "tools/process/files.h"
#include "tools/process/sim_process.h"
#include "tools/terminal/command.h"
#include "tools/terminal/terminal_watch.h"

namespace luxrig {
namespace {

struct CalibrateArguments {
  std::filesystem::path rig;
  ClientArguments client;
  SimArguments sim;
  ComputeOptions compute;
  bool meters = false, hand = false;  ///< neither, and no cameras = meters
  std::string hours = "closed";
  double open_minutes = 28;
  std::vector<std::string> cameras;                 ///< names
  int sim_hand = 0;                                 ///< places where a simulated hand reads; 0 = a person does
  bool no_heads = false;                            ///< pan-tilt heads are left as they are
  std::optional<std::filesystem::path> meter_file;  ///< of the meter in the hand
  std::optional<std::filesystem::path> file;        ///< none = calibration.json beside the rig file
};

std::function<void(std::size_t)> progress_of(const char* what, std::size_t steps) {
  return [steps, progress = progress_line(what)](std::size_t done) {
    if (progress) progress(static_cast<double>(done) / static_cast<double>(steps));
  };
}

Result<void> by_hanging_meters(Measuring& measuring) {
  const Rig& rig = measuring.session.rig;
  MeterRun run(rig, measuring.levels.brightest, measuring.light.stated_lux());
  const auto together = levels_together(rig, measuring.light.stated_lux(), measuring.levels.brightest);
  for (std::size_t taken = 0; taken < run.plan().size();) {
    const char* what = taken == 0 ? "measuring each lamp alone" : "measuring dimmed lamps";
    std::vector<std::vector<double>> lights;
    for (const auto& lit : std::span(run.plan()).subspan(taken)) lights.push_back(levels_of(lit, rig));
    const auto read = measuring.daemon.measure(lights, together, progress_of(what, lights.size()), measuring.stop);
    if (!read) return tl::unexpected(read.error());
    for (const DaemonRig::Read& light : *read) run.take(light.sent, light.readings);
    taken += read->size();
  }
  measuring.curves = run.curves();
  measuring.levels.brightest = run.brightest();
  std::vector<LightReading> readings = run.readings();
  measuring.any = measuring.any || !readings.empty();
  for (LightReading& reading : readings) reading.receiver += measuring.no_points().size();
  measuring.light.read_at(
      Eigen::Map<const Eigen::VectorXd>(run.brightest().data(), std::ssize(run.brightest())).cwiseMax(kDimmestLevel));
  return measuring.light.learn(readings);
}

Result<void> by_cameras(Measuring& measuring) {
  auto seen = measure_by_cameras(measuring.session, measuring.cameras, measuring.light.stated_lux(), measuring.daemon,
                                 measuring.levels.brightest, measuring.curves, measuring.stop);
  if (!seen) return tl::unexpected(seen.error());
  measuring.any = measuring.any || !seen->readings.empty();
  measuring.seen = std::move(*seen);
  return measuring.light.learn(measuring.seen.readings);
}

/// How the rig's heads hang and turn, told as it is found: by the first camera if any are used, else by the luxmeters.
Result<std::vector<MeasuredHead>> by_heads(const Measuring& measuring) {
  const Rig& rig = measuring.session.rig;
  const auto& each = measuring.seen.each;
  const auto seen = std::find_if(each.begin(), each.end(), [](const auto& one) { return one.has_value(); });
  auto heads = seen != each.end()
                   ? measure_heads(measuring.session,
                                   measuring.cameras.each[static_cast<std::size_t>(seen - each.begin())].camera,
                                   (*seen)->found.camera, measuring.daemon, measuring.stop)
                   : measure_heads_by_meters(measuring.session, measuring.daemon, measuring.stop);
  if (!heads) return heads;
  if (auto timed = measure_motions(measuring.session, measuring.daemon, measuring.stop, *heads); !timed) {
    if (timed.error().cause == Cause::cancelled) return tl::unexpected(timed.error());
    fmt::print(stderr, "luxrig: heads are not timed: {}\n", timed.error().detail);  // what was found of them stays
  }
  for (const MeasuredHead& head : *heads) fmt::print("{}\n", words_of(rig, head));
  const bool some_refused = std::any_of(heads->begin(), heads->end(),
                                        [](const MeasuredHead& head) { return head.result.refused.has_value(); });
  if (const std::string dim = limited_light_of(rig); some_refused && !dim.empty())
    fmt::print("Heads are turned {}. That may be too dim to find them.\n", dim);
  return heads;
}

std::string world_of(const HttpPeer& sim_control) {
  const std::string world = ask_world(sim_control);
  return world.empty() ? "one that does not say which" : world;
}

/// What an earlier calibration found of the same rig; none = it cannot be read, or is of another simulated rig.
std::optional<Calibration> found_before(const std::filesystem::path& file, const std::string& world) {
  const auto text = read_file(file);
  if (!text) return std::nullopt;
  auto before = calibration_from_json(*text, file.string());
  if (!before || before->simulated != world) return std::nullopt;
  return std::move(*before);
}

/// One instrument more for each lamp: how its light follows its level. The first of them.
std::size_t add_slopes(const Rig& rig, LightPriors& priors) {
  const auto first = static_cast<std::size_t>(priors.log_meter.size());
  const auto fixtures = static_cast<Eigen::Index>(rig.fixtures.size());
  priors.log_meter.conservativeResize(priors.log_meter.size() + fixtures);
  priors.log_meter.tail(fixtures).setConstant(OpenRun::kSlopeError);
  return first;
}

/// What the arguments ask for and the rig cannot give; empty = nothing.
std::string cannot_measure(const CalibrateArguments& arguments, const Rig& rig, bool meters) {
  if (meters && rig.luxmeters.empty())
    return "the rig has no [[luxmeter]] to measure with; --hand asks for readings of one in your hand";
  if (arguments.hours == "open" && (arguments.hand || !arguments.cameras.empty()))
    return "by hand and by camera, lamps go on alone: that takes --hours closed";
  return "";
}

int run_calibrate(const CalibrateArguments& arguments) {
  const std::stop_token stop = stop_on_signals();  // before any thread
  const auto session = open_stated_session(arguments.rig);
  if (!session) return report(session.error());
  const Rig& rig = session->rig;
  const bool meters = arguments.meters || (!arguments.hand && arguments.cameras.empty());
  const bool open = arguments.hours == "open";
  if (const std::string why = cannot_measure(arguments, rig, meters); !why.empty()) {
    fmt::print(stderr, "luxrig: {}\n", why);
    return kExitBadInput;
  }
  std::optional<SimulatedRun> simulated;
  if (arguments.sim.start) {
    auto run = SimulatedRun::start(arguments.rig, arguments.sim, arguments.client.port, stop);
    if (!run) return report(run.error());
    simulated.emplace(std::move(*run));
  }
  auto daemon = DaemonRig::of(arguments.client, rig);
  if (!daemon) return report_unreachable(daemon.error());
  const auto file = arguments.file.value_or(calibration_file(rig));
  const std::string world = daemon->sim_control() ? world_of(*daemon->sim_control()) : "";
  const std::optional<Calibration> earlier = found_before(file, world);

  ComputeOptions compute = arguments.compute;
  compute.watch.stop = stop;
  TerminalWatch terminal;
  compute.watch.tell = terminal.tell();
  LightPriors priors = usual_priors(rig);
  CameraViews views;
  if (!arguments.cameras.empty()) {
    auto seen = camera_views(*session, arguments.cameras, earlier ? &*earlier : nullptr, priors);
    if (!seen) return report(seen.error());
    views = std::move(*seen);
  }
  const auto first_slope = open ? std::optional(add_slopes(rig, priors)) : std::nullopt;
  const Session& with_places = views.session ? *views.session : *session;
  auto light = RigLight::of(with_places, priors, compute);
  if (!light) return report(light.error());
  Measuring measuring{*session,
                      *daemon,
                      *light,
                      {kLevelOfUse * Eigen::VectorXd::Ones(static_cast<Eigen::Index>(rig.fixtures.size())),
                       brightest_levels(rig, light->stated_lux())},
                      std::vector<LampCurve>(rig.fixtures.size()),
                      stop,
                      views,
                      false};
  measuring.first_slope = first_slope;
  const RigLight before = *light;
  const auto look = daemon->levels_now();
  if (!look) return report(look.error());
  if (meters)
    if (auto measured =
            open ? by_meters_in_open_hours(measuring, arguments.open_minutes) : by_hanging_meters(measuring);
        !measured)
      return report(measured.error());
  const bool seen = !views.each.empty();
  if (seen)
    if (auto measured = by_cameras(measuring); !measured) return report(measured.error());
  std::vector<MeasuredHead> heads;
  if ((seen || (meters && !open)) && !arguments.no_heads) {
    auto measured = by_heads(measuring);
    if (!measured) return report(measured.error());
    heads = std::move(*measured);
  }
  if (arguments.hand) {
    auto measured = arguments.sim_hand > 0 ? measure_by_simulated_hand(measuring, arguments.sim_hand, world)
                                           : measure_by_hand(measuring, arguments.meter_file);
    if (!measured) return report(measured.error());
  }

  if (!measuring.any) {
    fmt::print(stderr, "luxrig: nothing was measured, so nothing is written\n");
    return kExitFailed;
  }
  std::vector<std::string> by;
  if (meters) by.emplace_back("luxmeters that hang");
  for (std::size_t k = 0; k < measuring.seen.each.size(); ++k)
    if (measuring.seen.each[k]) by.push_back("camera \"" + arguments.cameras[k] + "\"");
  if (arguments.hand) by.emplace_back("a luxmeter in the hand");
  const auto page = keep_result({measuring, with_places, before, heads, *look, file, world, earlier, by}, compute);
  if (!page) return report(page.error());
  fmt::print("Written: {}\nHow good it is, as a page: {}\n{}\n", file.string(), page->string(),
             arguments.file ? "It is in use once it lies beside the rig file, as calibration.json."
             : arguments.sim.start
                 ? fmt::format("Light this simulated rig by it: luxrig run {} --sim --sim-deviations {} --sim-seed {}",
                               arguments.rig.string(), arguments.sim.deviations, arguments.sim.seed)
                 : "Start luxrig run anew to light the rig by it.");
  return kExitOk;
}

Action declare_calibrate(CLI::App& command) {
  const auto calibrate = std::make_shared<CalibrateArguments>();
  add_rig_option(command, calibrate->rig);
  add_client_without_json(command, calibrate->client);
  add_sim_options(command, calibrate->sim,
                  "start a simulated rig and a daemon for it, and measure that; else a running daemon's rig");
  add_compute(command, calibrate->compute);
  command.add_flag("--meters", calibrate->meters, "by the luxmeters that hang (default without --hand)");
  command.add_flag(
      "--hand", calibrate->hand,
      "by a luxmeter in your hand: it says where to hold it, here and on the daemon's page; the first reading counts");
  command
      .add_option(
          "--camera", calibrate->cameras,
          "by this [[camera]] of the rig, with at least one reading of a luxmeter; several times for several cameras; "
          "by the first also how pan-tilt heads hang and turn")
      ->type_name("NAME");
  command.add_flag("--no-heads", calibrate->no_heads, "do not turn the rig's pan-tilt heads to see how they hang");
  command.add_option("--meter-file", calibrate->meter_file,
                     "with --hand: file that the meter's program writes; Enter alone takes its last reading");
  command
      .add_option("--sim-hand", calibrate->sim_hand,
                  "with --hand and a simulated rig: a simulated hand reads, at so many places at most")
      ->type_name("PLACES")
      ->check(CLI::Range(1, 100))
      ->needs("--hand");
  command
      .add_option("--hours", calibrate->hours,
                  "open: the look stays and no step changes the light anywhere by more than 2 %, for --minutes; "
                  "closed: one lamp after "
                  "the other, alone (default)")
      ->check(CLI::IsMember({"open", "closed"}));
  command
      .add_option("--minutes", calibrate->open_minutes,
                  "with --hours open: about how long it may take; longer is better known (default 28)")
      ->check(CLI::Range(0.1, 600.0));
  command.add_option("--file", calibrate->file, "where to write it (else calibration.json beside the rig file)");
  return [calibrate] { return run_calibrate(*calibrate); };
}

}  // namespace

const Command kCalibrateCommand{"calibrate", command_group::kMeasure,
                                "what the rig file says wrongly, measured by luxmeters", declare_calibrate};

}  // namespace luxrig
