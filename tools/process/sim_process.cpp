#include "tools/process/sim_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "tools/http/client.h"
#include "tools/process/files.h"

extern char** environ;

namespace luxrig {
namespace {

Fault fault_of(std::string detail) { return {Cause::system, "luxrig-sim", std::move(detail), {}}; }

std::string tail_of(const std::filesystem::path& file) {
  auto text = read_file(file).value_or("");
  if (text.size() > 400) text = "…" + text.substr(text.size() - 400);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

}  // namespace

Result<SimProcess> SimProcess::start(const std::filesystem::path& rig, std::uint64_t seed) {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto program = self.parent_path() / "luxrig-sim";
  if (error || ::access(program.c_str(), X_OK) != 0) {
    return tl::unexpected(fault_of(program.string() + " is missing: build it with this program"));
  }
  std::string folder = (std::filesystem::temp_directory_path() / "luxrig-sim-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr)
    return tl::unexpected(fault_of("no temporary folder: " + std::string(std::strerror(errno))));
  const std::filesystem::path place(folder);
  const std::vector<std::string> words = {program.string(),     rig.string(),   "--seed",
                                          std::to_string(seed), "--ports-file", (place / "ports.json").string(),
                                          "--with-parent"};
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  const std::string log = (place / "log").string();

  const pid_t pid = ::fork();
  if (pid < 0) return tl::unexpected(fault_of("cannot start: " + std::string(std::strerror(errno))));
  if (pid == 0) {
    // A Ctrl-C at the terminal is for the daemon: it fades out first, then ends the simulator.
    ::setpgid(0, 0);
    sigset_t none;
    sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
    const int out = ::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (out >= 0) {
      ::dup2(out, STDOUT_FILENO);
      ::dup2(out, STDERR_FILENO);
    }
    ::execve(argv[0], argv.data(), environ);
    ::_exit(127);
  }
  return SimProcess(pid, place);
}

SimProcess::SimProcess(SimProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)), folder_(std::exchange(other.folder_, {})) {}

SimProcess::~SimProcess() {
  if (pid_ > 0) {
    ::kill(pid_, SIGTERM);
    for (int i = 0; i < 200; ++i) {
      if (::waitpid(pid_, nullptr, WNOHANG) != 0) {
        pid_ = -1;
        break;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
  }
  if (!folder_.empty()) {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
}

Result<SimPorts> SimProcess::wait_ready(const Watch& watch) {
  const auto ports_file = folder_ / "ports.json";
  while (true) {
    if (watch.stop.stop_requested()) return tl::unexpected(Fault{Cause::cancelled, "luxrig-sim", "stopped", {}});
    std::error_code error;
    if (std::filesystem::exists(ports_file, error)) {
      const auto ports = read_sim_ports(ports_file);
      if (!ports) return tl::unexpected(fault_of(ports.error().front().text()));
      return *ports;
    }
    int status = 0;
    if (::waitpid(pid_, &status, WNOHANG) == pid_) {
      pid_ = -1;
      return tl::unexpected(
          fault_of(fmt::format("ended before it was ready (status {}): {}", status, tail_of(folder_ / "log"))));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

std::optional<SimTruth> ask_truth(const Redirect& control) {
  const auto answer = http_get({control.host, control.port}, "/truth");
  if (!answer || answer->status != 200) return {};
  const auto json = nlohmann::json::parse(answer->body, nullptr, false);
  if (!json.is_object() || !json.contains("points") || !json.contains("violations")) return {};
  SimTruth truth;
  for (const auto& point : json["points"]) {
    truth.points.push_back({point.value("name", ""), point.value("lux", 0.0), point.value("max_lux_seen", 0.0)});
  }
  truth.violations = json["violations"].size();
  return truth;
}

}  // namespace luxrig
