// luxrig: walks the table of subcommands.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/command_line/parse_command_line.h"
#include "tools/command_line/version.h"
#include "tools/luxrig/command_table.h"
#include "tools/terminal/command.h"

namespace {

/// The command's program takes over; returns only if there is none.
int become(const char* program, std::span<char*> words, bool complete) {
  std::error_code error;
  std::string path = std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / program;
  std::string complete_option = "--complete";
  std::vector<char*> argv = {path.data()};
  if (complete) argv.push_back(complete_option.data());
  argv.insert(argv.end(), words.begin(), words.end());
  argv.push_back(nullptr);
  ::execv(argv[0], argv.data());
  fmt::print(stderr, "{}: not there: in the sources, `cmake --build --preset release --target {}` builds it\n", path,
             program);
  return luxrig::kExitFailed;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("sets a lighting rig to goals in lux, measures and corrects it", "luxrig");
  luxrig::begin_command_line(app);
  app.set_version_flag("--version", std::string("luxrig ") + luxrig::kVersion, "print version and commit");
  app.require_subcommand(1);
  std::map<const CLI::App*, luxrig::Action> actions;
  const std::span words(argv, static_cast<std::size_t>(argc));
  const std::size_t first = argc > 2 && std::string_view(argv[1]) == "--complete" ? 2 : 1;
  for (const luxrig::Command& command : luxrig::command_table()) {
    if (command.program != nullptr) {
      if (first < words.size() && std::string_view(words[first]) == command.name)
        return become(command.program, words.subspan(first + 1), first == 2);
      app.add_subcommand(command.name, command.summary)->group(command.group)->set_help_flag();
      continue;
    }
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
