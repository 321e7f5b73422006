// monitor: output and readings of the running daemon, live in the terminal.
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <thread>

#include "tools/luxrig/commands.h"
#include "tools/luxrig/monitor_picture.h"
#include "tools/process/client.h"
#include "tools/process/meeting_place.h"
#include "tools/terminal/command.h"

namespace luxrig {
namespace {

constexpr auto kPicturePeriod = std::chrono::milliseconds(200);
constexpr int kUsualColumns = 100;

volatile std::sig_atomic_t g_interrupted = 0;

/// The terminal's alternate screen, without a cursor. Any orderly end of the program restores the normal screen.
class OtherScreen {
 public:
  OtherScreen() { fmt::print("\033[?1049h\033[?25l"); }
  ~OtherScreen() {
    fmt::print("\033[?25h\033[?1049l");
    std::fflush(stdout);
  }
  OtherScreen(const OtherScreen&) = delete;
  OtherScreen& operator=(const OtherScreen&) = delete;
};

struct TerminalSize {
  int columns = kUsualColumns, lines = 0;  ///< lines 0: not known, no limit
};
TerminalSize terminal_size() {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return {};
  return {size.ws_col, size.ws_row};
}

/// The first lines that fit. Each starts at the left and clears the rest of its line; long lines are cut.
std::string on_screen(const std::string& picture, int lines) {
  std::string text = "\033[H\033[?7l";
  int shown_lines = 0;
  for (std::size_t at = 0; at < picture.size() && (lines == 0 || shown_lines < lines - 1); ++shown_lines) {
    const std::size_t end = picture.find('\n', at);
    text += picture.substr(at, end - at) + "\033[K\r\n";
    at = end == std::string::npos ? picture.size() : end + 1;
  }
  return text + "\033[J\033[?7h";
}

/// Nothing if no daemon answers.
std::optional<std::string> fetched_picture(const HttpPeer& daemon) {
  const auto status = http_get(daemon, "/api/status");
  const auto universes = http_get(daemon, "/api/universes");
  if (!status || !universes || status->status != 200) return std::nullopt;
  return monitor_picture(nlohmann::json::parse(status->body, nullptr, false),
                         nlohmann::json::parse(universes->body, nullptr, false), terminal_size().columns);
}

/// Until Ctrl-C. With `once`, or if the output is no terminal: one picture.
int run_monitor(const ClientArguments& arguments, bool once) {
  const auto daemon = daemon_on(arguments.port, arguments.token);
  if (!daemon) return report(daemon.error());
  auto picture = fetched_picture(*daemon);
  if (!picture) return report(no_daemon(arguments.port));
  if (once || isatty(STDOUT_FILENO) == 0) {
    fmt::print("{}", *picture);
    return kExitOk;
  }
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, [](int) { g_interrupted = 1; });
  {
    const OtherScreen screen;
    while (g_interrupted == 0 && picture) {
      fmt::print("{}", on_screen(*picture, terminal_size().lines));
      std::fflush(stdout);
      std::this_thread::sleep_for(kPicturePeriod);
      picture = fetched_picture(*daemon);
    }
  }
  return g_interrupted != 0 ? kExitOk : report(no_daemon(arguments.port));
}

Action declare_monitor(CLI::App& command) {
  const auto client = std::make_shared<ClientArguments>();
  const auto once = std::make_shared<bool>(false);
  command.add_flag("--once", *once, "one picture, then end");
  add_client_without_json(command, *client);
  return [client, once] { return run_monitor(*client, *once); };
}

}  // namespace

const Command kMonitorCommand{"monitor", command_group::kRun,
                              "universes, heads, dimmers and meters, live in the terminal", declare_monitor};

}  // namespace luxrig
