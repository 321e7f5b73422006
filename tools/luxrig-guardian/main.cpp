// luxrig-guardian: waits for its daemon to die, then holds the last look and fades to the safe look. The daemon starts
// it (tools/luxrigd/guardian/guardian.h); a person never needs to.
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <map>

#include "core/rig/rig_file.h"
#include "drivers/io/os_fault.h"
#include "drivers/registry.h"
#include "tools/command_line/version.h"
#include "tools/luxrig/open_session.h"
#include "tools/luxrigd/bus_thread.h"
#include "tools/luxrigd/guardian/guardian_words.h"
#include "tools/luxrigd/guardian/handed_light.h"
#include "tools/luxrigd/guardian/last_look.h"
#include "tools/luxrigd/scheduling.h"
#include "tools/luxrigd/teller.h"
#include "tools/process/clock.h"
#include "tools/terminal/command.h"

namespace luxrig {
namespace {

constexpr int kLooksUntilDevicesAreFreed = 100;  // 5 s

struct GuardianArguments {
  std::filesystem::path rig, pid_file;
  int look_fd = -1, alive_fd = -1;
  std::vector<std::string> redirects;  ///< redirect_text()
};

std::optional<std::map<std::string, Redirect>> redirects_of(const std::vector<std::string>& texts) {
  std::map<std::string, Redirect> redirects;
  for (const std::string& text : texts) {
    auto redirect = redirect_of(text);
    if (!redirect) return std::nullopt;
    redirects.insert(std::move(*redirect));
  }
  return redirects;
}

enum class Call { died, hangs, sent_away };

/// Watches the daemon by the pipe that closes when it dies, and by the heartbeats of its threads. It counts looks, not
/// seconds: if the whole computer stalls, the daemon does not count as hung.
class Watch {
 public:
  Watch(LastLookMemory& memory, int alive_fd, int signals_fd)
      : memory_(memory), alive_fd_(alive_fd), signals_fd_(signals_fd) {}

  Call wait() {
    while (true) {
      pollfd waits[] = {{alive_fd_, POLLIN, 0}, {signals_fd_, POLLIN, 0}};
      if (::poll(waits, 2, kLookEvery_ms) < 0 && errno != EINTR) return Call::died;
      memory_.beat(LastLookMemory::Beat::guardian);
      if (waits[1].revents != 0) return Call::sent_away;
      if (waits[0].revents != 0) return Call::died;  // nothing is ever written: it has closed
      const std::uint32_t control = memory_.beats(LastLookMemory::Beat::control);
      // A bus whose device does not answer may wait for long, and so may the control loop, but not all at once.
      if (any_.stands_still(control + memory_.beats(LastLookMemory::Beat::output)) >= kLooksUntilItHangs &&
          memory_.take())
        return Call::hangs;
      // The light is held while the control loop hangs, but limits are not watched and no command works.
      if (control_.stands_still(control) == kLooksUntilItIsEnded) end_daemon();
    }
  }
  void end_daemon() const {
    if (::getppid() == daemon_) ::kill(daemon_, SIGKILL);
  }

  static constexpr int kLookEvery_ms = 50;
  static constexpr int kLooksUntilItHangs = 12;     ///< 0.6 s
  static constexpr int kLooksUntilItIsEnded = 600;  ///< 30 s

