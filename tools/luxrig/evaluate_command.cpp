// evaluate: lux at points and luxmeters.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/parallel.h"
#include "core/tasks/rig_transport.h"
#include "tools/command_line/completion.h"
#include "tools/command_line/installed.h"
#include "tools/luxrig/commands.h"
#include "tools/luxrig/compute_arguments.h"
#include "tools/luxrig/open_session.h"
#include "tools/luxrig/transport_json.h"
#include "tools/luxrig/uniformity_json.h"
#include "tools/luxrig/vector_json.h"
#include "tools/process/files.h"
#include "tools/terminal/command.h"
#include "tools/terminal/table.h"
#include "tools/terminal/terminal_watch.h"

namespace luxrig {
namespace {

struct EvaluateArguments {
  std::filesystem::path rig;
  std::optional<std::filesystem::path> levels_plan;  ///< none = every fixture at 1
  ComputeOptions compute;
  bool json = false;
};

/// The look of a plan, after its placed lights are hung; or as the rig hangs, with all levels 1.
Checked<HungPlan> look_to_evaluate(const EvaluateArguments& arguments, const Rig& rig) {
  if (!arguments.levels_plan) {
    HungPlan all_on{rig, hung_look(rig)};
    all_on.look.levels.assign(rig.fixtures.size(), 1.0);
    return all_on;
  }
  auto text = read_file(*arguments.levels_plan);
  if (!text) return tl::unexpected(std::move(text.error()));
  const auto plan = plan_from_json(*text, arguments.levels_plan->string());
  if (!plan) return tl::unexpected(plan.error());
  return hang_plan(*plan, rig, arguments.levels_plan->string());
}

int run_evaluate(const EvaluateArguments& arguments) {
  const auto start = std::chrono::steady_clock::now();
  const auto session = open_session(arguments.rig);
  if (!session) return report(session.error());
  tell_calibration(session->rig);
  const auto wanted = look_to_evaluate(arguments, session->rig);
  if (!wanted) return report(wanted.error());
  const Rig& rig = wanted->rig;
  const Look& look = wanted->look;

  ComputeOptions compute = arguments.compute;
  compute.watch.stop = stop_on_signals();
  TerminalWatch terminal;
  compute.watch.tell = terminal.tell();
  compute.stage = "evaluating";
  ModelUsed used;
  const auto transport = compute_transport(rig, *session->rays, compute, look, &used);
  if (!transport) return report(transport.error());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  const Eigen::VectorXd level = levels_with_daylight(
      *transport, Eigen::Map<const Eigen::VectorXd>(look.levels.data(), static_cast<Eigen::Index>(look.levels.size())));
  const Eigen::VectorXd lux = transport->lux(level);
  const Eigen::VectorXd direct = transport->direct_lux(level);
  const Eigen::VectorXd error = transport->standard_error_lux(level);
  const Eigen::VectorXd daylight_lx = daylight_lux(rig, *transport);
  nlohmann::json points = nlohmann::json::array();
  std::vector<std::string> heads = {"point", ">lux", ">± se", ">direct"};
  if (rig.daylight) heads.push_back(">daylight");
  heads.insert(heads.end(), {">goal lx", ">max lx"});
  Table table(std::move(heads));
  const auto add = [&](const std::string& name, const Vec3& position, const Vec3& normal, std::size_t index,
                       std::optional<double> goal, std::optional<double> max) {
    const auto i = static_cast<Eigen::Index>(index);
    nlohmann::json point = {{"name", name},  {"position", array_of(position)}, {"normal", array_of(normal)},
                            {"lux", lux[i]}, {"direct_lux", direct[i]},        {"standard_error_lux", error[i]}};
    if (rig.daylight) point["daylight_lux"] = daylight_lx[i];
    if (goal) point["goal_lux"] = *goal;
    if (max) point["max_lux"] = *max;
    points.push_back(std::move(point));
    std::vector<std::string> cells = {name, fmt::format("{:.2f}", lux[i]), fmt::format("{:.2f}", error[i]),
                                      fmt::format("{:.2f}", direct[i])};
    if (rig.daylight) cells.push_back(fmt::format("{:.2f}", daylight_lx[i]));
    cells.push_back(goal ? fmt::format("{:g}", *goal) : "");
    cells.push_back(max ? fmt::format("{:g}", *max) : "");
    table.row(std::move(cells));
  };
  for (std::size_t i = 0; i < rig.points.size(); ++i) {
    const Point& p = rig.points[i];
    add(p.name, p.position_world_m, p.normal_world, i, p.goal_lx, p.max_lx);
  }
  for (std::size_t m = 0; m < rig.luxmeters.size(); ++m) {
    const Luxmeter& meter = rig.luxmeters[m];
    add(meter.name, meter.position_world_m, meter.normal_world, rig.points.size() + m, {}, {});
  }
  std::vector<LuxEstimate> light;
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(rig.points.size()); ++i)
    light.push_back(estimate_of(lux[i], error[i]));
  const std::vector<Uniformity> even = uniformities(rig, light);
  const int threads = thread_count(compute.threads);
  if (arguments.json) {
    nlohmann::ordered_json out = transport_json(used);
    out["points"] = std::move(points);
    if (!even.empty()) out["uniformities"] = uniformities_json(even);
    out["rays"] = transport->rays;
    out["seconds"] = seconds;
    out["threads"] = threads;
    fmt::print("{}\n", out.dump(1));
  } else {
    fmt::print(
        "{}\n{} model ({}): standard error {:.2g} rms, {:.2g} at most (wanted {:g} {}{}), {} rays, {:.2f} s, "
        "{} threads\n",
        table.text(), used.name, used.reason, used.rms_error, used.relative_error, used.wanted,
        used.of_worst ? "of each point, with a margin" : "rms",
        used.error_floor_lx > 0 ? fmt::format(", or ± {:.2g} lx", used.error_floor_lx) : "", transport->rays, seconds,
        threads);
    for (const Uniformity& one : even) fmt::print("by the model, {}\n", text_of(one));
  }
  if (const std::string warning = used.warning(); !warning.empty())
    fmt::print(stderr, "luxrig: warning: {}\n", warning);
  return compute.strict && !used.reached() ? kExitFailed : kExitOk;
}

Action declare_evaluate(CLI::App& command) {
  const auto evaluate = std::make_shared<EvaluateArguments>();
  add_rig_option(command, evaluate->rig);
  command.add_option("--levels", evaluate->levels_plan, "levels of this plan (else every fixture at 100 %)")
      ->check(offers_files());
  add_model(command, evaluate->compute);
  command.add_flag("--json", evaluate->json, "print JSON");
  return [evaluate] { return run_evaluate(*evaluate); };
}

}  // namespace

const Command kEvaluateCommand{"evaluate", command_group::kSet, "lux at every measurement point and luxmeter",
                               declare_evaluate};

}  // namespace luxrig
