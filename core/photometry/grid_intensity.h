#pragma once
/// Measured intensities on a grid of angles as a distribution: what every photometric file ends in.

#include <vector>

#include "core/photometry/intensity.h"
#include "core/photometry/sphere_table.h"

namespace luxrig {

/// How a table's angles lie in frame lamp (+X: C plane 0; -Z: nadir). From IES LM-75 and the definitions of LM-63-2002:
/// vertical and horizontal angles of (0, 0) point to the nadir in types B and C and horizontally along +X in type A;
/// horizontal angles turn counter-clockwise seen from above in type C and clockwise in types A and B.
enum class GridAxes {
  c,       ///< polar axis -Z: polar = γ, azimuth = C from +X towards +Y
  b,       ///< polar axis +Y: polar = H + 90° (H towards -Y), azimuth = V from -Z towards +X
  a,       ///< polar axis -Z: polar = Y + 90° (Y upwards), azimuth = X from +X towards -Y
  about_x  ///< polar axis +X, for round tables: a round beam of type A
};

/// Intensity [cd] from a table in those axes. Flux is the table's integral; directions are drawn with exactly
/// intensity / flux per steradian.
[[nodiscard]] Intensity make_grid_intensity(SphereTable table, GridAxes axes);

/// The table's angles from the file's.
[[nodiscard]] std::vector<double> radians(std::vector<double> degrees, double offset_deg = 0);

}  // namespace luxrig
