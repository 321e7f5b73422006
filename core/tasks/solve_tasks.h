#pragma once
/// What the rig's `[[task]]` entries ask, done one after the other.

#include "core/plan/plan.h"
#include "core/result.h"
#include "core/tasks/session.h"

namespace luxrig {

struct SolvedTasks {
  Plan plan;
  Rig rig;                          ///< placed lights are its last fixtures
  Look look;                        ///< levels and joints as the plan has them
  TransportMatrix transport;        ///< of that rig and look
  std::optional<ModelUsed> anew{};  ///< how that was computed, when it is no longer the one given
};

/// All tasks. Goals and limits count all light, daylight too; light that one task has set or placed counts in the next.
/// transport   made by compute_transport(session)
/// A search ends early, with its best so far, when options.watch.stop is requested, and tasks after it are left out;
/// without any, and elsewhere: Cause::cancelled. Cause::invalid when light that no task may change (daylight, say) is
/// alone above a limit, or an object has no relief that its task could bring out.
[[nodiscard]] Result<SolvedTasks> solve_tasks(const Session& session, const TransportMatrix& transport,
                                              const ComputeOptions& options);

/// Whether a task before this one sets levels. If none does, heads that an aim task turns are compared with themselves
/// as they hang, as bright as they may be: dark heads have nothing to compare with.
[[nodiscard]] bool levels_set_before(const Rig& rig, const std::string& task_name);

/// Name of the task in such a plan.
inline constexpr const char* kAsItHangs = "as it hangs";

/// What a rig that hangs can do: tasks that place no lights, and one called "levels" without any.
/// aim   false: heads stay where they look. Where there is then neither a task nor a goal, every lamp is as bright as it
///       may be, so that there is something to see.
[[nodiscard]] Result<SolvedTasks> solve_what_hangs(const Session& session, const TransportMatrix& transport,
                                                   const ComputeOptions& options, bool aim = true);

}  // namespace luxrig
