#pragma once
/// What all runs of a rig share: its scene, its light, its solved plan, and the truths of its seeds. Computed once.

#include <filesystem>
#include <memory>

#include "core/plan/plan.h"
#include "core/tasks/session.h"
#include "sim/world/world.h"
#include "tools/luxrigd/light_of_looks.h"
#include "tools/scenario/scenario.h"

namespace luxrig::scenario {

struct PreparedRig {
  std::shared_ptr<const Session> session;
  Plan plan;        ///< of the rig's tasks, for what hangs
  KeptLight light;  ///< for the plan's joints
  ComputeOptions compute;  ///< with which it was computed
  std::shared_ptr<LightOfLooks> looks;
  sim::WorldMaker worlds;

  /// The simulated truth of a run.
  [[nodiscard]] Result<std::unique_ptr<sim::World>> world_of(const Scenario& scenario, std::uint64_t seed) const;
};

struct PrepareOptions {
  ComputeOptions compute;
  double max_truth_error = 0.01;
};

/// All problems of the rig; or what cannot be computed or solved, as a problem of its file.
[[nodiscard]] Checked<PreparedRig> prepare(const std::filesystem::path& rig, const PrepareOptions& options);

}  // namespace luxrig::scenario
