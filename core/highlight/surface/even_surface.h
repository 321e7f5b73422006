#pragma once
/// A surface told by evenly spread points: much the same for any mesh of it.

#include "core/highlight/surface/curvature.h"
#include "core/run.h"

namespace luxrig {

struct EvenSurfaceOptions : Run {
  double scale_m = 0;  ///< of curvature and of what is compared; positive
};

/// Points a fifth of the scale apart or more, whatever the mesh: contrast between the vertices of a mesh grows with
/// their distance, and so would what is measured between them.
struct EvenSurface {
  /// No triangles. Normals are those of the fitted surface where that is known. Points stand off the mesh by 0.3 % of
  /// its size, so that a scanner's noise does not shade them; a ring is those about 0.7 scales away that face the same
  /// half-space, one of each sixth of the way round. Each point's area is what lies nearest to it.
  TargetSurface surface;
  std::vector<Curvature> curvature;  ///< one per point
};

/// Refuses a scale that is not positive and finite, one so fine that it would take over a million points, and slivers
/// by the hundred thousand, as long as the object. Neither
/// turning nor shifting nor another mesh of the same surface changes more than which places are taken.
[[nodiscard]] Result<EvenSurface> even_surface(const TargetSurface& mesh, const EvenSurfaceOptions& options);

}  // namespace luxrig
