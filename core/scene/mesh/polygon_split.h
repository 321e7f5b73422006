#pragma once
/// Splits polygons into triangles. Internal to core/scene.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

/// Appends points.size() - 2 triangles as indices into `points`, wound like the polygon. They cover a simple, roughly
/// flat polygon exactly once. A polygon that crosses itself is cut at its corners in turn.
void split_polygon(std::span<const Vec3> points, std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace luxrig
