/// Directions for a hand-held lamp, for the well that the tests of relief tasks share.

#include "core/tasks/directions_task.h"

#include <gtest/gtest.h>

#include "core/plan/plan.h"
#include "core/tasks/solve_tasks.h"
#include "tests/core/tasks/relief_tasks_fixture.h"

namespace luxrig {
namespace {

using namespace relief_tasks_fixture;

const char* const kDirections = "[[task]]\nname = \"held\"\nkind = \"directions\"\nobject = \"slab\"\nlights = 2\n";
/// Half a metre beside the slab, as high as the room: only the −y side is open.
const char* const kWalls =
    "[[scene.object]]\nname = \"right\"\nbox_m = [0.1, 8, 6]\nposition_m = [0.6, 0, -2]\n"
    "[[scene.object]]\nname = \"left\"\nbox_m = [0.1, 8, 6]\nposition_m = [-0.6, 0, -2]\n"
    "[[scene.object]]\nname = \"back\"\nbox_m = [8, 0.1, 6]\nposition_m = [0, 0.6, -2]\n";

class DirectionsTask : public ReliefTask {
 protected:
  [[nodiscard]] static Result<HeldLights> directions_of(const Session& session, const ComputeOptions& options = {}) {
    return find_directions(session, session.rig.tasks[0], options);
  }
};

TEST_F(DirectionsTask, RakesAcrossTheWellFromSeparatePlacesAboveTheSlab) {
  const Session session = well(std::string(kWellRig) + kDirections);
  const auto found = directions_of(session);
  ASSERT_TRUE(found) << found.error().detail;
  ASSERT_EQ(found->directions.size(), 2);
  for (const PlannedDirection& held : found->directions) {
    EXPECT_NEAR(held.towards_world.norm(), 1, 1e-12);
    // Its walls are at most as steep as 3.8 deep over 12 wide: only raking light puts a shadow edge in it.
    EXPECT_GT(held.elevation_rad, 0);
    EXPECT_LT(held.elevation_rad, rad_from_deg(75));
    EXPECT_NEAR(std::sin(held.elevation_rad), held.towards_world.z(), 1e-12);
    EXPECT_NEAR(std::tan(held.azimuth_rad), held.towards_world.y() / held.towards_world.x(), 1e-6);
    EXPECT_NEAR((held.position_world_m - Vec3(0, 0, 1)).norm(), 1.5, 0.1) << "the slab's middle is about there";
  }
  EXPECT_LT(found->directions[0].towards_world.dot(found->directions[1].towards_world), std::cos(rad_from_deg(25)));
  EXPECT_GT(found->local_contrast_lx, 0.1);
  EXPECT_LE(found->local_contrast_lx, 2) << "two beams of 1 lx";
  EXPECT_GT(found->coverage, 0);
  EXPECT_GT(found->exposed_contrast, 0);
  EXPECT_LE(found->exposed_contrast, 1);
}

TEST_F(DirectionsTask, AvoidsPlacesBehindANearerWall) {
  const Session walled = well(std::string(kWellRig) + kDirections + kWalls);
  const auto found = directions_of(walled);
  ASSERT_TRUE(found) << found.error().detail;
  ASSERT_FALSE(found->directions.empty());
  for (const PlannedDirection& held : found->directions) {
    EXPECT_LT(std::abs(held.position_world_m.x()), 0.6);
    EXPECT_LT(held.position_world_m.y(), 0.6);
  }
  // The same walls do not matter to a lamp held in front of them. The slab looks alike from all sides, so rounding
  // decides which of its directions win.
  const std::string near = "distance_m = 0.4\n";
  const Session close = well(std::string(kWellRig) + kDirections + near + kWalls);
  const Session open = well(std::string(kWellRig) + kDirections + near);
  const auto before = directions_of(close), without = directions_of(open);
  ASSERT_TRUE(before && without);
  EXPECT_NEAR(before->exposed_contrast / without->exposed_contrast, 1, 0.03);
  EXPECT_LT(found->exposed_contrast, 0.9 * without->exposed_contrast) << "from one side";
}

TEST_F(DirectionsTask, IsRefusedWhereNoLightCanBeHeld) {
  const std::string box = "[[scene.object]]\nname = \"case\"\nbox_m = [1.2, 1.2, 1.2]\nposition_m = [0, 0, 0.4]\n";
  const Session cased = well(std::string(kWellRig) + kDirections + box);
  const auto found = directions_of(cased);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().cause, Cause::invalid);
  EXPECT_NE(found.error().detail.find("held"), std::string::npos) << found.error().detail;
  EXPECT_NE(found.error().detail.find("distance_m"), std::string::npos) << found.error().detail;
}

TEST_F(DirectionsTask, ChoosesANumberOfDirectionsUpToItsMaximum) {
  const Session session = well(replaced(std::string(kWellRig) + kDirections, "lights = 2\n", "max_lights = 3\n"));
  const auto found = directions_of(session);
  ASSERT_TRUE(found) << found.error().detail;
  EXPECT_GE(found->directions.size(), 1);
  EXPECT_LE(found->directions.size(), 3);
  ASSERT_GE(found->exposed_by_count.size(), found->directions.size());
  EXPECT_NEAR(found->exposed_by_count[found->directions.size() - 1], found->exposed_contrast, 1e-12);
}

TEST_F(DirectionsTask, StopsWhenAsked) {
  const Session session = well(std::string(kWellRig) + kDirections);
  ComputeOptions options;
  std::stop_source person;
  person.request_stop();
  options.watch.stop = person.get_token();
  const auto found = directions_of(session, options);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().cause, Cause::cancelled);
}

TEST_F(DirectionsTask, SetsNoLightAndRoundTripsInThePlan) {
  const Session session = well(std::string(kWellRig) + kDirections);
  const auto solved = solve_tasks(session, transport_of(session, direct_light()), direct_light());
  ASSERT_TRUE(solved) << solved.error().detail;
  EXPECT_EQ(solved->look.joints, hung_look(session.rig).joints);
  ASSERT_EQ(solved->plan.tasks.size(), 1);
  const PlannedTask& task = solved->plan.tasks[0];
  EXPECT_EQ(task.kind, "directions");
  EXPECT_TRUE(task.lights.empty());
  const auto read = plan_from_json(to_json(solved->plan), "plan.json");
  ASSERT_TRUE(read) << read.error()[0].text();
  ASSERT_EQ(read->tasks[0].directions.size(), 2);
  for (std::size_t k = 0; k < 2; ++k) {
    const PlannedDirection &was = task.directions[k], &is = read->tasks[0].directions[k];
    EXPECT_TRUE(is.towards_world.isApprox(was.towards_world, 1e-9));
    EXPECT_TRUE(is.position_world_m.isApprox(was.position_world_m, 1e-9));
    EXPECT_NEAR(is.azimuth_rad, was.azimuth_rad, 1e-9);
    EXPECT_NEAR(is.elevation_rad, was.elevation_rad, 1e-9);
  }
  EXPECT_TRUE(look_for(*read, session.rig, "plan.json")) << "a plan like any other";
  // This needs no daemon.
  const auto hung = solve_what_hangs(session, transport_of(session, direct_light()), direct_light());
  ASSERT_TRUE(hung) << hung.error().detail;
  for (const PlannedTask& one : hung->plan.tasks) EXPECT_NE(one.kind, "directions");
}

}  // namespace
}  // namespace luxrig
