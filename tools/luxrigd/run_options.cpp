#include "tools/luxrigd/run_options.h"

#include <CLI/CLI.hpp>

#include "tools/command_line/completion.h"
#include "tools/command_line/installed.h"
#include "tools/luxrig/compute_arguments.h"

namespace luxrig {

void add_sim_options(CLI::App& app, SimArguments& sim, const char* what) {
  CLI::Option* starts = app.add_flag("--sim", sim.start, what);
  app.add_option("--sim-seed", sim.seed, "seed of the simulated rig's deviations")->needs(starts);
  app.add_option(
         "--sim-deviations", sim.deviations,
         "how far the simulated rig is from the rig file: mild as when new, real as found in halls, bad as real "
         "with wrong connections")
      ->check(CLI::IsMember({"mild", "real", "bad"}))
      ->needs(starts);
}

void add_run_options(CLI::App& app, RunArguments& arguments) {
  add_rig_option(app, arguments.rig);
  add_sim_options(app, arguments.sim, "start a simulated rig and send everything there instead of to the devices");
  app.add_option("--sim-ports", arguments.sim_ports, "use the running luxrig-sim that wrote this file")
      ->check(offers_files());
  app.add_option("--plan", arguments.plan, "apply this plan instead of solving")->check(offers_files());
  app.add_option(
         "--state", arguments.state_folder,
         "folder that remembers what is in force, and where the next start goes on from it: the plan, blackout, "
         "what rests, what is set by hand (default: ~/.local/state/luxrig/NAME, or under $XDG_STATE_HOME; none "
         "with --sim; --once and --plan write it, but do not go on from it)")
      ->check(offers_folders());
  app.add_flag("--fresh", arguments.fresh,
               "start from the rig file, as if nothing had been in force before; what was remembered is replaced");
  app.add_flag("--no-guardian", arguments.no_guardian,
               "no second process that takes the rig to its safe look if this one dies");
  app.add_option("--port", arguments.http_port, "port of the page, on loopback (0: any)")->check(CLI::Range(0, 65535));
  app.add_flag("--once", arguments.once,
               "light, measure, correct, then end: exit code 0 when no goal was missed and no limit exceeded");
  app.add_option("--json", arguments.json, "with --once: write the table here")->check(offers_files());
  app.add_option("--pictures", arguments.pictures,
                 "simulated only: the rig's cameras take pictures, into this folder, of the rig as it hangs and of the "
                 "plan; heads look where the rig file says first")
      ->check(offers_folders());
  add_compute(app, arguments.compute);
}

}  // namespace luxrig
