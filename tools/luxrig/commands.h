#pragma once
/// One function per subcommand; each returns the exit code. `render` is in render_command.h, `bench` in tools/bench.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/tasks/session.h"

namespace luxrig {

struct CheckArguments {
  std::filesystem::path rig;
  bool json = false;
  bool outputs = false;  ///< also what each output does when data stops
};
int run_check(const CheckArguments& arguments);

/// A commented rig to start from, in that folder; never writes over a rig.
int run_init(const std::filesystem::path& folder);

/// Makes a rig folder of an MVR file; never writes over a rig.
struct ImportArguments {
  std::filesystem::path file;
  std::filesystem::path rig_folder;
};
int run_import(const ImportArguments& arguments);

struct EvaluateArguments {
  std::filesystem::path rig;
  std::optional<std::filesystem::path> levels_plan;  ///< else every fixture at 1
  ComputeOptions compute;
  bool json = false;
};
int run_evaluate(const EvaluateArguments& arguments);

struct SolveArguments {
  std::filesystem::path rig;
  std::optional<std::filesystem::path> output;
  ComputeOptions compute;
  bool json = false;
};
int run_solve(const SolveArguments& arguments);

/// Looks for what is there to be driven (drivers/scan).
struct DevicesArguments {
  double seconds = 3;
  std::string broadcast = "255.255.255.255", interface;
  bool json = false;
};
int run_devices(const DevicesArguments& arguments);

/// Devices on the DMX lines behind Art-Net nodes or a USB widget, by RDM.
struct RdmArguments {
  std::string node;  ///< address, with or without port; empty: all that answer to the broadcast
  std::string broadcast = "255.255.255.255";
  std::optional<int> universe;  ///< Art-Net port address; else all
  double seconds = 3;
  bool rediscover = false;
  bool usb = false;                         ///< a widget's line instead of nodes
  std::string usb_serial, usb_port, usbip;  ///< which; any of them is enough to say `usb`
  bool json = false, toml = false;
  std::string uid, parameter, value;
};
int run_rdm_list(const RdmArguments& arguments);
int run_rdm_get(const RdmArguments& arguments);
int run_rdm_set(const RdmArguments& arguments);

/// Talks to a running daemon on loopback.
struct ClientArguments {
  int port = 9620;
  bool json = false;
  std::optional<std::filesystem::path> token;  ///< of a daemon of another user, by the port
};
/// Prints an address that opens the page in one browser.
int run_page(const ClientArguments& arguments);
int run_status(const ClientArguments& arguments);
int run_blackout(const ClientArguments& arguments, bool on);
int run_hand_back(const ClientArguments& arguments);
/// None named: all heads that have a place to rest.
int run_park(const ClientArguments& arguments, const std::vector<std::string>& fixtures);
int run_identify(const ClientArguments& arguments, const std::string& fixture, double seconds);
/// Holds a level or a goal by hand: names (with * and ? for several), then the value; for_text: "10min", empty: until
/// it is released.
int run_level(const ClientArguments& arguments, const std::vector<std::string>& names_and_level,
              const std::string& for_text);
int run_goal(const ClientArguments& arguments, const std::vector<std::string>& names_and_lux,
             const std::string& for_text);
/// Fixtures and points, or "all".
int run_release(const ClientArguments& arguments, const std::vector<std::string>& names);
/// Fixtures and luxmeters that have failed: done without, or taken back; prints the risk.
int run_bypass(const ClientArguments& arguments, const std::vector<std::string>& names, bool undo);
int run_reload(const ClientArguments& arguments);
/// "90s", "10min", "2h", "90" (seconds) in seconds; nothing when it is none, or not above 0.
[[nodiscard]] std::optional<double> seconds_of(const std::string& text);
/// Until Ctrl-C; `once`, or when the output is no terminal: one picture.
int run_monitor(const ClientArguments& arguments, bool once);
int run_apply(const ClientArguments& arguments, const std::filesystem::path& plan);

/// Writes text to a file so that a reader, or the start after a power cut, sees the old content or the new, never half.
/// A fault when it cannot, or when the new content is there but a power cut may bring the old one back.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& path, const std::string& text);
/// What was made, renamed or removed in the folder outlives a power cut; else false, and errno says why.
[[nodiscard]] bool sync_folder(const std::filesystem::path& folder);
/// Reads a file of at most 64 MiB.
[[nodiscard]] Checked<std::string> read_file(const std::filesystem::path& path);

}  // namespace luxrig
