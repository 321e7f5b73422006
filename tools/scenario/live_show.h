#pragma once
/// One run of a scenario in real time and over the wire: luxrigd and its guardian as they are, through their real
/// drivers, on a simulated rig that this process serves. What runs is not repeatable to the bit, so rules and
/// expectations get the slack that live_show.cpp states. Faults of the wire act here.
///
/// The daemon finds the solved plan in its state folder, with the light worked out, as after a power cut: it goes on from
/// there. The show's time begins when it has.

#include <stop_token>

#include "tools/scenario/show.h"

namespace luxrig::scenario {

/// May run in several processes at once. A run that `stop` ends has an error.
[[nodiscard]] Outcome run_live(const PreparedRig& rig, const Scenario& scenario, std::uint64_t seed,
                               const ShowOptions& options, const std::stop_token& stop);

}  // namespace luxrig::scenario
