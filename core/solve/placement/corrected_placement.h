#pragma once
/// Lights of any method, corrected by a better light model (correct_lights.h).

#include <optional>

#include "core/solve/placement/methods/placement_method.h"
#include "core/solve/placement/search/correct_lights.h"

namespace luxrig {

struct CorrectedPlacement {
  FoundLights found;                         ///< as the method returned them, by the problem's own model
  std::optional<CorrectedLights> corrected;  ///< empty = no better model was given, or it failed
  std::optional<Fault> failed;               ///< why it failed
  std::size_t columns = 0;                   ///< of all searches
};

struct CorrectedPlacementOptions {
  LuxOfLights lux_of;   ///< the better model; empty = no correction
  int max_rounds = 3;   ///< evaluations of it
  double share = 0.5;   ///< of max_columns, for each search that continues after a correction
};

/// Cause: that of the method.
[[nodiscard]] Result<CorrectedPlacement> place_and_correct(const PlacementMethod& method,
                                                           const PlacementProblem& problem,
                                                           const PlacementOptions& options,
                                                           const CorrectedPlacementOptions& correction);

}  // namespace luxrig
