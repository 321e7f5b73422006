#pragma once
/// Run time against error, on named suites.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace luxrig {

struct BenchOptions {
  bool quick = false;                         ///< fewer and coarser runs, same columns, under a minute
  std::filesystem::path csv_file, plot_file;  ///< written unless empty
  std::filesystem::path report_file;          ///< Markdown that gets the rows (report.h), unless empty
  int threads = 0;                            ///< 0 = one per core
  std::filesystem::path references_folder;    ///< transport: converged references are kept here, by scene
  double reference_error = 0.0005;            ///< transport: standard error of converged references
  std::filesystem::path export_folder;        ///< transport: writes its rooms here for Radiance instead of
                                              ///< measuring; nnls: also writes its problems here for scipy;
                                              ///< highlight: only writes its made-up objects as OBJ
  std::vector<std::filesystem::path> rigs;    ///< transport: rig files whose scenes are measured too
  std::string method;                         ///< placement scenes and transport curves: only this one
  std::optional<int> seeds;                   ///< placement: rooms of each scene, instead of 100 (curves: 20); faults:
                                              ///< cases of each kind, instead of 100
  int first_seed = 1;                         ///< placement: first of them, so that a long run can be split
  bool bounds = true;                         ///< placement scenes: with certified bounds, which take longest
  std::optional<double> seconds;              ///< buses: length of each load, instead of its own
  std::filesystem::path data_folder;          ///< placement, highlight, goals: files to read
  std::string only;  ///< transport, nnls, highlight, buses, faults: only cases whose name begins so; analytic: only
                     ///< such families; placement: the part of this name
};

/// Names of the suites.
[[nodiscard]] std::vector<std::string> bench_suites();

/// Runs a suite and prints its table on stdout. Exit code: 0; 1 if a target was missed or a file could not be written;
/// 2 for an unknown suite (stderr names the known ones).
int run_bench(const std::string& suite, const BenchOptions& options);

}  // namespace luxrig
