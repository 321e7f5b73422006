/// judged_lights: accuracy over many samples.
#include <gtest/gtest.h>

#include "core/highlight/lights/judged_lights.h"
#include "core/highlight/lights/mounted_lights.h"
#include "core/highlight/surface/relief_study.h"
#include "core/photometry/beam.h"
#include "tests/core/highlight/lights/judged_lights_fixture.h"
#include "tests/core/highlight/shapes.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig {
namespace {

using namespace judged_lights_fixture;

TEST(JudgedLights, AreNeverWorseThanThoseChosenByVotes) {
  for (const Scene& scene : {make_carved_relief(0.02), make_terrain(100, 50)}) {
    const ReliefStudy study = studied_for_lights(scene);
    const Intensity spot = make_spot(1000, rad_from_deg(20), rad_from_deg(40));
    NestedBoxOptions boxes;
    boxes.margin_m = boxes.step_m = study.surface.diagonal_m() / 2;
    boxes.cell_side = 4;
    const auto domain = nested_box_domain(study.surface, boxes);
    ASSERT_TRUE(domain);
    const auto edges = find_shadow_edges(study.rays, study.points, {});
    ASSERT_TRUE(edges);
    const auto votes = vote_on_domain(*domain, *edges, study.points, study.features.cluster_of_point, {});
    ASSERT_TRUE(votes);
    PotentialLightOptions of_lights;
    of_lights.beam_angle_rad = cone_of_flux_rad(*spot, 0.9);
    const auto voted = potential_lights(*votes, of_lights);
    ASSERT_TRUE(voted);
    std::vector<Vec3> places;
    for (const auto& centre : domain->cell_centres()) places.push_back(centre.position_world_m);
    const auto judged =
        JudgedLights::make(study.surface, study.rays, study.interest, study.features, places, *voted, spot, {});
    ASSERT_TRUE(judged);

    for (const int lights : {2, 3, 4}) {
      LightSelection by_votes(*voted);
      JudgedSelection same = judged->selection();
      while (same.taken().size() < static_cast<std::size_t>(lights)) {
        const auto next = by_votes.add();
        if (!next) break;
        const PotentialLight& light = voted->lights[*next];
        const auto candidates = judged->candidates();
        const auto found = std::ranges::find_if(candidates, [&](const JudgedLight& one) {
          return one.position_world_m == light.position_world_m && one.direction == light.direction;
        });
        ASSERT_NE(found, candidates.end());
        const auto candidate = static_cast<std::uint32_t>(found - candidates.begin());
        if (same.stands_apart(candidate)) same.add(candidate);
      }
      ASSERT_GT(same.taken().size(), 1u);
      EXPECT_GE(judged->lights(lights)->score.judged, same.score().judged);
      EXPECT_GE(judged->count_lights(lights)->by_number.back().score.judged, same.score().judged);
    }
  }
}

}  // namespace
}  // namespace luxrig
