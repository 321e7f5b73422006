#pragma once
/// Why the lights of a relief task are as they are, from figures of its result. Nothing is searched again.

#include <string>
#include <vector>

#include "core/highlight/aim/aim_objective.h"
#include "core/rig/brief.h"

namespace luxrig {

/// What a light serves: how much of each term goes when it alone is dark, over the sum of that of all lights that lose
/// something. 0…1; 0 for a term that no light serves.
struct LightService {
  std::string light;
  double level = 0;
  double fine = 0, form = 0, lit = 0, edge = 0;  ///< with objective "seen"
  double contrast = 0, coverage = 0;             ///< with objective "thesis"
};

struct ReliefReasons {
  std::string task;
  bool seen = false;
  LightRole role = LightRole::any;
  SetUp set_up = SetUp::none;
  AimScore score;                   ///< without `seen` if dimmed_to says so
  std::optional<double> dimmed_to;  ///< a limit dims its lights to this share of the levels that they were judged at
  std::optional<AimScore> before;   ///< kind "aim"
  std::vector<LightService> lights;
  std::size_t dark = 0;  ///< lights that were sought, and stay dark
  /// Of those: the most that the objective would change by if one were lit; none = the limits or the set-up leave them
  /// no light.
  std::optional<double> gain_of_dark;
};

/// A light of the result, and the score with it dark.
struct LitAlone {
  std::string light;
  double level = 0;
  const AimScore* without = nullptr;
};
[[nodiscard]] std::vector<LightService> services_of(const AimScore& score, const std::vector<LitAlone>& lights);

/// "2 lights are enough: …", if some stay dark; else empty.
[[nodiscard]] std::string dark_in_words(const ReliefReasons& reasons);
/// Two sentences: what the lights reach, and which of them does what.
[[nodiscard]] std::string in_two_sentences(const ReliefReasons& reasons);

}  // namespace luxrig
