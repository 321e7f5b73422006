// luxrigd: `luxrig run` for service managers.
#include <CLI/CLI.hpp>
#include <iostream>

#include "tools/command_line/parse_command_line.h"
#include "tools/command_line/version.h"
#include "tools/luxrigd/api/openapi.h"
#include "tools/luxrigd/run_options.h"

int main(int argc, char** argv) {
  CLI::App app("lights a rig to its goals, measures, corrects and holds: `luxrig run` for service managers", "luxrigd");
  luxrig::begin_command_line(app);
  app.set_version_flag("--version", std::string("luxrigd ") + luxrig::kVersion, "print version and commit");
  app.add_flag_callback(
      "--openapi",
      [] {
        std::cout << luxrig::openapi_json();
        throw CLI::Success();
      },
      "print the HTTP API as an OpenAPI 3.1 file, and end");
  luxrig::RunArguments arguments;
  luxrig::add_run_options(app, arguments);
  if (const auto end = luxrig::parse_command_line(app, argc, argv)) return *end;
  return luxrig::run_rig(arguments);
}
