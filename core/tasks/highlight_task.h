#pragma once
/// One highlight task: places new lights where the mounting allows (core/highlight/lights/judged_lights.h), then aims
/// and dims them like heads that already hang (aim_heads.h).

#include "core/solve/placement/scene/mounting.h"
#include "core/solve/placement/scene/place_in_scene.h"
#include "core/tasks/relief_task.h"

namespace luxrig {

struct PlacedReliefLights {
  std::vector<LightInScene> lights;
  AimScore score;
  std::vector<double> contrast_lx;  ///< of one light, two, … at full level; empty if the number was given
  std::size_t tried = 0;
  std::vector<AimScore> without;   ///< per light: the score with it dark
  std::vector<double> dark_gains;  ///< of lights that were chosen and stay dark: AimResult::gain_if_lit
  AskedOfLight asked;              ///< by the task's role
};

/// Refuses with a reason if no light that may hang brings out any of the object's relief.
[[nodiscard]] Result<PlacedReliefLights> find_relief_lights(const ReliefSurroundings& around,
                                                            const StudiedObject& object, const Task& task,
                                                            const Mounting& mounting, const ComputeOptions& options);

}  // namespace luxrig
