#pragma once
/// Work that takes long, for clients: they start it, look how far it is, take its result, or cancel it. One job at a
/// time, on a thread of low priority; the others wait.

#include <cstdint>
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
#include "core/run.h"

namespace luxrig {

struct Job {
  /// lost: the daemon that had it has ended, and it left no plan.
  enum class State { waits, runs, done, failed, cancelled, lost };
  std::string id, kind;
  State state = State::waits;
  std::string stage, doing;   ///< while it runs: what it works on, or its best result so far, for a person
  bool can_be_taken = false;  ///< a cancel ends it with its best result so far
  std::string why;            ///< failed: the cause
  std::string plan_json;      ///< the result; of a cancelled job its best so far. Empty if there is none
};
[[nodiscard]] const char* name_of(Job::State state);

class Jobs {
 public:
  /// Returns a plan as JSON. Heeds watch.stop. Called on the job's thread.
  using Work = std::function<Result<std::string>(const Watch& watch)>;

  /// Plans of jobs are kept in this folder, which is made if missing, so that they outlive the daemon; none = not.
  explicit Jobs(std::optional<std::filesystem::path> folder);
  /// Cancels all, and waits for the one that runs.
  ~Jobs();

  /// The job's id. Refused while many wait.
  [[nodiscard]] Result<std::string> start(const std::string& kind, Work work);
  /// nullopt: this daemon never had it, or has forgotten it: it keeps the newest.
  [[nodiscard]] std::optional<Job> at(const std::string& id) const;
  /// Newest last.
  [[nodiscard]] std::vector<Job> all() const;
  /// What it is now: cancelled, or about to be; one that has ended stays as it is. nullopt as for at().
  std::optional<Job> cancel(const std::string& id);
  /// Cancels all, and takes no more.
  void stop();

 private:
  struct Running {
    Job job;
    Work work;
    std::stop_source stop;
  };
  void run_all();
  void run(const std::shared_ptr<Running>& one);
  void forget_old();
  void remove_old_plans() const;
  [[nodiscard]] std::filesystem::path file_of(const std::string& id) const;

  const std::string prefix_;  ///< of this daemon's ids
  std::optional<std::filesystem::path> folder_;
  mutable std::mutex mutex_;  // guards all below
  std::deque<std::shared_ptr<Running>> jobs_;
  std::uint64_t count_ = 0;
  bool stopped_ = false, working_ = false;
  std::thread thread_;
};

}  // namespace luxrig
