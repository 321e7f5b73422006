#pragma once
/// Who changed what, from where, and what it was before: one line of JSON for each change, in the state folder. The
/// newest are kept in memory, too. All functions may be called from any thread.

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>

#include "tools/luxrigd/state/journal.h"

namespace luxrig {

/// What people set, for the log: {"blackout", "held" and "goals" by name, "parked", "bypassed", "plan": its fingerprint}.
[[nodiscard]] nlohmann::json settings_of(const JournalState& state);

/// {key: [old, new]} of what differs; of "held" and "goals" each name.
[[nodiscard]] nlohmann::json changes_between(const nlohmann::json& before, const nlohmann::json& after);

class ChangeLog {
 public:
  /// Files changes.jsonl and, when that has become large, changes.1.jsonl in the folder, mode 600; nullopt = in memory.
  explicit ChangeLog(std::optional<std::filesystem::path> folder, std::size_t most_bytes = 4u << 20);
  ~ChangeLog();  ///< writes what waits
  ChangeLog(const ChangeLog&) = delete;
  ChangeLog& operator=(const ChangeLog&) = delete;

  /// Adds the time, and returns at once: a thread of its own writes. If the disk is too slow, the oldest lines that wait
  /// are left out of the file, and the next says how many.
  void add(nlohmann::json change);
  /// The newest as a JSON list, the newest last.
  [[nodiscard]] std::string newest() const;
  /// Waits until all is in the file.
  void flush();

 private:
  void read_newest();
  void write(const std::string& lines);
  void run(const std::stop_token& stop);

  const std::optional<std::filesystem::path> folder_;
  const std::size_t most_bytes_;
  mutable std::mutex mutex_;  // guards the members below
  std::condition_variable_any wake_, written_;
  std::deque<std::string> newest_, waiting_;
  int left_out_ = 0;
  bool writing_ = false;
  std::jthread thread_;  // last: it uses the members above
};

}  // namespace luxrig
