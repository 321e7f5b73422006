// luxrigd: `luxrig run` for service managers.
#include <CLI/CLI.hpp>

#include "tools/luxrig/command.h"
#include "tools/luxrigd/run_options.h"

int main(int argc, char** argv) {
  CLI::App app("Luxrig daemon: lights a rig to its goals, measures, corrects and holds");
  luxrig::RunArguments arguments;
  luxrig::add_run_options(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? luxrig::kExitOk : luxrig::kExitBadInput;
  }
  return luxrig::run_rig(arguments);
}
