#pragma once
/// Curvature of a surface at a given scale.

#include <vector>

#include "core/highlight/surface/target_surface.h"
#include "core/run.h"

namespace luxrig {

/// At one point. Curvatures are positive where the surface bulges outwards (a sphere of radius R with outward normals:
/// 1/R both ways) and negative where it is recessed.
struct Curvature {
  double radius_m = 0;  ///< of the fitted neighbourhood; 0 = unknown, and no other field is valid
  double larger_per_m = 0, smaller_per_m = 0;                              ///< principal curvatures, larger ≥ smaller
  Vec3 larger_direction = Vec3::Zero(), smaller_direction = Vec3::Zero();  ///< unit tangents, signs arbitrary
  Vec3 normal = Vec3::Zero();                                              ///< unit, outwards, of the fitted surface
  double mean_error_per_m = 0;  ///< standard error of the mean curvature, from the residual of the fit

  [[nodiscard]] bool known() const { return radius_m > 0; }
  [[nodiscard]] double mean_per_m() const { return (larger_per_m + smaller_per_m) / 2; }
};

struct CurvatureOptions : Run {
  /// Scale: features much smaller than this are smoothed away. If fewer than nine samples of the surface are within it,
  /// twice the radius is tried once.
  double radius_m = 0;
};

/// A scale for an unknown object: 3 % of its size, at least 1.5 times its median edge. 0 for a surface without
/// triangles.
[[nodiscard]] double suggested_curvature_radius_m(const TargetSurface& surface);

/// One per point of the surface, bit-identical for any number of threads.
///
/// A quadric (all six terms) over the tangent plane is fitted to the surface within the radius: least squares, weighted
/// by the area of each sample and by (1 - distance² / radius²)². Curvatures are those of the quadric above the point.
/// So dense and sparse parts of a mesh weigh by area. Samples are vertices; facets longer than the radius are cut up.
/// If a neighbourhood would hold several hundred vertices, they are merged in cells of an eighth of the radius. Parts
/// of the surface that face away (the back of a thin sheet) are left out.
///
/// Error: on a sphere of radius R about +0.17 (radius / R)² of the curvature, as the quadric leaves out the fourth
/// order (tests/core/highlight/surface/curvature_test.cpp); white noise along the normal adds mean_error_per_m. Unknown
/// where samples are too few or lie on a line, and where normals cancel.
/// Refuses a radius that is not positive and finite. Source: quadric patches as in F. Cazals, M. Pouget, "Estimating
/// differential quantities using polynomial fitting of osculating jets", 2005, degree 2; the thesis (§6.2) fits
/// algebraic spheres (MeshLab's APSS).
[[nodiscard]] Result<std::vector<Curvature>> curvature_of(const TargetSurface& surface,
                                                          const CurvatureOptions& options);

/// The same at any places of the surface (relative to its origin), one per place.
/// facing   approximate unit normals there; unknown where zero. One per place (asserted).
[[nodiscard]] Result<std::vector<Curvature>> curvature_at(const TargetSurface& surface, std::span<const Vec3> places_m,
                                                          std::span<const Vec3> facing,
                                                          const CurvatureOptions& options);

}  // namespace luxrig
