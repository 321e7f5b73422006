#pragma once
/// A mesh as samples that represent its area.

#include "core/highlight/surface/sample_grid.h"
#include "core/highlight/surface/target_surface.h"

namespace luxrig {

/// The surface's points. Facets with an edge above longest_m are cut into pieces with edges up to edge_m instead,
/// unless a facet would give more than max_pieces: then it counts by its corners alone. Areas sum to the surface's.
[[nodiscard]] std::vector<SurfaceSample> surface_samples(const TargetSurface& surface, double longest_m, double edge_m,
                                                         double max_pieces);

/// Approximate number of those pieces, without max_pieces; takes less time and no memory.
[[nodiscard]] double pieces_of_surface(const TargetSurface& surface, double longest_m, double edge_m);

}  // namespace luxrig
