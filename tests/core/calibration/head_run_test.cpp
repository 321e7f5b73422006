#include "core/calibration/head_run.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/calibration/beam_room.h"

namespace luxrig {
namespace {

/// A head in the room, its light without noise, and what it does with what it is sent.
struct RunInRoom {
  BeamRoom room;
  HeadSetup setup;
  HeadPose truth;
  bool stuck = false, somebody_else = false, no_light = false;
  int steps = 0;

  explicit RunInRoom(const HeadKind& kind = {}) {
    setup.stated = {Mat3::Identity(), Vec3(4.2, 3.4, 3.2)};
    setup.pan_speed_rad_s = setup.tilt_speed_rad_s = kPi;
    setup.beam_radius_rad = rad_from_deg(6);
    truth = start_of(setup.stated, kind);
    truth.parameters.head<6>() << 0.05, -0.08, 0.03, 0.03, -0.02, 0.05;
    truth.parameters.segment<2>(kHeadAskew) << 0.02, -0.03;
    truth.parameters.segment<2>(kHeadPanPlay) << 0.02, 0.012;
  }

  HeadResult run() {
    HeadRun run(room.surface, room.rays, setup);
    Joints before;
    while (const auto step = run.next()) {
      EXPECT_LT(++steps, 300);
      EXPECT_LE(std::abs(step->joints.pan_rad), setup.range.pan_max_rad + 1e-9);
      EXPECT_LE(std::abs(step->joints.tilt_rad), setup.range.tilt_max_rad + 1e-9);
      Approach from{step->joints.pan_rad > before.pan_rad ? 1 : -1, step->joints.tilt_rad > before.tilt_rad ? 1 : -1};
      if (step->lit) {
        EXPECT_GE(std::abs(step->joints.pan_rad - before.pan_rad), kRunUp_rad - 1e-9) << "play is taken up";
        EXPECT_GE(std::abs(step->joints.tilt_rad - before.tilt_rad), kRunUp_rad - 1e-9);
      }
      before = step->joints;
      Picture picture = room.dark();
      const Joints turned = stuck ? Joints{0.5, 0.7, 0} : step->joints;
      if (step->lit && !no_light) room.add_beam(picture, truth.pivot_world_m(), truth.beam_world(turned, from));
      // Another lamp that comes on after the first dark picture.
      if (somebody_else && steps > 1) room.add_beam(picture, Vec3(2, 5, 3), Vec3(0.5, -0.2, -1).normalized());
      run.take(picture);
    }
    return run.result();
  }

  /// Largest error over the floor.
  [[nodiscard]] double worst_rad(const HeadFit& fit) const {
    double worst = 0;
    for (double x = 1; x < 8; x += 1)
      for (double y = 1; y < 7; y += 1) {
        const Vec3 place_m(x, y, 0);
        const auto sent = fit.pose.joints_towards(place_m - fit.pose.pivot_world_m(), {}, setup.range, {});
        if (!sent) continue;
        const Vec3 beam = truth.beam_world(*sent, {}), wanted = (place_m - truth.pivot_world_m()).normalized();
        worst = std::max(worst, std::atan2(beam.cross(wanted).norm(), beam.dot(wanted)));
      }
    return worst;
  }
};

TEST(HeadRun, FindsAHeadOfAnyKind) {
  for (const HeadKind& kind : {HeadKind{}, HeadKind{true, false, false, 1}, HeadKind{false, true, false, 1},
                               HeadKind{false, false, false, 540.0 / 630.0}}) {
    RunInRoom of(kind);
    const HeadResult result = of.run();
    ASSERT_FALSE(result.refused) << words_of(kind) << ": " << *result.refused;
    EXPECT_TRUE(result.fit.kind == kind) << words_of(result.fit.kind);
    EXPECT_LT(of.worst_rad(result.fit), rad_from_deg(0.05)) << words_of(kind);
    EXPECT_GE(result.held_out.size(), 5U);
    EXPECT_LT(of.steps, 100);
  }
}

TEST(HeadRun, RefusesAHeadThatDoesNotTurn) {
  RunInRoom of;
  of.stuck = true;
  EXPECT_TRUE(of.run().refused);
}

TEST(HeadRun, RefusesALampThatGivesNoLight) {
  RunInRoom of;
  of.no_light = true;
  const HeadResult result = of.run();
  ASSERT_TRUE(result.refused);
  EXPECT_NE(result.refused->find("not seen"), std::string::npos) << *result.refused;
}

TEST(HeadRun, DoesNotTakeLightThatStays) {
  RunInRoom of;
  of.no_light = of.somebody_else = true;
  const HeadResult result = of.run();
  ASSERT_TRUE(result.refused);
  EXPECT_TRUE(result.fitted.empty());
}

TEST(HeadRun, EndsAtOnceIfItCouldNotSeeTheBeam) {
  RunInRoom of;
  of.room.camera.target_world_m = Vec3(0, 0, 3.4);  // into its own corner
  of.room.surface = seen_surface(of.room.rays, of.room.camera, 1);
  EXPECT_TRUE(of.run().refused);
}

TEST(HeadRun, SparesAHeadThatHardlyTurns) {
  RunInRoom of;
  of.setup.range.pan_min_rad = of.setup.range.tilt_min_rad = -0.01;
  of.setup.range.pan_max_rad = of.setup.range.tilt_max_rad = 0.01;
  EXPECT_TRUE(of.run().refused);
}

}  // namespace
}  // namespace luxrig
