#pragma once
/// An object prepared for highlighting: everything needed to choose its lights.

#include <optional>

#include "core/highlight/surface/even_surface.h"
#include "core/highlight/surface/feature_clusters.h"
#include "core/highlight/surface/interest_points.h"
#include "core/run.h"

namespace luxrig {

struct ReliefStudyOptions : Run {
  double scale_m = 0;  ///< of curvature; 0 = suggested
  InterestOptions interest = {{}, 0.1, 0.02, 3000};
  double largest_angle_rad = rad_from_deg(36);  ///< of a feature
};

struct ReliefStudy {
  TargetSurface mesh;  ///< as given
  TargetRays rays;
  double scale_m = 0;
  TargetSurface surface;                ///< the same as evenly spread points: even_surface.h
  std::vector<Curvature> curvature;     ///< per point of the surface
  std::vector<std::uint32_t> interest;  ///< points of the surface
  std::vector<OrientedPoint> points;    ///< the same, with normals
  FeatureClusters features;             ///< of the points; linked within 3 × their typical spacing, or the scale
};

/// From mesh to features. Refuses, naming what is missing: a mesh without triangles (a point cloud), one without known
/// curvature, one without recessed places (a plain sphere, a plane).
[[nodiscard]] Result<ReliefStudy> study_relief(const Scene& target, const ReliefStudyOptions& options);

/// Keeps only these interest points (one flag each) and their features. Asserted: one flag per point.
void keep_interest(ReliefStudy& study, const std::vector<bool>& kept);

}  // namespace luxrig
