#include "tools/luxrigd/guardian/guardian.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <thread>
#include <utility>
#include <vector>

#include "drivers/io/os_fault.h"
#include "tools/luxrigd/guardian/guardian_words.h"
#include "tools/luxrigd/guardian/handed_light.h"
#include "tools/process/files.h"

extern char** environ;

namespace luxrig {
namespace {

constexpr auto kLeavesWithin = std::chrono::seconds(3);
constexpr auto kEndsWithin = std::chrono::seconds(1);
constexpr auto kLook = std::chrono::milliseconds(10);
constexpr Duration kHangs = std::chrono::seconds(1), kStartsWithin = std::chrono::seconds(10);

/// The first pid file that can be written.
Result<std::filesystem::path> pid_file_in(const std::filesystem::path& state_folder) {
  int why = ENOENT;
  for (const std::filesystem::path& file : guardian_pid_files(state_folder)) {
    const int fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (fd >= 0) {
      ::close(fd);
      return file;
    }
    why = errno;
  }
  return tl::unexpected(os_fault("keeping which process it is in " + state_folder.string(), why));
}

std::filesystem::path guardian_program() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / kGuardianName;
}

}  // namespace

Result<Guardian> Guardian::start(GuardianSettings settings, LastLookMemory& memory, Time now) {
  Guardian made(std::move(settings), memory, now);
  if (auto launched = made.launch(); !launched) return tl::unexpected(launched.error());
  return made;
}

Result<void> Guardian::launch() {
  const auto program = guardian_program();
  if (::access(program.c_str(), X_OK) != 0)
    return refusal(program.string() + " is missing: build it with this program");
  std::error_code error;
  std::filesystem::create_directories(settings_.state_folder, error);
  const auto pid_file = pid_file_in(settings_.state_folder);
  if (!pid_file) return tl::unexpected(pid_file.error());
  int ends[2] = {-1, -1};
  if (::pipe2(ends, O_CLOEXEC) != 0) return tl::unexpected(os_fault("making a pipe to the guardian", errno));
  std::vector<std::string> words = {
      program.string(), settings_.rig_file.string(), kLookOption, std::to_string(memory_->fd()),
      kAliveOption,     std::to_string(ends[0]),     kPidOption,  pid_file->string()};
  for (const auto& [bus, to] : settings_.redirects) {
    words.insert(words.end(), {kRedirectOption, redirect_text(bus, to)});
  }
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const pid_t pid = ::fork();
  if (pid < 0) {
    const int failed = errno;
    ::close(ends[0]);
    ::close(ends[1]);
    return tl::unexpected(os_fault("starting the guardian", failed));
  }
  if (pid == 0) {
    // Its own session, so that the terminal's Ctrl-C and hang-up do not reach it. From here on only calls that are safe
    // between fork and exec.
    ::setsid();
    sigset_t none;
    sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
    // Nothing else of ours: a page's socket that lived on in it would keep the port, and leave clients without answer.
    ::close_range(3, ~0U, CLOSE_RANGE_CLOEXEC);
    ::fcntl(memory_->fd(), F_SETFD, 0);
    ::fcntl(ends[0], F_SETFD, 0);
    for (const int fd : settings_.claims) ::fcntl(fd, F_SETFD, 0);
    ::execve(argv[0], argv.data(), environ);
    ::_exit(127);
  }
  ::close(ends[0]);
  if (alive_fd_ >= 0) ::close(alive_fd_);
  alive_fd_ = ends[1];
  pid_ = pid;
  return {};
}

Guardian::Guardian(Guardian&& other) noexcept
    : settings_(std::move(other.settings_)),
      memory_(other.memory_),
      beat_at_(other.beat_at_),
      beats_(other.beats_),
      looks_(other.looks_),
      pid_(std::exchange(other.pid_, -1)),
      alive_fd_(std::exchange(other.alive_fd_, -1)) {}

Guardian::~Guardian() { end(); }

bool Guardian::alive(Time now) {
  if (pid_ <= 0) return false;
  if (::waitpid(pid_, nullptr, WNOHANG) != 0) {
    pid_ = -1;
    return false;
  }
  if (const std::uint32_t beats = memory_->beats(kBeat); beats != beats_) {
    beats_ = beats;
    beat_at_ = now;
    looks_ = true;
    return true;
  }
  if (now - beat_at_ < (looks_ ? kHangs : kStartsWithin)) return true;
  leave();
  return false;
}

void Guardian::leave() {
  if (pid_ <= 0) return;
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
  pid_ = -1;
}

void Guardian::end() {
  if (alive_fd_ < 0) return;
  if (pid_ > 0) memory_->end();
  ::close(std::exchange(alive_fd_, -1));
  wait_for_its_end();
}

void Guardian::wait_for_its_end() {
  if (pid_ <= 0) return;
  const auto until = std::chrono::steady_clock::now() + kEndsWithin;
  while (::waitpid(pid_, nullptr, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > until) return leave();
    std::this_thread::sleep_for(kLook);
  }
  pid_ = -1;
}

namespace {

std::optional<LightInForce> send_away_by(const std::filesystem::path& pid_file, std::size_t fixtures) {
  // A live guardian holds a lock on its file. The process id alone may belong to another process by now.
  const int fd = ::open(pid_file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return std::nullopt;
  const auto gone = [fd] { return ::flock(fd, LOCK_EX | LOCK_NB) == 0; };
  bool there = false;
  if (!gone()) {
    char text[16] = {};
    const ssize_t got = ::pread(fd, text, sizeof(text) - 1, 0);
    const pid_t pid = got > 0 ? static_cast<pid_t>(std::atol(text)) : 0;
    there = pid > 1 && ::kill(pid, SIGUSR1) == 0;
    const auto until = std::chrono::steady_clock::now() + kLeavesWithin;
    while (there && !gone()) {
      if (std::chrono::steady_clock::now() > until) {
        ::kill(pid, SIGKILL);
        break;
      }
      std::this_thread::sleep_for(kLook);
    }
  }
  ::close(fd);
  if (!there) return std::nullopt;
  const auto said = read_file(pid_file);
  const auto number_ends = said ? said->find('\n') : std::string::npos;
  return number_ends == std::string::npos ? std::nullopt : handed_light_of(said->substr(number_ends + 1), fixtures);
}

}  // namespace

std::optional<LightInForce> send_guardian_away(const std::filesystem::path& state_folder, std::size_t fixtures) {
  std::optional<LightInForce> light;
  for (const std::filesystem::path& file : guardian_pid_files(state_folder))
    if (auto its = send_away_by(file, fixtures)) light = std::move(its);
  return light;
}

}  // namespace luxrig
