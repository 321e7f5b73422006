#pragma once
/// The command-line options of `luxrig run` and luxrigd, defined once.

#include "tools/luxrigd/run.h"

namespace CLI {
class App;
}

namespace luxrig {
void add_run_options(CLI::App& app, RunArguments& arguments);
}
