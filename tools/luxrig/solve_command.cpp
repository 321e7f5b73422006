#include <fmt/format.h>

#include <chrono>

#include "tools/luxrig/command.h"
#include "tools/luxrig/commands.h"
#include "tools/luxrig/table.h"

namespace luxrig {

int run_solve(const SolveArguments& arguments) {
  const auto start = std::chrono::steady_clock::now();
  const auto session = open_session(arguments.rig);
  if (!session) return report(session.error());
  ComputeOptions compute = arguments.compute;
  compute.watch = {stop_on_signals(), progress_line("transport")};
  const auto transport = compute_transport(*session, compute);
  if (!transport) return report(transport.error());
  compute.watch.progress = nullptr;
  auto plan = solve_tasks(*session, *transport, compute);
  if (!plan) return report(plan.error());
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
  Table lights({"fixture", "luminaire", ">level", ">lumens"});
  for (const PlannedLight& light : plan->tasks.empty() ? std::vector<PlannedLight>{} : plan->tasks.back().lights) {
    lights.row(
        {light.name, light.luminaire, fmt::format("{:.1f} %", 100 * light.level), fmt::format("{:.0f}", light.lumens)});
  }
  std::vector<std::string> heads = {"point", ">goal lx", ">lux", ">± se", ">error", ">max lx", "why"};
  if (session->rig.daylight) heads.insert(heads.begin() + 4, ">daylight");
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
    points.row(std::move(cells));
  }
  fmt::print("{}\n{}\n", lights.text(), points.text());
  for (const PlannedTask& task : plan->tasks) {
    fmt::print("{} ({}): normalised error {:.2f} %, {} iterations, {:.1f} ms\n", task.name, task.kind,
               100 * task.normalised_error, task.iterations, 1000 * task.seconds);
  }
  fmt::print("{} in {:.2f} s{}\n", met ? "every goal met" : "not every goal can be met: see why", plan->seconds,
             arguments.output ? ", plan in " + arguments.output->string() : "");
  return kExitOk;
}

}  // namespace luxrig
