#include "tools/luxrigd/run.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <mutex>
#include <thread>

#include "core/estimation/calibration.h"
#include "core/parallel.h"
#include "core/rig/null_bus.h"
#include "core/tasks/solve_tasks.h"
#include "tools/luxrig/open_session.h"
#include "tools/luxrigd/api/rig_pictures.h"
#include "tools/luxrigd/daemon.h"
#include "tools/luxrigd/light_of_looks.h"
#include "tools/luxrigd/run_report.h"
#include "tools/luxrigd/scheduling.h"
#include "tools/luxrigd/service_manager.h"
#include "tools/process/files.h"
#include "tools/terminal/command.h"
#include "tools/terminal/terminal_watch.h"

namespace luxrig {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(20);
constexpr Duration kMaxParking = std::chrono::seconds(60);
constexpr Duration kMaxOnce = std::chrono::seconds(120);

Checked<Plan> plan_of_file(const std::filesystem::path& path) {
  const auto text = read_file(path);
  if (!text) return tl::unexpected(text.error());
  return plan_from_json(*text, path.string());
}

void say_solved(const RunReport& say, const Rig& rig, const Plan& plan) {
  for (const PlannedTask& task : plan.tasks) {
    if (task.relief) {
      const bool compared = task.relief->before_local_contrast_lx.value_or(0) > 0;
      const char* const when = levels_set_before(rig, task.name) ? "before" : "as they hang, at full level";
      say.say(fmt::format(
          "task {}: local contrast {:.1f} lx, relative {:.3f}, features with a shadow's edge {:.0f} %; "
          "{}; {:.1f} s",
          task.name, task.relief->local_contrast_lx, task.relief->relative_contrast, 100 * task.relief->coverage,
          compared ? fmt::format("{}: {:.1f} lx, {:.3f}, {:.0f} %", when, *task.relief->before_local_contrast_lx,
                                 task.relief->before_relative_contrast.value_or(0),
                                 100 * task.relief->before_coverage.value_or(0))
                   : std::string("no light on it before to compare with"),
          task.seconds));
      continue;
    }
    say.say(fmt::format("task {}: normalised error {:.2f} %, {} iterations, {:.1f} ms", task.name,
                        100 * task.normalised_error, task.iterations, 1000 * task.seconds));
  }
  for (const PlannedPoint& point : plan.points)
    if (point.verdict && *point.verdict != Verdict::met) say.say(fmt::format("  {}: {}", point.name, point.reason));
}

/// What a simulated rig was found to be says nothing about a real one, nor about another simulated one.
std::vector<Problem> calibrated_elsewhere(const Rig& rig, const std::optional<SimPorts>& ports) {
  if (rig.calibrated_on.empty()) return {};
  const std::string here = ports ? ask_world({ports->control.host, ports->control.port, {}, {}}) : "";
  if (here == rig.calibrated_on) return {};
  return {{calibration_file(rig).string(), 0, 0,
           fmt::format("was measured on a simulated rig ({}), this is {}", rig.calibrated_on,
                       !ports         ? "the real one"
                       : here.empty() ? "another"
                                      : fmt::format("another ({})", here)),
           "move it elsewhere; then luxrig calibrate measures this one"}};
}

/// State of goals and limits, in one line.
std::string goals_text(const ShowStatus& status, const Rig& rig) {
  std::string text = text_of(status.goals);
  if (status.goals.goals() > 0) text += fmt::format(" ({})", tolerance_text(rig.goal_tolerances()));
  const int limits = status.limits_kept + status.limits_exceeded + status.limits_unknown;
  if (limits == 0) return text;
  text += fmt::format(", {} of {} limits kept", status.limits_kept, limits);
  if (status.limits_exceeded > 0) text += fmt::format(", {} exceeded", status.limits_exceeded);
  if (status.limits_unknown > 0) text += fmt::format(", {} unknown", status.limits_unknown);
  return text;
}

/// What the rig file asks for, for heads as they hang. Its light is known then.
Result<Plan> solve_again(const Session& session, const ComputeOptions& compute, LightOfLooks& light) {
  return in_background([&]() -> Result<Plan> {
    const auto transport = compute_transport(session, compute);
    if (!transport) return tl::unexpected(transport.error());
    auto solved = solve_what_hangs(session, *transport, compute);
    if (!solved) return tl::unexpected(solved.error());
    light.know(session, solved->look.joints, std::move(solved->transport));
    return std::move(solved->plan);
  });
}

/// Ticks until `done` returns true.
void tick_until(Daemon& daemon, const std::function<bool(Time)>& done) {
  Time next = now();
  while (true) {
    daemon.tick();
    if (done(now())) return;
    next += kTick;
    if (const Time late = now(); late > next) next = late;
    sleep_until(next);
  }
}

/// Ticks until the look is held, or kMaxOnce has passed.
void tick_until_held(Daemon& daemon, RunReport& say, const std::stop_token& stop) {
  const Time begun = now();
  tick_until(daemon, [&](Time at) {
    say.follow(daemon.status(), at);
    return daemon.status().phase == Phase::holding || stop.stop_requested() || at - begun > kMaxOnce;
  });
}

/// Takes pictures while the control loop runs on.
Result<std::vector<TakenByCamera>> take_pictures(Daemon& daemon, RunReport& say, RigPictures& pictures,
                                                 const std::string& label) {
  auto taking = std::async(std::launch::async, [&] {
    make_background();
    return pictures.take(label);
  });
  tick_until(daemon, [&](Time at) {
    say.follow(daemon.status(), at);
    return taking.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  });
  auto taken = taking.get();
  if (taken)
    for (const TakenByCamera& one : *taken)
      say.say(fmt::format("camera {}: {}{}", one.camera, one.file.string(),
                          one.contrast
                              ? fmt::format(", local contrast of the relief {:.3f} (its {} places in view, mean "
                                            "{:.0f} cd/m2)",
                                            one.contrast->local_contrast, one.contrast->seen, one.contrast->mean_cd_m2)
                              : ""));
  return taken;
}

/// Shows and photographs the rig as it hangs, then the plan.
Result<void> show_before_and_after(Daemon& daemon, RunReport& say, RigPictures& pictures, const Plan& hung,
                                   const Plan& plan, const std::stop_token& stop) {
  std::vector<TakenByCamera> before;
  for (const bool after : {false, true}) {
    say.say(after ? "the plan"
            : hung.tasks.front().name == kAsItHangs
                ? "the rig as it hangs, at full level: no task or goal before the aim sets any"
                : "the rig as it hangs");
    // Apply as a client would: light of turned heads is computed beside the control loop.
    auto applying = std::async(std::launch::async, [&] { return daemon.apply(after ? plan : hung); });
    tick_until(daemon, [&](Time) { return applying.wait_for(std::chrono::seconds(0)) == std::future_status::ready; });
    if (const auto applied = applying.get(); !applied) return refusal(applied.error().front().text());
    tick_until_held(daemon, say, stop);
    if (stop.stop_requested()) return {};
    auto taken = take_pictures(daemon, say, pictures, after ? "after" : "before");
    if (!taken) return tl::unexpected(taken.error());
    for (std::size_t i = 0; after && i < taken->size(); ++i)
      if (const auto& was = before[i].contrast, &is = (*taken)[i].contrast; was && is && was->local_contrast > 0)
        say.say(fmt::format("camera {}: local contrast of the relief {:+.0f} %", before[i].camera,
                            100 * (is->local_contrast / was->local_contrast - 1)));
    before = std::move(*taken);
  }
  return {};
}

}  // namespace

