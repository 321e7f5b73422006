// luxrig-test: scenarios of a rig on the simulated rig. `luxrig test` runs it.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <thread>

#include "core/rig/rig_file.h"
#include "tools/command_line/completion.h"
#include "tools/command_line/installed.h"
#include "tools/command_line/parse_command_line.h"
#include "tools/command_line/version.h"
#include "tools/process/files.h"
#include "tools/scenario/explore.h"
#include "tools/scenario/jobs.h"
#include "tools/scenario/live_show.h"
#include "tools/scenario/outcome_text.h"
#include "tools/scenario/scenario_file.h"
#include "tools/scenario/stepped_show.h"
#include "tools/terminal/command.h"
#include "tools/terminal/terminal_watch.h"

namespace {

using namespace luxrig;
using namespace luxrig::scenario;
using Clock = std::chrono::steady_clock;

struct Options {
  std::filesystem::path rig;
  std::vector<std::filesystem::path> scenarios;
  std::string seeds, junit, json, trace;
  std::filesystem::path results = "test-results";
  int jobs = 0;
  bool explores = false, in_real_time = false;
  ExploreOptions explore;
  PrepareOptions prepare;
};

std::vector<Problem> problem(const std::filesystem::path& file, std::string what, std::string mend) {
  return {{file.string(), 0, 0, std::move(what), std::move(mend)}};
}

/// The given files; else those in the folder `tests` beside the rig file.
Checked<std::vector<std::filesystem::path>> scenario_files(const Options& options, const Rig& rig) {
  if (!options.scenarios.empty()) return options.scenarios;
  const std::filesystem::path folder = rig.file.parent_path() / "tests";
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty())
    return tl::unexpected(problem(folder, "no scenario is there", "write one (rigs/REFERENCE.md), or name a file"));
  return files;
}

Checked<std::vector<Scenario>> read_scenarios(const Options& options, const Rig& rig) {
  const auto files = scenario_files(options, rig);
  if (!files) return tl::unexpected(files.error());
  std::vector<Scenario> scenarios;
  std::vector<Problem> problems;
  for (const std::filesystem::path& file : *files) {
    auto text = read_file(file);
    auto scenario = text ? parse_scenario(*text, file, rig) : Checked<Scenario>(tl::unexpected(text.error()));
    if (!scenario) {
      problems.insert(problems.end(), scenario.error().begin(), scenario.error().end());
      continue;
    }
    if (!options.seeds.empty()) scenario->seeds = parse_seeds(options.seeds);
    scenarios.push_back(std::move(*scenario));
  }
  if (!problems.empty()) return tl::unexpected(std::move(problems));
  return scenarios;
}

/// What one expectation or rule came to over all seeds.
struct Summary {
  int failed = 0;
  const Outcome* first = nullptr;  ///< of those that failed, with the lowest seed
  const Judged* judged = nullptr;
};

Summary summary_of(const std::vector<Outcome>& outcomes, std::vector<Judged> Outcome::*list, std::size_t index) {
  Summary summary;
  for (const Outcome& outcome : outcomes) {
    if (index >= (outcome.*list).size()) continue;
    const Judged& judged = (outcome.*list)[index];
    if (judged.held) continue;
    ++summary.failed;
    if (summary.first == nullptr) {
      summary.first = &outcome;
      summary.judged = &judged;
    }
  }
  return summary;
}

void print_failed(const Summary& summary, std::size_t runs) {
  const Judged& judged = *summary.judged;
  fmt::print("  FAIL  {}\n", judged.expected);
  fmt::print("        {}{}{}\n", judged.line > 0 ? fmt::format("line {}, ", judged.line) : "",
             runs > 1 ? fmt::format("{} of {} seeds; seed {} ", summary.failed, runs, summary.first->seed) : "",
             judged.at_s ? fmt::format("at {:.2f} s: {}", *judged.at_s, judged.found) : judged.found);
  if (!judged.why.empty()) fmt::print("        {}\n", judged.why);
  // What happened just before.
  const auto& events = summary.first->events;
  std::vector<std::string> before;
  for (auto event = events.rbegin(); event != events.rend() && before.size() < 3; ++event)
    if (!judged.at_s || event->at_s <= *judged.at_s)
      before.push_back(fmt::format("{:.2f} s {}", event->at_s, event->text));
  std::reverse(before.begin(), before.end());
  if (!before.empty()) fmt::print("        before it: {}\n", fmt::join(before, "; "));
}

