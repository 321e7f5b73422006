#include "tools/luxrig/compute_arguments.h"

namespace luxrig {

void add_compute(CLI::App& command, ComputeOptions& compute) {
  CLI::Option* of_all =
      command
          .add_option(
              "--max-error", compute.max_error,
              "wanted error of the points' light: root mean square of their standard errors, as a share of each "
              "point's lux; hard ones keep more, easy ones less")
          ->capture_default_str()
          ->check(CLI::Range(1e-4, 1.0));
  command
      .add_option(
          "--worst-error", compute.worst_error,
          "wanted error of every point by itself, in place of --max-error: kept at 98 points of 100, for several "
          "times the work")
      ->check(CLI::Range(1e-4, 1.0))
      ->excludes(of_all);
  command
      .add_option("--error-floor", compute.error_floor_lx,
                  "standard error in lux that is small enough at any point (else that share of a tenth of the rig's "
                  "smallest goal or limit; without any, of a tenth of the points' mean)")
      ->check(CLI::Range(1e-9, 1e9));
  command
      .add_option("--max-seconds", compute.max_seconds,
                  "after so long light is taken as it is known by then, with a warning (0: no end)")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e9));
  command.add_option("--seed", compute.seed, "seed of the samples");
  command.add_option("--threads", compute.threads, "threads (0: one per core)")->check(CLI::Range(0, 1024));
}

}  // namespace luxrig
