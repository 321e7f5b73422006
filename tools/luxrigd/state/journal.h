#pragma once
/// What must survive a power cut: the plan in force, the blackout switch, heads that rest, what is set by hand, and
/// what is bypassed.

#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"

namespace luxrig {

/// A level or goal set by hand, by the wall clock: it goes on ageing while no daemon runs.
struct SavedByHand {
  bool goal = false;  ///< of a point, in lux; else the level of a fixture
  std::string name;
  double value = 0;
  double since_unix_s = 0;
  std::optional<double> until_unix_s{};
};

struct JournalState {
  std::string plan_json;  ///< empty: none applied yet
  bool blackout = false;
  std::vector<std::string> parked{};  ///< fixtures
  bool plan_of_rig = false;           ///< the plan was solved from the rig file at start; else a person applied it
  std::vector<SavedByHand> by_hand{};
  std::vector<std::string> bypassed{};  ///< fixtures and luxmeters
};

/// A state as the text of a file.
[[nodiscard]] std::string state_text(const JournalState& state);

/// Any text as a state: what is legible of it holds, above all the blackout. damage: what is wrong with the text; empty:
/// nothing.
struct LegibleState {
  JournalState state;
  std::string damage;
};
[[nodiscard]] LegibleState legible_state_of(const std::string& text);

class Journal {
 public:
  /// Keeps its one file in `folder` (made when missing). None: in memory only.
  explicit Journal(std::optional<std::filesystem::path> folder = {}) : folder_(std::move(folder)) {}

  /// What an earlier program left, as far as it can be read: what is legible of a damaged file holds, above all the
  /// blackout; the file stays until the next save and gets a second name, so that it is never lost. complaints: for a
  /// person. Does not change state().
  struct Left {
    std::optional<JournalState> state;  ///< none: nothing was left
    std::vector<std::string> complaints;
  };
  [[nodiscard]] Left load() const;

  /// What holds now. Any thread may call any of these: changes come one after the other, so that the disk never has an
  /// older state than memory.
  [[nodiscard]] JournalState state() const;
  using Change = std::function<void(JournalState&)>;
  /// For what must be on disk before it is done: changes nothing when it cannot be saved.
  [[nodiscard]] Result<void> save_first(const Change& change);
  /// For what is done already: holds in memory also when it cannot be saved, and goes with the next save.
  [[nodiscard]] Result<void> keep(const Change& change);
  /// Why the disk has not what holds; nothing: it has.
  [[nodiscard]] std::optional<std::string> unsaved() const;

 private:
  [[nodiscard]] std::filesystem::path file() const { return *folder_ / "state.json"; }
  [[nodiscard]] Result<void> make_folder();
  [[nodiscard]] Result<void> save(const JournalState& state);
  [[nodiscard]] std::string keep_aside() const;  ///< what a complaint says of it
  void tell(const Result<void>& saved);

  const std::optional<std::filesystem::path> folder_;
  mutable std::mutex mutex_;  ///< held while the disk works
  JournalState state_;
  std::vector<std::filesystem::path> unsynced_;  ///< folders that have a new folder
  mutable std::mutex told_mutex_;                ///< never held so long: who asks drives the light
  std::optional<std::string> unsaved_;
};

/// $XDG_STATE_HOME/luxrig/NAME, or ~/.local/state/luxrig/NAME.
[[nodiscard]] std::filesystem::path default_state_folder(const std::string& rig_name);

}  // namespace luxrig