int run_rig(const RunArguments& arguments) {
  const Time process_start = now();
  ServiceManager service;
  keep_signal(SIGUSR1);
  const std::stop_token stop = stop_on_signals();
  // The run goes on without a reader: a terminal's hang-up or a closed pipe ends nothing.
  ::signal(SIGHUP, SIG_IGN);
  ::signal(SIGPIPE, SIG_IGN);
  Teller teller(STDOUT_FILENO), progress(STDERR_FILENO);
  auto opened = open_session(arguments.rig);
  if (!opened) return report(opened.error());
  const auto session = std::make_shared<const Session>(std::move(*opened));
  const Rig& rig = session->rig;
  if (const auto unwired = null_buses_in_use(rig); !unwired.empty()) return report(unwired);
  const bool places =
      std::any_of(rig.tasks.begin(), rig.tasks.end(), [](const Task& task) { return task.places_lights(); });
  if (rig.fixtures.empty() && places) {
    return report(std::vector<Problem>{
        {rig.file.string(), 1, 1, "nothing hangs in this rig yet: it has tasks that place lights, and no [[fixture]]",
         "have luxrig solve place them, hang and patch them, and write a [[fixture]] for each"}});
  }
  if (arguments.pictures && (arguments.plan || (!arguments.sim.start && !arguments.sim_ports) || rig.cameras.empty())) {
    return report(std::vector<Problem>{
        {rig.file.string(), 1, 1,
         rig.cameras.empty() ? "--pictures: this rig has no [[camera]]"
                             : "--pictures shows the simulated rig as it hangs, then what its tasks make of it",
         rig.cameras.empty() ? "add one" : "give it with --sim or --sim-ports, and without --plan"}});
  }
  RunReport say(teller, rig, process_start);
  say.say(fmt::format("{}: {} triangles, {} fixtures, {} points, {} luxmeters", rig.name,
                      session->scene.triangles.size(), rig.fixtures.size(), rig.points.size(), rig.luxmeters.size()));
  if (!rig.calibrated.empty())
    say.say(fmt::format("as calibrated {} ({})", rig.calibrated, calibration_file(rig).string()));
  const bool simulates = arguments.sim.start || arguments.sim_ports;
  if (!simulates)
    if (const auto elsewhere = calibrated_elsewhere(rig, {}); !elsewhere.empty()) return report(elsewhere);
  if (simulates && !rig.calibrated.empty() && rig.calibrated_on.empty())
    say.say("warning  that calibration is of the real rig, and the simulated one is not what was measured");

  // 1. The simulated rig computes its truth while we compute the plan.
  DaemonOptions options;
  std::optional<SimProcess> sim;
  std::optional<SimPorts> ports;
  if (arguments.sim_ports) {
    auto known = read_sim_ports(*arguments.sim_ports);
    if (!known) return report(known.error());
    ports = std::move(*known);
  } else if (arguments.sim.start) {
    auto started = SimProcess::start(rig.file, arguments.sim.seed, arguments.sim.deviations);
    if (!started) return report(started.error());
    sim.emplace(std::move(*started));
    say.say(
        fmt::format("simulated rig started, seed {}, deviations {}: its lamps, curves and poses are not quite what the "
                    "rig file says",
                    arguments.sim.seed, arguments.sim.deviations));
  }

  // 2. The light model and a plan. If an earlier daemon left both, there is light at once.
  if (arguments.state_folder) {
    options.state_folder = arguments.state_folder;
  } else if (!arguments.sim.start && !arguments.sim_ports) {
    options.state_folder = default_state_folder(rig.name);
  }
  ComputeOptions compute = arguments.compute;
  const bool goes_on = !arguments.plan && !arguments.once && !arguments.fresh && !arguments.pictures;
  std::optional<KeptLight> light;
  std::optional<Plan> plan, hung;
  Look look = hung_look(rig);
  Journal::Left left;
  if (goes_on) left = Journal(options.state_folder).load();
  compute.watch.stop = stop;
  const auto looks = std::make_shared<LightOfLooks>(compute, options.state_folder);
  if (goes_on && left.state && !left.state->plan_json.empty()) light = looks->read_saved(*session);
  if (light) say.say("transport: as it was worked out for this rig before");
  std::optional<TerminalWatch> terminal(std::in_place, [&](std::string text) { progress.tell(std::move(text)); });
  compute.watch.tell = terminal->tell();
  if (arguments.plan) {
    auto read = plan_of_file(*arguments.plan);
    if (!read) return report(read.error());
    auto wanted = look_for(*read, rig, arguments.plan->string());
    if (!wanted) return report(wanted.error());
    look = std::move(*wanted);
    plan = std::move(*read);
  }
  if (!light) {
    ModelUsed used;
    Look seen = look;  // any levels: all lamps count alike
    seen.levels.clear();
    auto transport = in_background([&] { return compute_transport(*session, compute, seen, &used); });
    if (!transport) return report(transport.error());
    say.say(fmt::format("transport: {} x {} by {}, error {:.2g} rms, {:.2g} at most, {} rays, {} threads",
                        transport->receivers(), transport->emitters(), used.name, used.rms_error, used.relative_error,
                        transport->rays, thread_count(compute.threads)));
    if (const std::string warning = used.warning(); !warning.empty()) say.say("warning: " + warning);
    if (arguments.pictures) {
      auto solved = solve_what_hangs(*session, *transport, compute, false);
      if (!solved) return report(solved.error());
      hung = std::move(solved->plan);
      looks->know(*session, look.joints, *transport);
    }
    if (!plan) {
      auto solved = in_background([&] { return solve_what_hangs(*session, *transport, compute); });
      if (!solved) return report(solved.error());
      for (const Task& task : rig.tasks) {
        if (task.places_lights())
          say.say(fmt::format("task {}: left out, since it places lights that do not hang yet: luxrig solve does it",
                              task.name));
      }
      say_solved(say, rig, solved->plan);
      plan = std::move(solved->plan);
      look = std::move(solved->look);
      transport = std::move(solved->transport);
    }
    light = KeptLight{look.joints, light_model(*session, *transport)};
    looks->know(*session, look.joints, std::move(*transport));
  }
  compute.watch.tell = nullptr;
  terminal.reset();
  if (sim) {
    auto ready = sim->wait_ready({stop, nullptr});
    if (!ready) return report(ready.error());
    ports = std::move(*ready);
    say.say(fmt::format("simulated rig ready; faults and truth: http://{}:{} (tools/luxrig-sim/README.md)",
                        ports->control.host, ports->control.port));
  }

  if (ports)
    if (const auto elsewhere = calibrated_elsewhere(rig, ports); !elsewhere.empty()) return report(elsewhere);

  // 3. The daemon.
  if (ports) options.redirects = ports->buses;
  if (ports) options.sim_control = ports->control;
  options.simulated = ports.has_value();
  options.http_port = arguments.http_port.value_or(rig.daemon.http_port);
  // No guardian for our own simulator: it would die with us.
  options.guarded = !arguments.no_guardian && !sim && options.state_folder.has_value();
  options.light_model = [looks](const Session& in, const std::vector<Joints>& joints) {
    return looks->model(in, joints);
  };
  options.solve = [compute, looks](const Session& reread, const Watch& watch) {
    ComputeOptions watched = compute;
    if (watch.stop.stop_possible()) watched.watch = watch;
    return solve_again(reread, watched, *looks);
  };
  Daemon daemon(session, std::move(*light), options);
  const auto port = daemon.start();
  if (!port) return report(port.error());
  std::jthread blackout_by_signal = on_signal(SIGUSR1, [&] {
    if (const auto dark = daemon.blackout(true); !dark) say.say("warning  blackout by signal: " + dark.error().detail);
  });
  say.say("page and status: " + daemon.page_address() + " (opens one browser; luxrig page prints another)");
  if (const std::string why = daemon.unreachable(); !why.empty())
    say.say("warning  the page is served, but luxrig status, blackout and the other commands will not find this daemon: " + why);
  if (const std::string why = daemon.accounts_problem(); !why.empty())
    say.say("warning  nobody can log in with an account: " + why);
  if (!daemon.unguarded().empty()) {
    say.say("warning  if this process dies, lamps do what they do without data: no guardian: " + daemon.unguarded());
  }
  bool resumed = false;
  if (goes_on) {
    // A damaged or outdated state must not keep the rig dark: report the parts that cannot be restored, and use the
    // fresh plan.
    const Resumed state = daemon.resume(left);
    resumed = state.plan;
    if (resumed) say.say("resumed the plan that was in force (--fresh starts from the rig file)");
    for (const std::string& note : state.notes) say.say("warning  " + note);
  }
  int pictures_failed = kExitOk;
  if (hung) {
    RigPictures pictures(*session, ports->control, *arguments.pictures);
    if (const auto shown = show_before_and_after(daemon, say, pictures, *hung, *plan, stop); !shown)
      pictures_failed = report(shown.error());
  } else if (!resumed) {
    if (!plan) {  // the saved plan could not be restored
      auto solving = std::async(std::launch::async, [&] { return solve_again(*session, compute, *looks); });
      tick_until(daemon, [&](Time) {
        service.alive(now());
        return solving.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
      });
      auto solved = solving.get();
      if (!solved) {
        return report(std::vector<Problem>{{rig.file.string(), 0, 0, solved.error().detail, "mend the rig file"}});
      }
      plan = std::move(*solved);
    }
    if (const auto applied = daemon.apply(*plan, !arguments.plan); !applied) return report(applied.error());
  }
  service.ready();

  if (!realtime_allowed()) {
    say.say(
        "warning  real-time scheduling is refused: output may be some ms late under load; allow it with "
        "CAP_SYS_NICE or an rtprio limit");
  }

  // 4. Light, measure, correct, hold.
  double converged_s = 0;
  bool shown = false;
  const auto truth = [&]() -> std::optional<SimTruth> { return ports ? ask_truth(ports->control) : std::nullopt; };
  tick_until(daemon, [&](Time at) {
    service.alive(at);
    say.use(daemon.session()->rig);
    say.follow(daemon.status(), at);
    const bool settled = daemon.status().phase == Phase::holding;
    if (settled && !shown) {
      shown = true;
      converged_s = to_seconds(at - process_start);
      if (!arguments.once) {
        say.print("\n" + say.table(daemon.status(), truth()) + "\n");
        say.say(fmt::format("{}, in {:.1f} s; page: {} (Ctrl-C fades to the safe look and ends)",
                            goals_text(daemon.status(), rig), converged_s, daemon.page_address()));
      }
    }
    return stop.stop_requested() || pictures_failed != kExitOk ||
           (arguments.once && (settled || at - process_start > kMaxOnce));
  });
  const ShowStatus final_status = daemon.status();

  service.ending();

  // 5. End: the safe look, then each driver's goodbye.
  const auto seen = arguments.once ? truth() : std::nullopt;
  if (rig.daemon.park_at_end && daemon.park()) {
    say.say("heads go dark and to where they rest");
    const Time begun = now();
    tick_until(daemon, [&](Time at) {
      const Phase phase = daemon.status().phase;
      return daemon.status().resting || phase == Phase::frozen || phase == Phase::safe || at - begun > kMaxParking;
    });
  }
  say.say("fading to the safe look");
  daemon.go_safe();
  const Duration most = from_seconds(rig.safe.fade_s + 2);
  const Time fade_start = now();
  tick_until(daemon, [&](Time at) { return daemon.status().phase == Phase::safe || at - fade_start > most; });
  const auto after = arguments.once ? truth() : std::nullopt;
  blackout_by_signal = {};
  daemon.stop();
  say.say(daemon.status().phase == Phase::safe ? "ended in the safe look" : "ended before the safe look was reached");
  if (pictures_failed != kExitOk || !arguments.once) return pictures_failed;

  // Values are of the held look; peaks and limit violations are of the whole run.
  auto whole = seen;
  if (whole && after) {
    for (std::size_t i = 0; i < whole->points.size(); ++i)
      whole->points[i].max_lux_seen = after->points[i].max_lux_seen;
    whole->violations = after->violations;
  }
  const bool held = final_status.phase == Phase::holding && !final_status.blackout;
  const bool done =
      held && final_status.goals.missed == 0 && final_status.limits_exceeded == 0 && (!whole || whole->violations == 0);
  say.print("\n" + say.table(final_status, whole) + "\n");
  say.say(
      fmt::format("{} after {} correction rounds, {:.1f} s from process start{}",
                  held ? goals_text(final_status, rig) : "the look was not reached: " + final_status.detail,
                  final_status.round, converged_s,
                  whole ? fmt::format("; limits exceeded in the simulator's truth: {} times", whole->violations) : ""));
  if (arguments.json) {
    const auto written = write_file(*arguments.json, say.json(final_status, whole, converged_s));
    if (!written) return report(written.error());
    say.say("table as JSON: " + arguments.json->string());
  }
  return done ? kExitOk : kExitFailed;
}

}  // namespace luxrig
