#pragma once
/// How far corrections have come since the last cue.

#include <string>
#include <vector>

#include "core/estimation/gain_estimator.h"
#include "core/time.h"

namespace luxrig {

/// A point above its limit, by its meter; kept while it lasts.
struct LimitBreach {
  std::size_t point = 0;
  double worst_case_lx = 0;
  Time since{};
};

struct CorrectionProgress {
  int round = 0;
  bool converged = false;
  Time corrected_at{};           ///< when the last correction was decided
  Time sampled_at{};             ///< of the last sample while holding
  int drifted = 0;               ///< samples in a row, while holding, that ask for a correction
  Duration patience = kPatience;  ///< before the next one that only the readings ask for, not what is known by them
  std::vector<double> aimed_lx;  ///< per point: reachable by the last correction; empty before
  std::vector<std::string> why;  ///< per point: why its goal is not met; empty before the first
  std::vector<LimitBreach> breaches;

  /// Where no levels that are known of bring what meters show to the goals, trying again is seldom of use: at most every
  /// ten minutes in the end.
  static constexpr Duration kPatience = std::chrono::seconds(10), kMostPatience = std::chrono::minutes(10);

  /// A new cue: nothing has been corrected.
  void begin() {
    round = 0;
    converged = false;
    patience = kPatience;
    forget_aims();
  }
  /// Another rig or other points: what was reachable is not known.
  void forget_aims() {
    aimed_lx.clear();
    why.clear();
    breaches.clear();
  }
  void take_aims(Correction& correction) {
    aimed_lx = std::move(correction.aimed_lx);
    why = std::move(correction.why);
  }
};

}  // namespace luxrig
