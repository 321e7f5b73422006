#pragma once
/// A level of a lamp or a goal of a point that a person has set while the show runs. It stays until it is released,
/// within limits. The rest is solved around it.

#include <optional>
#include <string>
#include <vector>

#include "core/time.h"

namespace luxrig {

/// How a setting by hand comes and goes.
struct ByHandTimes {
  std::optional<double> for_s{};   ///< released then; none = by a person
  std::optional<double> fade_s{};  ///< its own fade; none = the rig's
  bool measuring = false;          ///< see ShowController::hold
};

struct ByHand {
  enum class What { level, goal };
  What what = What::level;
  std::size_t index = 0;  ///< fixture or point of the rig
  double value = 0;       ///< level 0…1, or lux
  Time since{};
  std::optional<Time> until{};  ///< released automatically then
  /// The whole housing of the fixture: its emitters keep their ratio, and the brightest gets the level.
  bool whole_housing = false;
  bool of_plan = false;  ///< level that a person wrote into the plan in force; the next plan ends it
  std::string why{};     ///< in a status: why it is not in effect; empty if it is

  /// Why it is refused (a level outside 0…1, a goal outside 0…1e6 lx); empty if valid. An on-off fixture takes 0 or 1.
  [[nodiscard]] std::string complaint(bool switched) const;
};

}  // namespace luxrig
