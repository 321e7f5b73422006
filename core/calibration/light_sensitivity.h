#pragma once
/// The light of a rig and its change with what is not known of it (LightSensitivity), from the rig's own scene.
///
/// Mounts: differences of direct light over one standard deviation of a mount, so that a beam's edge counts as what it is
/// over the distance that matters; indirect light is taken as unchanged. Paint: the light traced anew with each
/// material's reflectance raised, with the same samples.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/calibration/light_unknowns.h"
#include "core/result.h"
#include "core/rig/rig.h"
#include "core/scene/ray_scene.h"
#include "core/scene/scene.h"
#include "core/tasks/light.h"
#include "core/transport/evaluator.h"

namespace luxrig {

/// `lux`, `mount` and `bend` at mounts that are off by `mounts` (one per fixture; empty = as in the rig file).
/// light: of all_emitters_of(rig) at receivers_of(rig), as in the rig file.
[[nodiscard]] Result<LightSensitivity> mount_sensitivity(const Rig& rig, const RayScene& rays,
                                                         const TransportMatrix& light, const LightPriors& priors,
                                                         std::span<const Eigen::VectorXd> mounts = {});

/// LightSensitivity::paint, one per material of the scene. Materials that reflect nothing have zeros.
/// light: as above, computed with the same options.
[[nodiscard]] Result<std::vector<Eigen::MatrixXd>> paint_sensitivity(const Rig& rig, const Scene& scene,
                                                                     const TransportMatrix& light,
                                                                     const ComputeOptions& options);

}  // namespace luxrig
