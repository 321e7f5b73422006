#pragma once
/// One run of a scenario in this process: the daemon itself, on a simulated rig without wires, under a clock that is
/// stepped by 20 ms. The same scenario, rig and seed give the same outcome, bit for bit. One at a time in a process:
/// the clock is the process's own.

#include "tools/scenario/show.h"

namespace luxrig::scenario {

/// Faults that a rig without wires has no part for; a scenario with one has to be run on the wire.
[[nodiscard]] bool acts_without_wires(sim::FaultKind fault);

[[nodiscard]] Outcome run_stepped(const PreparedRig& rig, const Scenario& scenario, std::uint64_t seed,
                                  const ShowOptions& options = {});

}  // namespace luxrig::scenario
