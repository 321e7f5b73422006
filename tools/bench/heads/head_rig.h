#pragma once
/// Rigs of the suite `heads`: a hall with eight heads under its ceiling, plinths, a poster, a mirror on a wall, and six
/// luxmeters.

#include <cstdint>

#include "core/picture/picture.h"
#include "core/rig/rig.h"
#include "core/scene/scene.h"

namespace luxrig {

struct HeadRig {
  Rig rig;  ///< as stated
  Scene scene;
  Camera camera;
};

/// Size of the hall, places of the heads, their beams and the camera are of the seed.
[[nodiscard]] HeadRig head_rig(std::uint64_t seed);

}  // namespace luxrig
