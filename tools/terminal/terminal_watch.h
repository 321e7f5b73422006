#pragma once
/// Progress lines about a long computation for a person, the first within two seconds.

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "core/tasks/stage.h"

namespace luxrig {

/// On a terminal one line per stage, rewritten twice a second; elsewhere a line every ten seconds.
class TerminalWatch {
 public:
  /// sink   gets the text; none = standard error
  explicit TerminalWatch(std::function<void(std::string)> sink = nullptr);
  ~TerminalWatch();
  TerminalWatch(const TerminalWatch&) = delete;
  TerminalWatch& operator=(const TerminalWatch&) = delete;

  /// The callback for a computation; it must not outlive this object.
  [[nodiscard]] Tell tell() {
    return [this](const Doing& doing) { told(doing); };
  }

 private:
  struct Line {
    Doing doing;
    double start_s = 0, said_s = 0;
    bool said = false;
  };

  void told(const Doing& doing);
  void run();

  const bool terminal_;
  std::function<void(std::string)> sink_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Line> stages_;  ///< stages under way; the innermost is last
  bool ended_ = false;
  std::thread thread_;  ///< last: it uses all of these
};

}  // namespace luxrig
