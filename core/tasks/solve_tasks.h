#pragma once
/// Solves the rig's `[[task]]` entries, one after the other.

#include "core/plan/plan.h"
#include "core/result.h"
#include "core/tasks/relief_reasons.h"
#include "core/tasks/session.h"

namespace luxrig {

struct SolvedTasks {
  Plan plan;
  Rig rig;                          ///< placed lights are its last fixtures
  Look look;                        ///< levels and joints of the plan
  TransportMatrix transport;        ///< of that rig and look
  std::optional<ModelUsed> anew{};  ///< how `transport` was computed, if it is no longer the one given
  std::vector<ReliefReasons> reasons{};  ///< of its tasks of kind "aim" and "highlight", in their order
};

/// Solves all tasks. Goals and limits count all light, daylight too. Light set or placed by a task counts in the next.
/// transport   made by compute_transport(session)
/// If options.watch.stop is requested, a search ends early with its best so far, and later tasks are left out.
/// Cause::cancelled if there is no result yet, and elsewhere. Cause::invalid if light that no task may change (say,
/// daylight) exceeds a limit by itself, or if an object has no relief that its task could bring out.
[[nodiscard]] Result<SolvedTasks> solve_tasks(const Session& session, const TransportMatrix& transport,
                                              const ComputeOptions& options);

/// Whether an earlier task sets levels. If none does, heads that an aim task turns are compared with themselves as
/// hung, at full permitted level: dark heads have nothing to compare with.
[[nodiscard]] bool levels_set_before(const Rig& rig, const std::string& task_name);

/// Name of the task when, without any task or goal, every lamp is lit as it hangs.
inline constexpr const char* kAsItHangs = "as it hangs";

/// Solves for a rig that already hangs: tasks that place no lights, and one called "levels" if there is no task.
/// aim   false: heads keep their aim. Without any task or goal, every lamp is then as bright as permitted, so that
///       there is something to see.
[[nodiscard]] Result<SolvedTasks> solve_what_hangs(const Session& session, const TransportMatrix& transport,
                                                   const ComputeOptions& options, bool aim = true);

}  // namespace luxrig
