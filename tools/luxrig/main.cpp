// luxrig: walks the table of subcommands.
#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "tools/command_line/parse_command_line.h"
#include "tools/command_line/version.h"
#include "tools/luxrig/command_table.h"

int main(int argc, char** argv) {
  CLI::App app("sets a lighting rig to goals in lux, measures and corrects it", "luxrig");
  luxrig::begin_command_line(app);
  app.set_version_flag("--version", std::string("luxrig ") + luxrig::kVersion, "print version and commit");
  app.require_subcommand(1);
  std::map<const CLI::App*, luxrig::Action> actions;
  for (const luxrig::Command& command : luxrig::command_table()) {
    CLI::App* one = app.add_subcommand(command.name, command.summary)->group(command.group);
    actions[one] = command.declare(*one);
  }
  // After the commands, because they would inherit it.
  app.footer(
      "`luxrig COMMAND --help` tells a command's options; so does `man luxrig-COMMAND`.\n"
      "New here? `luxrig init mine` makes a rig, `luxrig run mine --sim` lights it on\n"
      "simulated devices.");
  if (const auto end = luxrig::parse_command_line(app, argc, argv)) return *end;
  return actions.at(app.get_subcommands().front())();
}
