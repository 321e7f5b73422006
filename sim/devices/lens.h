#pragma once
/// A camera's lens and colour response as they are: where it really hangs and looks, what it loses towards the corners,
/// what it scatters, and how it sees each kind of lamp.

#include <cstddef>
#include <vector>

#include "core/picture/picture.h"
#include "core/rig/rig.h"
#include "core/scene/ray_scene.h"
#include "sim/world/deviations.h"

namespace luxrig::sim {

/// True properties of one camera. The defaults are a perfect one.
struct CameraTruth {
  Camera view;               ///< pose, field of view and distortion
  double corner_loss = 0;    ///< share of the light lost in a corner, 0 … 1; towards it as cos⁴ of an angle
  double flare = 0;          ///< share of all light that is spread evenly over the picture
  double halo = 0;           ///< share of each pixel's light that is spread around it
  double halo_reach_px = 0;  ///< standard deviation of that along x and along y
  /// Per luminaire of the rig, then of daylight: reading over what the eye sees. Empty = 1.
  std::vector<double> response{};
};

/// What the seed gives this camera. index: among the rig's cameras, for the draw.
/// room: the lens is drawn behind no surface of it, seen from where the file has it; null = anywhere.
[[nodiscard]] CameraTruth draw_camera(const Rig& rig, const PictureCamera& camera, std::size_t index,
                                      const Deviations& deviations, const RayScene* room = nullptr);

/// What the lens makes of the light, in place: loss towards the corners, then halo and flare. All light that passes the
/// aperture arrives.
void through_lens(const CameraTruth& truth, Picture& picture);

}  // namespace luxrig::sim
