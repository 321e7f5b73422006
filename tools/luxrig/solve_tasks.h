#pragma once
/// What the rig's `[[task]]` entries ask, done one after the other.

#include "core/control/plan.h"
#include "core/result.h"
#include "tools/luxrig/session.h"

namespace luxrig {

/// All tasks. Goals and limits count all light, daylight too; light that one task has set or placed counts in the next.
/// transport   made by compute_transport(session)
/// A placement ends early, with its best so far, when options.watch.stop is requested, and tasks after it are left out;
/// without any, and elsewhere: Cause::cancelled. Cause::invalid when light that no task may change (daylight, say) is
/// alone above a limit.
[[nodiscard]] Result<Plan> solve_tasks(const Session& session, const TransportMatrix& transport,
                                       const ComputeOptions& options);

/// Emittance tasks alone, and one called "levels" without any: what a rig that hangs can do.
[[nodiscard]] Result<Plan> solve_levels(const Session& session, const TransportMatrix& transport,
                                        const ComputeOptions& options);

}  // namespace luxrig
