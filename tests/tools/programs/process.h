#pragma once
/// Starts and ends programs under test.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "tests/folders.h"

namespace luxrig::testing {

using namespace std::chrono_literals;

inline std::string program(const std::string& name) { return (test::program_folder() / name).string(); }
inline std::string source(const std::string& path) { return (test::source_folder() / path).string(); }

inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A temporary folder, removed at the end of the test.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "luxrig-test-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// Waits until `done`, for `bound` at most; false if it never was.
inline bool wait_for(const std::function<bool()>& done, std::chrono::milliseconds bound) {
  const auto end = std::chrono::steady_clock::now() + bound;
  while (!done()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(20ms);
  }
  return true;
}

/// Also false for a zombie, which has ended but not been reaped.
inline bool runs(pid_t pid) {
  const std::string stat = text_of("/proc/" + std::to_string(pid) + "/stat");
  const auto name_end = stat.rfind(')');
  return name_end != std::string::npos && name_end + 2 < stat.size() && stat[name_end + 2] != 'Z';
}

class Process {
 public:
  /// words[0] is the program's path; its output goes to `log`.
  Process(std::vector<std::string> words, std::filesystem::path log) : log_(std::move(log)) {
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ == 0) {
      const int out = ::open(log_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
      ::dup2(out, STDOUT_FILENO);
      ::dup2(out, STDERR_FILENO);
      ::execv(argv[0], argv.data());
      ::_exit(127);
    }
  }
  ~Process() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void signal(int number) const { ::kill(pid_, number); }

  /// Exit code; -1 if it had to be killed after `bound`, -2 if a signal ended it.
  int wait(std::chrono::seconds bound) {
    int status = 0;
    rusage used{};
    const bool ended = wait_for([&] { return ::wait4(pid_, &status, WNOHANG, &used) == pid_; }, bound);
    processor_seconds_ = static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
                         1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
    if (!ended) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, &status, 0);
      pid_ = -1;
      return -1;
    }
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -2;
  }
  [[nodiscard]] std::string output() const { return text_of(log_); }
  /// Processor time of all its threads, once it has ended by itself.
  [[nodiscard]] double processor_seconds() const { return processor_seconds_; }

 private:
  pid_t pid_ = -1;
  double processor_seconds_ = 0;
  std::filesystem::path log_;
};

struct Ran {
  int code = 0;
  std::string output;
  double processor_seconds = 0;
};

/// Runs a program to its end. bound: against programs that hang; a busy machine may need minutes for seconds of work.
inline Ran run(const std::vector<std::string>& words, std::chrono::seconds bound = 300s) {
  const Folder folder;
  Process process(words, folder / "log");
  Ran ran;
  ran.code = process.wait(bound);
  ran.output = process.output();
  ran.processor_seconds = process.processor_seconds();
  return ran;
}

}  // namespace luxrig::testing