/// The seed with the most failures; the lowest of several.
const Outcome* worst_of(const std::vector<Outcome>& outcomes) {
  const Outcome* worst = nullptr;
  std::ptrdiff_t most = 0;
  for (const Outcome& outcome : outcomes) {
    const auto failures = [](const std::vector<Judged>& all) {
      return std::count_if(all.begin(), all.end(), [](const Judged& one) { return !one.held; });
    };
    const auto count = failures(outcome.expectations) + failures(outcome.rules) + (outcome.error.empty() ? 0 : 1);
    if (count > most) {
      most = count;
      worst = &outcome;
    }
  }
  return worst;
}

/// True if all passed.
bool print(const Tested& tested) {
  const std::vector<Outcome>& outcomes = tested.outcomes;
  bool passed = true;
  fmt::print("{}: {}\n", tested.scenario.file.string(), tested.scenario.name);
  for (const Outcome& outcome : outcomes) {
    if (outcome.error.empty()) continue;
    fmt::print("  FAIL  seed {}: {}\n", outcome.seed, outcome.error);
    passed = false;
    break;
  }
  for (std::size_t e = 0; e < tested.scenario.expectations.size(); ++e) {
    const Summary summary = summary_of(outcomes, &Outcome::expectations, e);
    if (summary.failed > 0)
      print_failed(summary, outcomes.size());
    else if (passed)
      fmt::print("  ok    {}\n", tested.scenario.expectations[e].text());
    passed = passed && summary.failed == 0;
  }
  std::size_t rules = 0;
  for (const Outcome& outcome : outcomes) rules = std::max(rules, outcome.rules.size());
  bool all_rules = rules > 0;
  for (std::size_t r = 0; r < rules; ++r) {
    const Summary summary = summary_of(outcomes, &Outcome::rules, r);
    if (summary.failed == 0) continue;
    print_failed(summary, outcomes.size());
    all_rules = passed = false;
  }
  if (all_rules) fmt::print("  ok    the {} rules that always hold\n", rules);
  return passed;
}

Result<void> write_report(const std::filesystem::path& file, const Scenario& scenario, const Outcome& outcome) {
  return write_file(file, file.extension() == ".csv" ? trace_csv(outcome.trace) : trace_html(scenario, outcome));
}

std::string quoted_for_shell(const std::string& word) {
  return word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./") ==
                 std::string::npos
             ? word
             : "'" + word + "'";
}

