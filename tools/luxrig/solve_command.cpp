#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "tools/luxrig/command.h"
#include "tools/luxrig/commands.h"
#include "tools/luxrig/solve_tasks.h"
#include "tools/luxrig/table.h"

namespace luxrig {
namespace {

std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }

std::string watts_text(const std::optional<double>& watts) { return watts ? fmt::format("{:.1f}", *watts) : "-"; }

std::string xy_text(const std::optional<Chromaticity>& xy) {
  return xy ? fmt::format("{:.4f} {:.4f}", xy->x(), xy->y()) : "-";
}

/// What the last task to set fixtures has set them to.
void print_levels(const PlannedTask& task) {
  Table lights({"fixture", "luminaire", ">level", ">lumens", ">watts"});
  for (const PlannedLight& light : task.lights)
    lights.row({light.name, light.luminaire, percent(light.level), fmt::format("{:.0f}", light.lumens),
                watts_text(light.watts)});
  fmt::print("{}\n", lights.text());
}

void print_placement(const PlannedTask& task, const PlacementSpec& spec, bool has_emitters) {
  if (task.lights.empty()) {
    fmt::print("{}: every goal is met without a further light\n\n", task.name);
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
  if (!spec.lights) {
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

}  // namespace

int run_solve(const SolveArguments& arguments) {
  const auto start = std::chrono::steady_clock::now();
  // First of all: a thread that there is before (the ray tracer's) would take the signal, and the process would end.
  const std::stop_token stop = stop_on_signals();
  const auto session = open_session(arguments.rig);
  if (!session) return report(session.error());
  ComputeOptions compute = arguments.compute;
  compute.watch = {stop, progress_line("transport")};
  const auto transport = compute_transport(*session, compute);
  if (!transport) return report(transport.error());
  compute.watch.progress = nullptr;
  auto plan = solve_tasks(*session, *transport, compute);
  if (!plan) return report(plan.error());
  if (stop.stop_requested()) fmt::print(stderr, "stopped: this is the best so far\n");
  plan->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  if (arguments.output) {
    if (const auto written = write_file(*arguments.output, to_json(*plan)); !written) return report(written.error());
  }
  bool met = true;
  for (const PlannedLimit& limit : plan->limits) met = met && limit.met;
  for (const PlannedPoint& point : plan->points) met = met && point.why.empty();
  if (arguments.json) {
    fmt::print("{}\n", to_json(*plan));
    return kExitOk;
  }
  std::vector<std::string> heads = {"point", ">goal lx", ">lux", ">± se", ">error", ">max lx", "why"};
  if (session->rig.daylight) heads.insert(heads.begin() + 4, ">daylight");
  const bool coloured = session->rig.colour_goals();
  if (coloured) heads.insert(heads.end() - 2, {">goal xy", ">xy"});
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
        max ? fmt::format("{:g}", *max) : "",
        p.why};
    if (p.daylight_lux) cells.insert(cells.begin() + 4, fmt::format("{:.1f}", *p.daylight_lux));
    if (coloured) cells.insert(cells.end() - 2, {xy_text(p.goal_xy), xy_text(p.xy)});
    points.row(std::move(cells));
  }
  const auto last_levels = std::find_if(plan->tasks.rbegin(), plan->tasks.rend(),
                                        [](const PlannedTask& task) { return task.kind == "emittance"; });
  if (last_levels != plan->tasks.rend()) print_levels(*last_levels);
  for (std::size_t t = 0; t < plan->tasks.size(); ++t)
    if (plan->tasks[t].kind == "placement") {
      const PlacementSpec& spec = session->rig.tasks[t].placement;
      print_placement(plan->tasks[t], spec, !session->rig.luminaires[spec.luminaire].emitters.empty());
    }
  fmt::print("{}\n", points.text());
  for (const PlannedTask& task : plan->tasks) {
    fmt::print("{} ({}): normalised error {:.2f} %{}, {} iterations, {:.1f} ms\n", task.name, task.kind,
               100 * task.normalised_error, task.watts ? fmt::format(", {:.1f} W", *task.watts) : "", task.iterations,
               1000 * task.seconds);
  }
  fmt::print("{} in {:.2f} s{}\n", met ? "every goal met" : "not every goal can be met: see why", plan->seconds,
             arguments.output ? ", plan in " + arguments.output->string() : "");
  return kExitOk;
}

}  // namespace luxrig
