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

/// A life-size head with neck, 32 cm high, closed. Its face looks towards -Y; the origin lies between the ears.
[[nodiscard]] Scene make_head(double cell_m = 0.002);

/// A helmet of plate with slits and a crest, 36 cm high, open below. Its face looks towards -Y.
[[nodiscard]] Scene make_helmet(double cell_m = 0.002);

/// A slab of 36 × 16 cm with capitals cut into it, grooves of 5 mm with sides of 45°; its front faces -Y.
[[nodiscard]] Scene make_inscription(double cell_m = 0.0015);

}  // namespace luxrig