int jobs_of(const Options& options) {
  if (options.in_real_time && options.jobs == 0) return 1;
  return options.jobs > 0 ? options.jobs : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

Checked<PreparedRig> prepared_rig(const Options& options) {
  // The watch's thread ends with it, before processes are forked.
  TerminalWatch watch;
  PrepareOptions with_watch = options.prepare;
  with_watch.compute.watch.tell = watch.tell();
  return prepare(options.rig, with_watch);
}

int explore_rig(const Options& options) {
  const auto prepared = prepared_rig(options);
  if (!prepared) return report(prepared.error());
  ExploreOptions explore_options = options.explore;
  explore_options.jobs = jobs_of(options);
  auto told = Clock::now();
  const Explored explored = explore(*prepared, explore_options, [&](const Explored& so_far) {
    if (Clock::now() - told < std::chrono::seconds(10)) return;
    told = Clock::now();
    fmt::print(stderr, "luxrig-test: {} shows, {} of the rules broken\n", so_far.shows, so_far.findings.size());
  });
  for (const Finding& finding : explored.findings) {
    const auto file = options.results / finding.scenario.file;
    std::error_code ignored;
    std::filesystem::create_directories(options.results, ignored);
    if (const auto written = write_file(file, to_toml(finding.scenario)); !written) return report(written.error());
    fmt::print("  FAIL  {}\n", finding.rule);
    for (const Judged& judged : finding.outcome.rules)
      if (!judged.held && judged.expected == finding.rule)
        fmt::print("        at {:.2f} s: {}\n", judged.at_s.value_or(0), judged.found);
    if (!finding.outcome.error.empty()) fmt::print("        {}\n", finding.outcome.error);
    fmt::print("        {} event{}: {}\n        again: luxrig test {} {}\n", finding.scenario.events.size(),
               finding.scenario.events.size() == 1 ? "" : "s", file.string(), quoted_for_shell(options.rig.string()),
               quoted_for_shell(file.string()));
  }
  fmt::print("{}: {} random shows of {:g} s, {} of the rules broken\n", prepared->session->rig.name, explored.shows,
             explore_options.length_s, explored.findings.size());
  return explored.findings.empty() ? kExitOk : kExitFailed;
}

Outcome run(const PreparedRig& prepared, const Scenario& scenario, std::uint64_t seed, const ShowOptions& show,
            const Options& options) {
  // A run in real time ends its daemon and guardian before this process ends.
  return options.in_real_time ? run_live(prepared, scenario, seed, show, stop_on_signals())
                              : run_stepped(prepared, scenario, seed, show);
}

void say_how_long(const std::vector<Scenario>& scenarios, int jobs) {
  double length_s = 0;
  std::size_t shows = 0;
  for (const Scenario& scenario : scenarios) {
    shows += scenario.seeds.size();
    length_s += scenario.length_s * std::ceil(static_cast<double>(scenario.seeds.size()) / jobs);
  }
  fmt::print(stderr, "luxrig-test: {} show{} in real time: {}\n", shows, shows == 1 ? "" : "s",
             length_s < 120 ? fmt::format("{:.0f} s", length_s) : fmt::format("{:.0f} minutes", length_s / 60));
}

int test(const Options& options) {
  const auto begun = Clock::now();
  if (options.explores && options.in_real_time)
    return report(problem("--explore", "needs thousands of shows, and --real-time takes as long as each of them",
                          "leave one of them out"));
  if (!options.seeds.empty() && parse_seeds(options.seeds).empty())
    return report(problem("--seeds", "cannot be " + options.seeds, "write 7, 1..20 or 1,5,9..12"));
  // Scenarios are checked before light is computed.
  const auto rig = load_rig(options.rig);
  if (!rig) return report(rig.error());
  const auto scenarios = read_scenarios(options, *rig);
  if (!scenarios) return report(scenarios.error());
  const auto prepared = prepared_rig(options);
  if (!prepared) return report(prepared.error());
  const Rig& in = prepared->session->rig;

  const int jobs = jobs_of(options);
  if (options.in_real_time) say_how_long(*scenarios, jobs);
  std::vector<Tested> tested;
  std::size_t runs = 0;
  bool passed = true;
  const bool terminal = ::isatty(STDERR_FILENO) != 0;
  for (const Scenario& scenario : *scenarios) {
    ShowOptions show;
    show.trace = options.in_real_time || (!options.trace.empty() && scenario.seeds.size() == 1);
    auto told = Clock::now();
    auto outcomes = run_all(
        scenario.seeds.size(), jobs,
        [&](std::size_t i) { return run(*prepared, scenario, scenario.seeds[i], show, options); },
        [&](std::size_t done) {
          if (Clock::now() - told < std::chrono::seconds(terminal ? 1 : 10)) return;
          told = Clock::now();
          fmt::print(stderr, "luxrig-test: {}: {} of {} seeds\n", scenario.file.filename().string(), done,
                     scenario.seeds.size());
        });
    runs += outcomes.size();
    tested.push_back({scenario, std::move(outcomes)});
    const bool held = print(tested.back());
    const Outcome* worst = worst_of(tested.back().outcomes);
    std::optional<Outcome> again;
    // The same run once more, with its values: the same bytes, as everything is stepped.
    if (worst != nullptr && worst->error.empty() && !options.in_real_time)
      again = run_stepped(*prepared, scenario, worst->seed, {true});
    const Outcome* shown = again ? &*again : worst != nullptr ? worst : &tested.back().outcomes.front();
    if (!held && worst != nullptr) {
      const auto page = options.results / fmt::format("{}-seed-{}.html", scenario.file.stem().string(), worst->seed);
      std::error_code ignored;
      std::filesystem::create_directories(options.results, ignored);
      if (const auto written = write_report(page, scenario, *shown); !written) return report(written.error());
      fmt::print("        what happened: {}\n        again: luxrig test {} {} --seeds {}{}\n", page.string(),
                 quoted_for_shell(options.rig.string()), quoted_for_shell(scenario.file.string()), worst->seed,
                 options.in_real_time ? " --real-time" : "");
    }
    const bool asked = scenario.seeds.size() == 1 || worst != nullptr;
    if (!options.trace.empty() && (again || (show.trace && asked)))
      if (const auto written = write_report(options.trace, scenario, *shown); !written) return report(written.error());
    passed = passed && held;
    if (options.in_real_time && options.trace.empty())  // it was for the page
      for (Outcome& outcome : tested.back().outcomes) outcome.trace = {};
  }
  const auto failed =
      std::count_if(tested.begin(), tested.end(), [](const Tested& one) { return worst_of(one.outcomes) != nullptr; });
  fmt::print("{}: {} of {} scenario{} passed, {} run{}, {:.1f} s\n", in.name,
             tested.size() - static_cast<std::size_t>(failed), tested.size(), tested.size() == 1 ? "" : "s", runs,
             runs == 1 ? "" : "s", std::chrono::duration<double>(Clock::now() - begun).count());
  if (!options.json.empty())
    if (const auto written = write_file(options.json, results_json(in.name, tested)); !written)
      return report(written.error());
  if (!options.junit.empty())
    if (const auto written = write_file(options.junit, junit_xml(in.name, tested)); !written)
      return report(written.error());
  return passed ? kExitOk : kExitFailed;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("runs a rig's scenarios on the simulated rig: faults, commands, and what is expected", "luxrig-test");
  begin_command_line(app);
  app.set_version_flag("--version", std::string("luxrig-test ") + kVersion, "print version and commit");
  add_rig_option(app, options.rig);
  app.add_option("SCENARIO", options.scenarios, "scenario files (else all in the folder `tests` of the rig)")
      ->check(offers_files());
  app.add_option("--seeds", options.seeds, "instead of those of the files: 7, 1..20 or 1,5,9..12");
  app.add_flag("--real-time", options.in_real_time,
               "run luxrigd itself, over the wire, as long as the show takes; faults of the wire act");
  app.add_option("--jobs", options.jobs, "processes (0: one per core; in real time one)")->check(CLI::Range(0, 256));
  app.add_option("--json", options.json, "write all results here")->check(offers_files());
  app.add_option("--junit", options.junit, "write the results here, as CI systems read them")->check(offers_files());
  app.add_option("--trace", options.trace,
                 "write the values over time here: of the only seed, or of the worst that failed (.csv; else a page)")
      ->check(offers_files());
  app.add_option("--results", options.results, "folder for a page about each scenario that failed")
      ->check(offers_folders());
  app.add_flag("--explore", options.explores, "look for shows that break a rule: random faults and commands");
  app.add_option("--minutes", options.explore.minutes, "explore: how long")->check(CLI::Range(0.01, 10000.0));
  app.add_option("--first-show", options.explore.seed, "explore: number of the first random show");
  app.add_option("--shows", options.explore.max_shows, "explore: end after so many");
  app.add_option("--length", options.explore.length_s, "explore: seconds of each show")
      ->check(CLI::Range(10.0, 36000.0));
  app.add_option("--max-error", options.prepare.max_truth_error, "relative error of the true reflected light")
      ->check(CLI::Range(1e-4, 1.0));
  if (const auto end = parse_command_line(app, argc, argv)) return *end;
  return options.explores && !options.in_real_time ? explore_rig(options) : test(options);
}
