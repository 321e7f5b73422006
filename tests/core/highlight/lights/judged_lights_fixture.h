#pragma once
/// Shared by the tests of judged_lights.

#include <gtest/gtest.h>

#include "core/highlight/lights/light_domain.h"
#include "core/highlight/surface/relief_study.h"
#include "tests/core/highlight/shapes.h"

namespace luxrig::judged_lights_fixture {

inline ReliefStudy studied_for_lights(const Scene& scene) {
  ReliefStudyOptions options;
  options.interest.max_points = 200;
  auto study = study_relief(scene, options);
  EXPECT_TRUE(study);
  return std::move(*study);
}

inline std::vector<Vec3> places_around(const ReliefStudy& study, int cell_side) {
  NestedBoxOptions boxes;
  boxes.boxes = 2;
  boxes.cell_side = cell_side;
  const auto domain = nested_box_domain(study.surface, boxes);
  EXPECT_TRUE(domain);
  std::vector<Vec3> places;
  for (const auto& centre : domain->cell_centres()) places.push_back(centre.position_world_m);
  return places;
}

}  // namespace luxrig::judged_lights_fixture
