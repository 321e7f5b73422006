#pragma once
/// luxrigd as a child, commanded over its HTTP API like any other client does it; and its guardian.

#include <sys/types.h>

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/result.h"
#include "tools/http/client.h"
#include "tools/process/child_process.h"
#include "tools/scenario/status_of_json.h"

namespace luxrig::scenario {

/// Where daemons of one show live, one after the other.
struct DaemonPlace {
  std::filesystem::path state;    ///< what they remember; its guardian's process id
  std::filesystem::path runtime;  ///< XDG_RUNTIME_DIR: their socket is found there, and by nobody else
  std::filesystem::path log;
};

class DaemonProcess {
 public:
  /// rig must outlive it. Returns at once: it answers when status() gives something.
  [[nodiscard]] static Result<std::unique_ptr<DaemonProcess>> start(const Rig& rig, const std::filesystem::path& ports,
                                                                    DaemonPlace place);
  ~DaemonProcess();  ///< kills it; the guardian stays
  DaemonProcess(const DaemonProcess&) = delete;
  DaemonProcess& operator=(const DaemonProcess&) = delete;

  /// The newest; null until it has given one. A thread asks it 20 times a second.
  struct Seen {
    DaemonStatus status;
    Time at{};  ///< when it came
  };
  [[nodiscard]] std::shared_ptr<const Seen> seen() const;
  /// What is wrong with the last status that was no good; empty if none was.
  [[nodiscard]] std::string complaint() const;

  /// Sends this to a route, after what was given before. take_answers() hands the outcome to `answered`.
  void post(std::string route, std::string body, std::function<void(const Result<void>&)> answered);
  void take_answers();

  void terminate() { child_.signal(15); }
  [[nodiscard]] std::optional<int> ended() { return child_.ended(); }
  /// Kills it, and hands over all answers: those that never came are refusals.
  void end();
  [[nodiscard]] std::string log_tail() const { return tail_of(place_.log); }

 private:
  DaemonProcess(const Rig& rig, ChildProcess child, DaemonPlace place);
  void ask_status(const std::stop_token& stop);
  void send_posts(const std::stop_token& stop);
  [[nodiscard]] std::optional<HttpPeer> peer() const;

  const Rig& rig_;
  ChildProcess child_;
  DaemonPlace place_;
  struct Post {
    std::string route, body;
    std::function<void(const Result<void>&)> answered;
    Result<void> answer{};
  };
  mutable std::mutex mutex_;  ///< guards what follows
  std::condition_variable_any posted_;
  std::shared_ptr<const Seen> seen_;
  std::string complaint_;
  std::deque<Post> posts_, answers_;
  std::jthread asks_, sends_;  ///< last: they use the members above
};

/// The guardian of the daemons of this state folder; nullopt if none lives.
[[nodiscard]] std::optional<pid_t> guardian_of(const std::filesystem::path& state);

}  // namespace luxrig::scenario
