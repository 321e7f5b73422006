#include "core/highlight/surface/relief_study.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.h"

namespace luxrig {

Result<ReliefStudy> study_relief(const Scene& target, const ReliefStudyOptions& options) {
  auto mesh = make_target_surface(target);
  if (!mesh) return tl::unexpected(mesh.error());
  if (mesh->triangles.empty())
    return refusal(target.triangles.empty() ? "the target has no triangles: light and shadow need a surface, not points"
                                            : "no triangle of the target has any area");
  ReliefStudy study{std::move(*mesh), TargetRays(target), options.scale_m, {}, {}, {}, {}, {}};
  if (study.scale_m == 0) study.scale_m = suggested_curvature_radius_m(study.mesh);
  auto even = even_surface(study.mesh, {options.of_part(), study.scale_m});
  if (!even) return tl::unexpected(even.error());
  study.surface = std::move(even->surface);
  study.curvature = std::move(even->curvature);
  if (std::ranges::none_of(study.curvature, [](const Curvature& c) { return c.known(); }))
    return refusal("the target's curvature is not known anywhere: too few points within the scale");
  auto interest = interest_points(study.surface, study.curvature, options.interest);
  if (!interest) return tl::unexpected(interest.error());
  study.interest = std::move(*interest);
  if (study.interest.empty())
    return refusal("the target has no recessed places at this scale: there is no relief that a light could bring out");
  double area_m2 = 0;
  for (const std::uint32_t i : study.interest) {
    study.points.push_back({study.surface.point_world_m(i), study.surface.normals[i]});
    area_m2 += study.surface.areas_m2[i];
  }
  FeatureOptions features;
  features.largest_angle_rad = options.largest_angle_rad;
  // Thinned-out points lie farther apart than their own areas suggest; a feature is about as wide as the scale.
  features.link_m = std::max(study.scale_m, 3 * std::sqrt(area_m2 / static_cast<double>(study.interest.size())));
  auto clusters = cluster_features(study.points, features);
  if (!clusters) return tl::unexpected(clusters.error());
  study.features = std::move(*clusters);
  return study;
}

void keep_interest(ReliefStudy& study, const std::vector<bool>& kept) {
  LUXRIG_CHECK(kept.size() == study.interest.size(), "{} marks for {} points", kept.size(), study.interest.size());
  constexpr auto kGone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(study.features.sizes.size(), kGone);
  FeatureClusters features;
  std::size_t count = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (!kept[i]) continue;
    std::uint32_t& feature = number[study.features.cluster_of_point[i]];
    if (feature == kGone) {
      feature = static_cast<std::uint32_t>(features.sizes.size());
      features.sizes.push_back(0);
    }
    ++features.sizes[feature];
    features.cluster_of_point.push_back(feature);
    study.interest[count] = study.interest[i];
    study.points[count] = study.points[i];
    ++count;
  }
  study.interest.resize(count);
  study.points.resize(count);
  study.features = std::move(features);
}

}  // namespace luxrig
