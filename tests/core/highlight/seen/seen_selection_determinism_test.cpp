/// SeenSelection: the same for any number of threads.
#include <gtest/gtest.h>

#include "core/highlight/seen/seen_selection.h"
#include "tests/core/highlight/seen/seen_fixture.h"

namespace luxrig {
namespace {

using namespace seen_fixture;

TEST(SeenSelection, DoesNotDependOnTheThreads) {
  const RayScene object(ridges(5, 0.015));
  const SeenContrast seen({view_on(object, object, {0, 0, 3}, 32)}, {});
  const Intensity lamp = make_cosine_power(1000, 3);
  std::vector<SeenChoice> choices;
  for (const int threads : {1, 2, 5}) {
    SeenSelectionOptions how;
    how.threads = threads;
    std::vector<SeenCandidate> lights;
    for (int k = 0; k < 12; ++k) {
      const Vec3 at = 2 * at_height(10 + 12 * k);
      lights.push_back({at, -at.normalized()});
    }
    choices.push_back(SeenSelection(seen, object, std::move(lights), *lamp, {}, how).up_to(3).back());
  }
  for (const SeenChoice& choice : choices) {
    EXPECT_EQ(choice.candidates, choices[0].candidates);
    EXPECT_EQ(choice.levels, choices[0].levels);
    EXPECT_EQ(choice.score.objective, choices[0].score.objective);
  }
}

}  // namespace
}  // namespace luxrig
