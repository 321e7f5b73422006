#pragma once
/// An object made ready for highlighting: all that its lights are chosen from.

#include <optional>

#include "core/highlight/surface/even_surface.h"
#include "core/highlight/surface/feature_clusters.h"
#include "core/highlight/surface/interest_points.h"
#include "core/run.h"

namespace luxrig {

struct ReliefStudyOptions : Run {
  double scale_m = 0;  ///< of curvature; 0: suggested
  InterestOptions interest = {{}, 0.1, 0.02, 3000};
  double largest_angle_rad = rad_from_deg(36);  ///< of a feature
};

struct ReliefStudy {
  TargetSurface mesh;  ///< what was given
  TargetRays rays;
  double scale_m = 0;
  TargetSurface surface;                ///< the same told by evenly spread points: even_surface.h
  std::vector<Curvature> curvature;     ///< per point of the surface
  std::vector<std::uint32_t> interest;  ///< points of the surface
  std::vector<OrientedPoint> points;    ///< the same, with normals
  FeatureClusters features;             ///< of them; linked within three times their typical spacing, or the scale
};

/// Mesh to features. Refuses, saying what is missing: a mesh without triangles (a cloud of points), one of which no
/// curvature is known, one without recessed places (a plain sphere, a plane).
[[nodiscard]] Result<ReliefStudy> study_relief(const Scene& target, const ReliefStudyOptions& options);

/// Only these of its interest points (one mark each), and the features that they are of. Asserts one mark per point.
void keep_interest(ReliefStudy& study, const std::vector<bool>& kept);

}  // namespace luxrig
