// completion: the shell script that completes luxrig's commands, options and their values.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "tools/command_line/choice.h"
#include "tools/command_line/completion.h"
#include "tools/luxrig/commands.h"
#include "tools/terminal/command.h"

namespace luxrig {
namespace {

Action declare_completion(CLI::App& command) {
  const auto shell = std::make_shared<std::optional<Shell>>();
  add_choice<std::optional<Shell>, Shell>(command, "SHELL", *shell, "for which shell", shells())->required();
  command.footer(
      "An installed Luxrig has it already. Else, for this session:\n"
      "  bash   source <(luxrig completion bash)\n"
      "  zsh    source <(luxrig completion zsh)\n"
      "  fish   luxrig completion fish | source");
  return [&command, shell] {
    fmt::print("{}", completion_script(command.get_parent()->get_name(), **shell));
    return kExitOk;
  };
}

}  // namespace

const Command kCompletionCommand{"completion", command_group::kShell,
                                 "print what bash, zsh or fish completes luxrig's words by", declare_completion};

}  // namespace luxrig
