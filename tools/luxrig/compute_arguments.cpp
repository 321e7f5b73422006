#include "tools/luxrig/compute_arguments.h"

#include "tools/command_line/choice.h"

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

void add_model(CLI::App& command, ComputeOptions& compute) {
  add_choice<Model, Model>(
      command, "--model", compute.model,
      "how light is computed; auto: the cheapest that meets the error; direct: no interreflection",
      {{"auto", Model::automatic}, {"direct", Model::direct}, {"gather", Model::gather}, {"path", Model::path}},
      {{"cache", "is refused, as its error bars were too short to be believed: use gather or path"}});
  command.add_flag("--strict", compute.strict, "exit code 1 when the wanted error is not reached (else a warning)");
  add_compute(command, compute);
}

}  // namespace luxrig