 private:
  struct Count {
    std::uint32_t last = 0;
    int looks = 0;
    /// Number of looks without a change; 0 before the first heartbeat.
    int stands_still(std::uint32_t now) {
      looks = now == last && now != 0 ? looks + 1 : 0;
      last = now;
      return looks;
    }
  };
  LastLookMemory& memory_;
  int alive_fd_, signals_fd_;
  pid_t daemon_ = ::getppid();
  Count any_, control_;
};

bool has_closed(int alive_fd) {
  pollfd wait{alive_fd, POLLIN, 0};
  return ::poll(&wait, 1, 0) == 1;
}

OutputProgram program_of(const Rig& rig, const LightInForce& light, Time now) {
  OutputProgram program;
  program.revision = 1;
  program.from_level = light.look.levels;
  program.to_level = light.safe_levels;
  program.start = now + from_seconds(light.hold_s);
  program.duration = from_seconds(light.fade_s);
  program.curve = rig.control.fade_curve;
  program.joints = light.look.joints;
  for (const Fixture& fixture : rig.fixtures) program.max_level.push_back(rig.max_level(fixture));
  program.switched = switched_fixtures(rig);
  return program;
}

/// Appends the light to our pid file, for the daemon that has sent us away.
void hand_over(int pid_fd, const LightInForce& light) {
  const std::string text = handed_light_text(light) + "\n";
  (void)!::pwrite(pid_fd, text.data(), text.size(), ::lseek(pid_fd, 0, SEEK_END));
}

int g_signal_pipe[2] = {-1, -1};
volatile std::sig_atomic_t g_signal = 0;

void on_signal(int signal) {
  g_signal = signal;
  const char byte = 0;
  (void)!::write(g_signal_pipe[1], &byte, 1);
}

/// Whether we have all devices. The daemon keeps those that only one process can open, as long as it lives.
bool all_taken(const std::vector<std::unique_ptr<BusThread>>& buses) {
  return std::all_of(buses.begin(), buses.end(), [](const auto& bus) {
    const std::vector<Health> health = bus->health();
    return !health.empty() && health.front().life == Life::active;
  });
}

/// Sends until a signal, or until a hung daemon ends in order. watch: set if the daemon hangs.
void look_after(const Rig& rig, const LightInForce& light, const std::map<std::string, Redirect>& redirects, int pid_fd,
                LastLookMemory& memory, int alive_fd, const Watch* watch) {
  if (watch != nullptr) memory.take_the_light();
  Teller teller(STDERR_FILENO);
  ProgramMailbox programs;
  OutputProgram program = program_of(rig, light, now());
  std::vector<std::unique_ptr<BusThread>> buses;
  for (std::size_t b = 0; b < rig.buses.size(); ++b) {
    std::optional<Redirect> redirect;
    if (const auto it = redirects.find(rig.buses[b].name); it != redirects.end()) redirect = it->second;
    auto driver = find_driver(rig.buses[b].driver)->make(rig, b, redirect);
    // Buses that only turn or measure stay as they are: an axis whose master has died stops by itself.
    if (driver->level_output() == nullptr) continue;
    const std::size_t first_desk = program.desks.size();
    if (const LevelInput* input = driver->level_input()) {
      for (const DeskPart& part : input->parts()) {
        // A desk that drives the lamps itself goes on. The guardian knows nothing of other desks.
        program.desks.emplace_back();
        for (const std::size_t f : part.fixtures) program.desks.back().silent |= light.silent[f] != 0;
      }
    }
    buses.push_back(std::make_unique<BusThread>(rig, b, std::move(driver), programs, first_desk));
  }
  programs.put(program);
  for (const auto& bus : buses) bus->start();
  lock_memory();
  teller.tell(
      fmt::format("luxrig-guardian: the daemon {}: its last look is held for {:g} s, then the safe look, until it {} "
                  "(or kill {})\n",
                  watch != nullptr ? "hangs" : "died", light.hold_s,
                  watch != nullptr ? "goes on or is started anew" : "is started anew", ::getpid()));
  bool hangs = watch != nullptr;
  for (int looks = 0; g_signal == 0; ++looks) {
    pollfd waits[] = {{g_signal_pipe[0], POLLIN, 0}, {hangs ? alive_fd : -1, POLLIN, 0}};
    ::poll(waits, 2, Watch::kLookEvery_ms);
    memory.beat(LastLookMemory::Beat::guardian);
    if (!hangs) continue;
    if (waits[1].revents != 0) {
      if (memory.ended()) return;  // it ended in order, as far as it could
      hangs = false;
    } else if (looks == kLooksUntilDevicesAreFreed && !all_taken(buses)) {
      watch->end_daemon();
    }
  }
  // A daemon goes on from here. A goodbye would let fixtures go dark before its first frame.
  if (g_signal == SIGUSR1) {
    const Time at = now();
    LightInForce now_out = light;
    now_out.hold_s = std::max(0.0, to_seconds(program.start - at));
    program.levels_at(at, now_out.look.levels);
    hand_over(pid_fd, now_out);
    ::_exit(kExitOk);
  }
}

int guard(const GuardianArguments& arguments) {
  if (::pipe(g_signal_pipe) != 0) return kExitFailed;
  for (const int signal : {SIGUSR1, SIGTERM, SIGINT}) ::signal(signal, on_signal);
  for (const int signal : {SIGPIPE, SIGHUP}) ::signal(signal, SIG_IGN);
  auto rig = load_rig(arguments.rig);
  if (rig) rig = with_calibration(std::move(*rig));
  if (!rig) return report(rig.error());
  if (const auto problems = check_buses(*rig); !problems.empty()) return report(problems);
  const auto redirects = redirects_of(arguments.redirects);
  if (!redirects) {
    return report(std::vector<Problem>{{kRedirectOption, 0, 0, "is not understood", "give bus=host:port or bus=/path"}});
  }
  auto memory = LastLookMemory::open(arguments.look_fd, rig->fixtures.size());
  if (!memory) return report(memory.error());
  // The lock is held as long as this process lives: it tells a reader that the process id is still valid.
  const int pid_fd = ::open(arguments.pid_file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  const std::string number = std::to_string(::getpid()) + "\n";
  if (pid_fd < 0 || ::flock(pid_fd, LOCK_EX | LOCK_NB) != 0 || ::ftruncate(pid_fd, 0) != 0 ||
      ::pwrite(pid_fd, number.data(), number.size(), 0) != static_cast<ssize_t>(number.size())) {
    return report(os_fault("keeping " + arguments.pid_file.string(), errno));
  }
  Watch watch(*memory, arguments.alive_fd, g_signal_pipe[0]);
  const Call call = watch.wait();
  const std::optional<LightInForce> light = memory->ended() ? std::nullopt : memory->take();
  if (light && call != Call::sent_away) {
    look_after(*rig, *light, *redirects, pid_fd, *memory, arguments.alive_fd, call == Call::hangs ? &watch : nullptr);
  } else if (light && g_signal == SIGUSR1 && has_closed(arguments.alive_fd)) {
    // Sent away before we took over: the daemon's last output still stands.
    hand_over(pid_fd, *light);
    return kExitOk;
  }
  std::error_code ignored;
  std::filesystem::remove(arguments.pid_file, ignored);
  return kExitOk;
}

}  // namespace
}  // namespace luxrig

int main(int argc, char** argv) {
  CLI::App app("Luxrig's guardian: started by the daemon, it takes the rig to its safe look when that dies");
  app.set_version_flag("--version", std::string("luxrig-guardian ") + luxrig::kVersion, "print version and commit");
  luxrig::GuardianArguments arguments;
  app.add_option("RIG", arguments.rig)->required();
  app.add_option(luxrig::kLookOption, arguments.look_fd, "memory in which the daemon keeps its last look")->required();
  app.add_option(luxrig::kAliveOption, arguments.alive_fd, "pipe that closes when the daemon dies")->required();
  app.add_option(luxrig::kPidOption, arguments.pid_file, "where to say which process this is")->required();
  app.add_option(luxrig::kRedirectOption, arguments.redirects, "bus=host:port, instead of what the rig file says");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? luxrig::kExitOk : luxrig::kExitBadInput;
  }
  return luxrig::guard(arguments);
}
