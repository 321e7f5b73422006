#pragma once
/// A surface as evenly spread points: nearly the same for any mesh of it.

#include "core/highlight/surface/curvature.h"
#include "core/run.h"

namespace luxrig {

struct EvenSurfaceOptions : Run {
  double scale_m = 0;  ///< of curvature and of the distance between compared points; positive
};

/// Points at least a fifth of the scale apart, whatever the mesh. Contrast between mesh vertices would grow with their
/// distance, and any measure on them would too.
struct EvenSurface {
  /// No triangles. Normals are those of the fitted surface where known. Points stand off the mesh by 0.3 % of its size,
  /// so that a scanner's noise does not shade them. A ring has one point from each sixth of the way round, about 0.7
  /// scales away and facing the same half-space. A point's area is the surface nearest to it.
  TargetSurface surface;
  std::vector<Curvature> curvature;  ///< one per point
};

/// Refuses a scale that is not positive and finite, a scale that would need over a million points, and hundreds of
/// thousands of slivers as long as the object. Rotation, translation or another mesh of the same surface changes only
/// which places are chosen.
[[nodiscard]] Result<EvenSurface> even_surface(const TargetSurface& mesh, const EvenSurfaceOptions& options);

}  // namespace luxrig
