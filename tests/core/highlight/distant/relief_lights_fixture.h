#pragma once
/// Shared by the tests of relief_lights.

#include <gtest/gtest.h>

#include "core/highlight/distant/relief_lights.h"
#include "core/highlight/shadow/relief_contrast.h"
#include "core/highlight/surface/relief_study.h"
#include "tests/core/highlight/shapes.h"

namespace luxrig::relief_lights_fixture {

inline ReliefStudy studied(const Scene& scene, std::size_t most) {
  ReliefStudyOptions options;
  options.interest.max_points = most;
  auto study = study_relief(scene, options);
  EXPECT_TRUE(study);
  return std::move(*study);
}

inline ReliefLightSearch searched(const ReliefStudy& study, const ReliefLightOptions& options) {
  auto search = ReliefLightSearch::make(study.surface, study.rays, study.interest, options);
  EXPECT_TRUE(search);
  return std::move(*search);
}

inline double contrast_by_rays(const ReliefStudy& study, const std::vector<Vec3>& directions) {
  std::vector<DistantBeam> beams;
  for (const Vec3& direction : directions) beams.push_back({direction, 1});
  return relief_contrast(study.surface, study.rays, study.interest, beams, 0, 0).local_contrast_lx;
}

inline LitTable table_of(const ReliefStudy& study, const ContrastSamples& samples, int side, bool every_ray) {
  LitTableOptions options;
  options.every_ray = every_ray;
  auto table = find_lit_bins(study.rays, samples, DirectionBins(side), options);
  EXPECT_TRUE(table);
  return std::move(*table);
}

}  // namespace luxrig::relief_lights_fixture
