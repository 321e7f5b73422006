#pragma once
/// A program of this build as a child process.

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"

namespace luxrig {

struct ChildOptions {
  std::filesystem::path log;                                     ///< its output
  std::vector<std::pair<std::string, std::string>> environment;  ///< set, or removed with an empty value
};

class ChildProcess {
 public:
  /// Starts a program from the folder of this one. In a process group of its own: a Ctrl-C at the terminal is for its
  /// parent. It gets SIGTERM when the thread that started it ends.
  [[nodiscard]] static Result<ChildProcess> start(const std::string& program, const std::vector<std::string>& arguments,
                                                  const ChildOptions& options);
  ~ChildProcess();  ///< ends it: SIGTERM, and SIGKILL after two seconds
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) noexcept;

  void signal(int number) const;
  /// Exit code, or 128 and the signal that ended it; nullopt while it runs.
  [[nodiscard]] std::optional<int> ended();
  /// SIGKILL, and returns when it has ended.
  void kill();

 private:
  explicit ChildProcess(pid_t pid) : pid_(pid) {}
  pid_t pid_ = -1;
  std::optional<int> code_;
};

/// The last lines of a child's log, for a message.
[[nodiscard]] std::string tail_of(const std::filesystem::path& log);

}  // namespace luxrig
