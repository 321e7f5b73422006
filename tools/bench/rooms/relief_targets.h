#pragma once
/// Made-up objects with relief: what highlighting is tested and measured on. The same for the same arguments.

#include <cstdint>

#include "core/scene/scene.h"

namespace luxrig {

/// An upright slab of 1.2 × 0.8 m, 8 cm thick, closed, with a raised border and three standing figures, half round, on
/// its front, which looks towards -Y; its middle is the origin. At cell_m = 5 mm about 100 000 triangles.
[[nodiscard]] Scene make_carved_relief(double cell_m = 0.005);

/// Hills cut by valleys over a square in x and y about the origin, facing up, open: 2 · split² triangles. Heights are a
/// sum of five octaves of lattice noise with sharp valleys, about an eighth of the side in all.
[[nodiscard]] Scene make_terrain(double side_m = 100, int split = 160, std::uint64_t seed = 1);

}  // namespace luxrig
