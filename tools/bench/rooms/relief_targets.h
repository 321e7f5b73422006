#pragma once
/// Made-up objects with relief, to test and measure highlighting on. The same for the same arguments.

#include <cstdint>

#include "core/scene/scene.h"

namespace luxrig {

/// An upright slab of 1.2 × 0.8 m, 8 cm thick, closed. Its front faces -Y and has a raised border and three standing
/// figures in half relief. The origin is in its middle. At cell_m = 5 mm about 100 000 triangles.
[[nodiscard]] Scene make_carved_relief(double cell_m = 0.005);

/// Hills with valleys over a square in x and y around the origin, facing up, open: 2 · split² triangles. Heights are
/// the sum of five octaves of lattice noise with sharp valleys, about an eighth of the side in total.
[[nodiscard]] Scene make_terrain(double side_m = 100, int split = 160, std::uint64_t seed = 1);

}  // namespace luxrig
