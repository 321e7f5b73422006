// run: the daemon in the foreground (tools/luxrigd/run.cpp).
#include <CLI/CLI.hpp>
#include <memory>

#include "tools/luxrig/commands.h"
#include "tools/luxrigd/run_options.h"

namespace luxrig {
namespace {

Action declare_run(CLI::App& command) {
  const auto run = std::make_shared<RunArguments>();
  add_run_options(command, *run);
  return [run] { return run_rig(*run); };
}

}  // namespace

const Command kRunCommand{"run", command_group::kRun, "light, measure, correct, hold: the daemon in the foreground",
                          declare_run};

}  // namespace luxrig
