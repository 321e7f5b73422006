// luxrig-bench: run time against error, on a named suite. `luxrig bench` runs it.
#include <CLI/CLI.hpp>
#include <string>

#include "tools/bench/bench.h"
#include "tools/command_line/choice.h"
#include "tools/command_line/completion.h"
#include "tools/command_line/parse_command_line.h"
#include "tools/command_line/version.h"

int main(int argc, char** argv) {
  using namespace luxrig;
  CLI::App command("run time against error, on a named suite", "luxrig-bench");
  begin_command_line(command);
  command.set_version_flag("--version", std::string("luxrig-bench ") + kVersion, "print version and commit");
  std::string suite;
  BenchOptions bench;
  command.add_option("SUITE", suite, "which")->required()->check(one_of(bench_suites()));
  command.add_flag("--quick", bench.quick, "under a minute, same columns");
  command.add_option("--csv", bench.csv_file, "write the rows here")->check(offers_files());
  command.add_option("--plot", bench.plot_file, "draw error over time here (PNG)")->check(offers_files());
  command.add_option("--report", bench.report_file, "put the rows into this Markdown file, with commit, machine, date")
      ->check(offers_files());
  command.add_option("--threads", bench.threads, "threads (0: one per core)")->check(CLI::Range(0, 1024));
  command.add_option("--references", bench.references_folder, "transport: keep converged references in this folder")
      ->check(offers_folders());
  command.add_option("--reference-error", bench.reference_error, "transport: standard error of those")
      ->check(CLI::Range(1e-5, 0.1));
  command
      .add_option("--export", bench.export_folder,
                  "transport: write the rooms here for Radiance, measure nothing; nnls: the problems; highlight: "
                  "its made-up objects")
      ->check(offers_folders());
  command.add_option("--rig", bench.rigs, "transport: measure this rig's scene too")->check(offers_files());
  command.add_option("--method", bench.method, "placement and transport: only this method on scenes");
  command
      .add_option("--seeds", bench.seeds,
                  "placement: rooms of each scene (default 100; for curves 20); faults: cases of each kind")
      ->check(CLI::Range(1, 10000));
  command
      .add_option("--first-seed", bench.first_seed,
                  "placement: the first of those rooms, so that a long run can be split")
      ->check(CLI::Range(1, 10000));
  command.add_flag("!--no-bounds", bench.bounds, "placement: without certified bounds");
  command.add_option("--seconds", bench.seconds, "buses: how long each load runs")->check(CLI::Range(1.0, 86400.0));
  command
      .add_option("--data", bench.data_folder,
                  "folder of files; placement: office-scan.obj (tools/bench/data), apartment.glb, which goals reads "
                  "too; highlight: "
                  "venus-bust.glb, skull.obj, teapot.glb, egyptian-cat.glb, chess-board.glb")
      ->check(offers_folders());
  command.add_option("--only", bench.only, "only cases (analytic: families) whose name begins so");
  if (const auto end = parse_command_line(command, argc, argv)) return *end;
  return run_bench(suite, bench);
}
