#pragma once
/// The command-line options of `luxrig run` and luxrigd, defined once.

#include "tools/luxrigd/run.h"

namespace CLI {
class App;
}

namespace luxrig {
/// --sim, --sim-seed, --sim-deviations. what: --sim in words.
void add_sim_options(CLI::App& app, SimArguments& sim, const char* what);
void add_run_options(CLI::App& app, RunArguments& arguments);
}
