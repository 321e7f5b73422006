#pragma once
/// What a person has set by hand while the show runs: the level of a lamp, or the goal of a point. It stays until it is
/// released, within limits, and the rest is solved around it.

#include <optional>
#include <string>
#include <vector>

#include "core/time.h"

namespace luxrig {

struct ByHand {
  enum class What { level, goal };
  What what = What::level;
  std::size_t index = 0;  ///< fixture or point of the rig
  double value = 0;       ///< level 0…1, or lux
  Time since{};
  std::optional<Time> until{};  ///< released by itself then
  /// What is named is the housing of the fixture: its emitters keep their shares, and the brightest gets the level.
  bool whole_housing = false;
  bool of_plan = false;  ///< a level that a person wrote into the plan in force; the next plan ends it
  std::string why{};     ///< in a status: what keeps it from being so at present; empty: it is so

  /// Why it cannot be asked for (a level above 1, lux below 0); empty when it can. Of a fixture on or off: 0 or 1.
  [[nodiscard]] std::string complaint(bool switched) const;
};

}  // namespace luxrig
