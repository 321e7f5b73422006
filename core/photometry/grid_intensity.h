#pragma once
/// Measured intensities on a grid of angles, as a distribution: the result for every photometric file.

#include <vector>

#include "core/photometry/intensity.h"
#include "core/photometry/sphere_table.h"

namespace luxrig {

/// Axes of a table's angles in frame lamp (-Z: along the beam; +X: C plane 0). Vertical and horizontal angles of (0, 0)
/// are -Z in every type, so that any luminaire shines where it is aimed (ies.h shows how that fits LM-63).
enum class GridAxes {
  c,  ///< polar axis -Z: polar = γ, azimuth = C from +X towards +Y
  b,  ///< polar axis +Y: polar = H + 90° (H towards -Y), azimuth = V from -Z towards +X
  a   ///< polar axis -Y: polar = Y + 90° (Y towards +Y), azimuth = X from -Z towards +X
};

/// Intensity [cd] from a table in those axes. The flux is the table's integral. Directions are sampled with a density
/// of exactly intensity / flux per steradian.
[[nodiscard]] Intensity make_grid_intensity(SphereTable table, GridAxes axes);

/// The table's angles from the file's.
[[nodiscard]] std::vector<double> radians(std::vector<double> degrees, double offset_deg = 0);

}  // namespace luxrig
