#pragma once
/// One run of a scenario at a venue: its events, when they are due and end; what is judged; the trace.

#include "tools/scenario/outcome.h"
#include "tools/scenario/prepared_rig.h"
#include "tools/scenario/scenario.h"
#include "tools/scenario/venue.h"

namespace luxrig::scenario {

struct ShowOptions {
  bool trace = false;            ///< record Outcome::trace
  bool answers_expected = true;  ///< a command that is refused or accepted against its `refused` is an error
};

[[nodiscard]] Outcome run_show(Venue& venue, const PreparedRig& rig, const Scenario& scenario, std::uint64_t seed,
                               const ShowOptions& options);

}  // namespace luxrig::scenario
