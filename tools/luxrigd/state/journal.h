#pragma once
/// State that must survive a power cut: the plan in force, the blackout switch, parked heads, levels and goals set by
/// hand, and bypassed devices.

#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"

namespace luxrig {

/// A level or goal set by hand. Times are wall-clock, as it keeps ageing while no daemon runs.
struct SavedByHand {
  bool goal = false;  ///< a point's goal in lux; else a fixture's level
  std::string name;
  double value = 0;
  double since_unix_s = 0;
  std::optional<double> until_unix_s{};
};

struct JournalState {
  std::string plan_json;  ///< empty before the first plan
  bool blackout = false;
  std::vector<std::string> parked{};  ///< fixtures
  bool plan_of_rig = false;           ///< the plan was solved from the rig file; else a person applied it
  std::vector<SavedByHand> by_hand{};
  std::vector<std::string> bypassed{};  ///< fixtures and luxmeters
};

/// Text of the state file.
[[nodiscard]] std::string state_text(const JournalState& state);

/// Reads any text as a state and takes all legible parts, above all the blackout. damage: what is wrong with the text;
/// empty if nothing is.
struct LegibleState {
  JournalState state;
  std::string damage;
};
[[nodiscard]] LegibleState legible_state_of(const std::string& text);

class Journal {
 public:
  /// Keeps its one file in `folder`, which is made if missing; nullopt = in memory only.
  explicit Journal(std::optional<std::filesystem::path> folder = {}) : folder_(std::move(folder)) {}

  /// The state that an earlier program left. All legible parts of a damaged file count, above all the blackout. Such a
  /// file stays until the next save and gets a second name, so that it is never lost. complaints: for a person. Does
  /// not change state().
  struct Left {
    std::optional<JournalState> state;  ///< none if there was no file, or it cannot be read
    std::vector<std::string> complaints;
  };
  [[nodiscard]] Left load() const;

  /// The present state. All functions here may be called from any thread. Changes run one after the other, so that the
  /// disk never has an older state than memory.
  [[nodiscard]] JournalState state() const;
  using Change = std::function<void(JournalState&)>;
  /// For changes that must be on disk before they take effect: changes nothing if saving fails.
  [[nodiscard]] Result<void> save_first(const Change& change);
  /// For changes that have taken effect already: memory changes even if saving fails, and the next save includes it.
  [[nodiscard]] Result<void> keep(const Change& change);
  /// Why the disk lacks the present state; nullopt if it has it.
  [[nodiscard]] std::optional<std::string> unsaved() const;

 private:
  [[nodiscard]] std::filesystem::path file() const { return *folder_ / "state.json"; }
  [[nodiscard]] Result<void> make_folder();
  [[nodiscard]] Result<void> save(const JournalState& state);
  [[nodiscard]] std::string keep_aside() const;  ///< returns the complaint's words for it
  void tell(const Result<void>& saved);

  const std::optional<std::filesystem::path> folder_;
  mutable std::mutex mutex_;  ///< held while the disk works
  JournalState state_;
  std::vector<std::filesystem::path> unsynced_;  ///< parents of new folders
  mutable std::mutex told_mutex_;                ///< held briefly: the control loop calls unsaved()
  std::optional<std::string> unsaved_;
};

/// $XDG_STATE_HOME/luxrig/NAME, or ~/.local/state/luxrig/NAME.
[[nodiscard]] std::filesystem::path default_state_folder(const std::string& rig_name);

}  // namespace luxrig
