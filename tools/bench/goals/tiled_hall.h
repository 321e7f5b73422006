#pragma once
/// A colonnade of any number of triangles, to paint on.

#include "core/scene/scene.h"

namespace luxrig {

/// A hall of 24 × 12 × 5 m with 32 columns of 0.35 m radius: about 1 290 m² of surface in right triangles of nearly one
/// size, about `triangles` of them.
[[nodiscard]] Scene make_tiled_hall(std::size_t triangles);

}  // namespace luxrig
