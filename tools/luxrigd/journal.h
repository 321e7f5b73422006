#pragma once
/// What must survive a power cut: the plan in force, the blackout switch, heads that rest, and what is set by hand.

#include <filesystem>
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
};

class Journal {
 public:
  /// Keeps its one file in `folder` (made when missing).
  explicit Journal(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// On disk when it returns; the old state stays when it fails.
  [[nodiscard]] Result<void> save(const JournalState& state) const;
  /// Nothing when there is none; problems when the file is damaged (it is left as it is).
  [[nodiscard]] Checked<std::optional<JournalState>> load() const;

 private:
  [[nodiscard]] std::filesystem::path file() const { return folder_ / "state.json"; }
  std::filesystem::path folder_;
};

/// $XDG_STATE_HOME/luxrig/NAME, or ~/.local/state/luxrig/NAME.
[[nodiscard]] std::filesystem::path default_state_folder(const std::string& rig_name);

}  // namespace luxrig
