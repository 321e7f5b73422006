// solve: does the rig's tasks and writes a plan.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "core/tasks/solve_tasks.h"
#include "tools/command_line/completion.h"
#include "tools/command_line/installed.h"
#include "tools/luxrig/commands.h"
#include "tools/luxrig/compute_arguments.h"
#include "tools/luxrig/open_session.h"
#include "tools/luxrig/reasons_json.h"
#include "tools/luxrig/render/opening_light.h"
#include "tools/luxrig/transport_json.h"
#include "tools/luxrig/uniformity_json.h"
#include "tools/process/files.h"
#include "tools/terminal/command.h"
#include "tools/terminal/table.h"
#include "tools/terminal/terminal_watch.h"

namespace luxrig {
namespace {

struct SolveArguments {
  std::filesystem::path rig;
  std::optional<std::filesystem::path> output;
  ComputeOptions compute;
  bool json = false, explain = false;
};

/// By the model, as the verdicts of the plan's points.
std::vector<Uniformity> uniformities_of(const Rig& rig, const Plan& plan) {
  std::vector<LuxEstimate> light;
  for (const PlannedPoint& point : plan.points) light.push_back(estimate_of(point.lux, point.standard_error_lux));
  return uniformities(rig, light);
}

std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }

std::string watts_text(const std::optional<double>& watts) { return watts ? fmt::format("{:.1f}", *watts) : "-"; }

std::string xy_text(const std::optional<Chromaticity>& xy) {
  return xy ? fmt::format("{:.4f} {:.4f}", xy->x(), xy->y()) : "-";
}

/// Levels from the last task that sets fixtures.
void print_levels(const PlannedTask& task) {
  Table lights({"fixture", "luminaire", ">level", ">lumens", ">watts"});
  for (const PlannedLight& light : task.lights)
    lights.row({light.name, light.luminaire, percent(light.level), fmt::format("{:.0f}", light.lumens),
                watts_text(light.watts)});
  fmt::print("{}\n", lights.text());
}

void print_placed(const PlannedTask& task, const Task& asked, bool has_emitters) {
  const PlacementSpec& spec = asked.placement;
  if (task.lights.empty()) {
    fmt::print("{}: {} without a further light\n\n", task.name,
               task.relief ? "limits leave nothing to do" : "every goal is met");
    return;
  }
  Table lights({"hang", "luminaire", ">x m", ">y m", ">z m", "aim", ">level", ">lumens", ">watts"});
  std::size_t dark = 0;
  for (const PlannedLight& light : task.lights) {
    const Vec3& at = light.position_world_m;
    std::string aim = "down";
    if (light.aim_world_m)
      aim = fmt::format("{:.2f} {:.2f} {:.2f}", light.aim_world_m->x(), light.aim_world_m->y(), light.aim_world_m->z());
    lights.row({light.name, light.luminaire, fmt::format("{:.3f}", at.x()), fmt::format("{:.3f}", at.y()),
                fmt::format("{:.3f}", at.z()), aim, percent(light.level), fmt::format("{:.0f}", light.lumens),
                watts_text(light.watts)});
    dark += light.level > 0 ? 0 : 1;
  }
  fmt::print("{}\n", lights.text());
  if (dark > 0 && !has_emitters) fmt::print("{} of them would give no light: leave them out\n", dark);
  if (asked.kind == TaskKind::highlight) {
    std::string tried;
    for (const PlannedNumber& number : task.numbers)
      tried += fmt::format("{}{}: {:.1f} lx", tried.empty() ? "" : ", ", number.lights,
                           number.local_contrast_lx.value_or(0));
    if (!tried.empty()) fmt::print("lights and their local contrast at full level: {}\n", tried);
  } else if (!spec.lights) {
    std::string tried;
    for (const PlannedNumber& number : task.numbers)
      tried += fmt::format("{}{}: {}", tried.empty() ? "" : ", ", number.lights, percent(number.normalised_error));
    fmt::print("lights and what they leave of the error: {}\n", tried);
  }
  if (!task.front.empty()) {
    Table front({">power limit W", ">taken W", ">error left"});
    for (const PlannedPower& power : task.front)
      front.row({fmt::format("{:.1f}", power.max_watts), fmt::format("{:.1f}", power.watts),
                 percent(power.normalised_error)});
    fmt::print("what less power would cost (by the search's own light):\n{}\n", front.text());
  }
  if (spec.energy_front > 0 && task.front.empty())
    fmt::print("no time was left to search with less power (energy_front)\n");
  if (task.lower_bound)
    fmt::print(
        "proven by the search's own light: no lights at the places of its lattice leave less than {} (those found may "
        "lie between)\n",
        percent(*task.lower_bound));
  if (task.lower_bound_of_number)
    fmt::print("and no {} of them less than {}\n", task.lights.size(), percent(*task.lower_bound_of_number));
  fmt::print(
      "{} hang{} nowhere yet: render and evaluate show the plan. To run it, hang each at its place, patch it, and add "
      "it "
      "to the rig as a [[fixture]] of its name{}\n\n",
      task.lights.size() == 1 ? "it" : "they", task.lights.size() == 1 ? "s" : "",
      has_emitters ? " (what stands before the slash: its emitters are one fixture)" : "");
}

std::string degrees_text(double rad) { return fmt::format("{:.1f}°", deg_from_rad(rad)); }

void print_aim(const PlannedTask& task) {
  Table heads({"fixture", "looks at m", ">pan", ">tilt", ">beam", ">level", ">lumens", ">watts"});
  for (const PlannedLight& light : task.lights)
    heads.row({light.name,
               light.aim_world_m ? fmt::format("{:.3f} {:.3f} {:.3f}", light.aim_world_m->x(), light.aim_world_m->y(),
                                               light.aim_world_m->z())
                                 : "-",
               light.joints ? degrees_text(light.joints->pan_rad) : "-",
               light.joints ? degrees_text(light.joints->tilt_rad) : "-",
               light.joints && light.joints->beam_rad != 0 ? degrees_text(light.joints->beam_rad) : "-",
               percent(light.level), fmt::format("{:.0f}", light.lumens), watts_text(light.watts)});
  fmt::print("{}\n", heads.text());
}

void print_directions(const PlannedTask& task, const DirectionsSpec& spec) {
  Table lamps({"lamp", ">azimuth", ">elevation", fmt::format("held at m, {:g} m away", spec.distance_m)});
  for (std::size_t k = 0; k < task.directions.size(); ++k) {
    const PlannedDirection& held = task.directions[k];
    const Vec3& at = held.position_world_m;
    lamps.row({fmt::format("{}", k + 1), degrees_text(held.azimuth_rad), degrees_text(held.elevation_rad),
               fmt::format("{:.2f} {:.2f} {:.2f}", at.x(), at.y(), at.z())});
  }
  fmt::print("{} (from +x, counter-clockwise from above; above the horizontal)\n{}\n", task.name, lamps.text());
  std::string tried;
  for (const PlannedNumber& number : task.numbers)
    tried +=
        fmt::format("{}{}: {:.3f}", tried.empty() ? "" : ", ", number.lights, number.relative_contrast.value_or(0));
  if (!tried.empty()) fmt::print("lamps and their relative contrast: {}\n", tried);
  fmt::print(
      "{} ({}): local contrast {:.2f} lx by lamps of 1 lx each, relative {:.3f}, features with a shadow's edge {}, "
      "{:.1f} "
      "s\n\n",
      task.name, task.kind, task.relief->local_contrast_lx, task.relief->relative_contrast,
      percent(task.relief->coverage), task.seconds);
}

std::string ratio_words(const Rig& rig, const PlannedTask& planned) {
  for (const Task& task : rig.tasks) {
    if (task.name != planned.name) continue;
    const LightRole role = task.kind == TaskKind::aim ? task.aim.relief.role : task.highlight.relief.role;
    if (role == LightRole::key) return "key to all other light";
    if (role != LightRole::any) return fmt::format("key to {}", name_of(role));
  }
  return "key to fill";
}

void print_relief(const Rig& rig, const PlannedTask& task) {
  const PlannedRelief& relief = *task.relief;
  const char* const when = levels_set_before(rig, task.name) ? "before" : "as they hang, at full level";
  const bool dark = relief.before_local_contrast_lx.value_or(1) == 0;  // without light there is no figure
  const auto was = [&](const std::optional<double>& before, const std::string& text) {
    return before && !dark ? fmt::format(" ({}: {})", when, text) : std::string();
  };
  std::string contrast;
  if (std::isfinite(relief.local_contrast_lx))  // else its lights reach nothing of the relief
    contrast = fmt::format(
        "local contrast {:.1f} lx{}, relative {:.3f}{}, features with a shadow's edge {}{}, ", relief.local_contrast_lx,
        was(relief.before_local_contrast_lx, fmt::format("{:.1f}", relief.before_local_contrast_lx.value_or(0))),
        relief.relative_contrast,
        was(relief.before_relative_contrast, fmt::format("{:.3f}", relief.before_relative_contrast.value_or(0))),
        percent(relief.coverage), was(relief.before_coverage, percent(relief.before_coverage.value_or(0))));
  fmt::print(
      "{} ({}): {}brightest place {:.0f} lx direct{}, {:.1f} s\n", task.name, task.kind, contrast, relief.object_lux,
      relief.key_to_fill ? fmt::format(", {} {:.2f}", ratio_words(rig, task), *relief.key_to_fill) : "", task.seconds);
  if (relief.seen)
    fmt::print("{}: seen {:.3f}{}, lit {} of what is seen, burnt or black {}\n", task.name, *relief.seen,
               was(relief.before_seen, fmt::format("{:.3f}", relief.before_seen.value_or(0))),
               percent(relief.lit_share.value_or(0)), percent(relief.clipped_share.value_or(0)));
  if (dark)
    fmt::print("{}: no comparison with before, since the task before it leaves these heads dark or off the object\n",
               task.name);
}

const ReliefReasons* reasons_of(const SolvedTasks& solved, const PlannedTask& task) {
  for (const ReliefReasons& reasons : solved.reasons)
    if (reasons.task == task.name) return &reasons;
  return nullptr;
}

void print_reasons(const ReliefReasons& reasons, bool explain) {
  if (!explain) {
    if (const std::string dark = dark_in_words(reasons); !dark.empty()) fmt::print("{}: {}\n", reasons.task, dark);
    return;
  }
  fmt::print("\n{}: {}\n", reasons.task, in_two_sentences(reasons));
  Table services(reasons.seen
                     ? std::vector<std::string>{"light", ">fine relief", ">broad form", ">lit surface", ">outline"}
                     : std::vector<std::string>{"light", ">local contrast", ">features"});
  for (const LightService& light : reasons.lights)
    services.row(reasons.seen
                     ? std::vector<std::string>{light.light, percent(light.fine), percent(light.form),
                                                percent(light.lit), percent(light.edge)}
                     : std::vector<std::string>{light.light, percent(light.contrast), percent(light.coverage)});
  fmt::print("shares that go with a light when it alone is dark:\n{}\n", services.text());
}

int run_solve(const SolveArguments& arguments) {
  const auto start = std::chrono::steady_clock::now();
  // First of all: a thread started earlier (the ray tracer's) would take the signal, and the process would end.
  const std::stop_token stop = stop_on_signals();
  const auto session = open_session(arguments.rig);
  if (!session) return report(session.error());
  tell_calibration(session->rig);
  ComputeOptions compute = arguments.compute;
  compute.watch.stop = stop;
  TerminalWatch terminal;
  compute.watch.tell = terminal.tell();
  ModelUsed used;
  const auto transport = compute_transport(*session, compute, {}, &used);
  if (!transport) return report(transport.error());
  auto solved = solve_tasks(*session, *transport, compute);
  if (!solved) return report(solved.error());
  if (solved->anew) used = *solved->anew;
  Plan* const plan = &solved->plan;
  if (stop.stop_requested()) fmt::print(stderr, "stopped: this is the best so far\n");
  plan->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  add_opening_light(*solved, session->rig);
  if (const std::string warning = used.warning(); !warning.empty())
    fmt::print(stderr, "luxrig: warning: {}\n", warning);
  const std::vector<Uniformity> even = uniformities_of(session->rig, *plan);
  std::string plan_json = with_uniformities(with_transport(to_json(*plan), used), even);
  if (arguments.explain) plan_json = with_reasons(plan_json, solved->reasons);
  if (arguments.output) {
    if (const auto written = write_file(*arguments.output, plan_json); !written) return report(written.error());
  }
  const bool as_exact_as_wanted = used.reached() || !compute.strict;
  const int exit_code = nothing_missed(*plan) && as_exact_as_wanted ? kExitOk : kExitFailed;
  if (arguments.json) {
    fmt::print("{}\n", plan_json);
    return exit_code;
  }
  std::vector<std::string> heads = {"point", ">goal lx", ">lux", ">± se", ">error", "goal", ">max lx", "why"};
  if (session->rig.daylight) heads.insert(heads.begin() + 4, ">daylight");
  const bool coloured = session->rig.colour_goals();
  if (coloured) heads.insert(heads.end() - 3, {">goal xy", ">xy"});
  Table points(std::move(heads));
  for (std::size_t i = 0; i < plan->points.size(); ++i) {
    const PlannedPoint& p = plan->points[i];
    const auto& max = session->rig.points[i].max_lx;
    std::vector<std::string> cells = {
        p.name,
        p.goal_lux ? fmt::format("{:g}", *p.goal_lux) : "-",
        fmt::format("{:.1f}", p.lux),
        fmt::format("{:.1f}", p.standard_error_lux),
        p.goal_lux && *p.goal_lux > 0 ? fmt::format("{:+.1f} %", 100 * (p.lux / *p.goal_lux - 1)) : "",
        p.verdict ? name_of(*p.verdict) : "",
        max ? fmt::format("{:g}", *max) : "",
        p.verdict ? p.reason : p.why};
    if (p.daylight_lux) cells.insert(cells.begin() + 4, fmt::format("{:.1f}", *p.daylight_lux));
    if (coloured) cells.insert(cells.end() - 3, {xy_text(p.goal_xy), xy_text(p.xy)});
    points.row(std::move(cells));
  }
  // Levels from the last task that sets fixtures, and each light that is to be hung.
  const auto last_levels = std::find_if(plan->tasks.rbegin(), plan->tasks.rend(), [](const PlannedTask& task) {
    return task.kind == name_of(TaskKind::emittance) || task.kind == name_of(TaskKind::aim);
  });
  for (const PlannedTask& task : plan->tasks)
    if (task.kind == name_of(TaskKind::aim)) print_aim(task);
  if (last_levels != plan->tasks.rend() && !last_levels->relief) print_levels(*last_levels);
  for (std::size_t t = 0; t < plan->tasks.size(); ++t) {
    const Task& task = session->rig.tasks[t];
    if (task.kind == TaskKind::directions) print_directions(plan->tasks[t], task.directions);
    if (!task.places_lights()) continue;
    const PlacementSpec& spec = task.placement;
    print_placed(plan->tasks[t], task,
                 task.kind == TaskKind::placement && !session->rig.luminaires[spec.luminaire].emitters.empty());
  }
  fmt::print("{}\n", points.text());
  for (const PlannedTask& task : plan->tasks) {
    if (task.relief) {
      if (task.directions.empty()) print_relief(session->rig, task);
      if (const ReliefReasons* reasons = reasons_of(*solved, task)) print_reasons(*reasons, arguments.explain);
      continue;
    }
    fmt::print("{} ({}): normalised error {:.2f} %{}, {} iterations, {:.1f} ms\n", task.name, task.kind,
               100 * task.normalised_error, task.watts ? fmt::format(", {:.1f} W", *task.watts) : "", task.iterations,
               1000 * task.seconds);
    if (!task.switches_proven)
      fmt::print(
          "which of the lamps that are on or off shall be on was not searched to the end: others could do better\n");
  }
  fmt::print("{}", opening_light_text(*plan, session->rig));
  for (const Uniformity& one : even) fmt::print("{}\n", text_of(one));
  const auto kept =
      std::count_if(plan->limits.begin(), plan->limits.end(), [](const auto& limit) { return limit.met; });
  fmt::print("by the model, were the rig as its file says: {} ({}){}; in {:.2f} s{}\n", text_of(goals_of(*plan)),
             tolerance_text(session->rig.goal_tolerances()),
             plan->limits.empty() ? "" : fmt::format(", {} of {} limits kept", kept, plan->limits.size()),
             plan->seconds, arguments.output ? ", plan in " + arguments.output->string() : "");
  return exit_code;
}

Action declare_solve(CLI::App& command) {
  const auto solve = std::make_shared<SolveArguments>();
  add_rig_option(command, solve->rig);
  command.add_option("-o,--output", solve->output, "write the plan here")->check(offers_files());
  add_model(command, solve->compute);
  command.add_flag("--explain", solve->explain,
                   "why an object is lit so, in two sentences, and what each of its lights serves (with --json and "
                   "in the plan, as \"explained\" of the task)");
  command.add_flag("--json", solve->json, "print the plan");
  return [solve] { return run_solve(*solve); };
}

}  // namespace

const Command kSolveCommand{"solve", command_group::kSet, "do what the rig's tasks ask, and write a plan",
                            declare_solve};

}  // namespace luxrig
