#pragma once
/// The subcommands of luxrig, in one table: parsing, help, man pages and completion all come from it.

#include <functional>
#include <vector>

namespace CLI {
class App;
}

namespace luxrig {

/// Runs a command whose line has been parsed; returns the exit code.
using Action = std::function<int()>;

struct Command {
  const char* name;
  const char* group;                     ///< one of those below
  const char* summary;                   ///< its line in `luxrig --help`, up to 66 letters
  Action (*declare)(CLI::App& command);  ///< adds its options; the action keeps what they set
  /// Program beside this one that does it all: it gets the words after the name, and nothing is declared.
  const char* program = nullptr;
};

/// Purpose of a command: help, man page and README sort the commands by it.
namespace command_group {
inline constexpr char kSet[] = "Set a rig";
inline constexpr char kRun[] = "Run a show";
inline constexpr char kDevices[] = "Devices";
inline constexpr char kMeasure[] = "Measure";
inline constexpr char kShell[] = "Shell";
}  // namespace command_group

/// By group, and within a group in the order in which a person needs them.
[[nodiscard]] const std::vector<Command>& command_table();

}  // namespace luxrig
