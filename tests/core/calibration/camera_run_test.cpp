// A camera before a room of boxes with two lamps: where it is looked for, and what is left out where its pictures are
// full.
#include "core/calibration/camera_run.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/calibration/box_room.h"

namespace luxrig {
namespace {

using namespace box_room;

struct Seen {
  RayScene rays{room_with_boxes()};
  Rig rig;
  std::vector<double> brightest{1, 1};
  Camera truth = stated_camera();

  Seen() {
    rig.luminaires.resize(1);
    rig.fixtures.resize(2);
    // Farther than find_camera() looks from the rig file's place alone.
    CameraOffset off = CameraOffset::Zero();
    off << 0.05, -0.04, 0.04, 0.01, -0.02, 0.12, 0.02, 0.01;
    truth = offset_by(stated_camera(), off);
  }
  [[nodiscard]] MergedPicture picture(float light, std::uint64_t seed) const {
    MergedPicture merged{seen_by(rays, truth, 0.01, seed), {}};
    for (Vec3f& pixel : merged.picture.luminance_cd_m2) pixel *= light;
    return merged;
  }
};

TEST(CameraRun, LooksForTheCameraWhereItWasFoundBefore) {
  const Seen seen;
  const auto places = seen_places(seen.rays, stated_camera(), {}, 30);
  const std::vector<double> all{1, 1};
  CameraRun from_file(seen.rig, seen.rays, {stated_camera()}, places, seen.brightest, std::vector<LampCurve>(2));
  EXPECT_FALSE(from_file.take(all, seen.picture(1, 1))) << "7 degrees off";

  CameraOffset nearly = CameraOffset::Zero();
  nearly << 0.01, 0, 0, 0, 0, 0.004, 0, 0;
  const CameraStart start{stated_camera(), offset_by(seen.truth, nearly)};
  CameraRun again(seen.rig, seen.rays, start, places, seen.brightest, std::vector<LampCurve>(2));
  const auto taken = again.take(all, seen.picture(1, 1));
  ASSERT_TRUE(taken) << taken.error().detail;
  EXPECT_TRUE(again.found_as_before());
  EXPECT_LT(offset_between(seen.truth, again.found()->camera).head<3>().norm(), 0.02);
}

TEST(CameraRun, LooksWhereTheRigFileHasItIfItHangsThereAgain) {
  Seen seen;
  const CameraStart start{stated_camera(), seen.truth};
  seen.truth = stated_camera();
  const auto places = seen_places(seen.rays, start.best(), {}, 30);
  CameraRun run(seen.rig, seen.rays, start, places, seen.brightest, std::vector<LampCurve>(2));
  const auto taken = run.take(std::vector<double>{1, 1}, seen.picture(1, 2));
  ASSERT_TRUE(taken) << taken.error().detail;
  EXPECT_FALSE(run.found_as_before());
  EXPECT_LT(offset_between(stated_camera(), run.found()->camera).head<3>().norm(), 0.02);
}

TEST(CameraRun, LeavesOutPlacesWhoseBeamsAreFullAndCountsThem) {
  Seen seen;
  seen.truth = stated_camera();
  const auto places = seen_places(seen.rays, stated_camera(), {}, 40);
  std::vector<LampCurve> known(2);
  for (LampCurve& curve : known) curve.of_level = {{0.5, 0.4}, {1, 1}};
  CameraRun run(seen.rig, seen.rays, {stated_camera()}, places, seen.brightest, known);
  LightPriors priors;
  priors.log_meter = Eigen::VectorXd::Constant(1, 0.01);
  const CameraInstrument instrument(seen.rig, room_with_boxes().materials.size(), priors);
  std::size_t pictures = 0;
  std::size_t kept = 0;
  for (std::uint64_t seed = 3; const auto level = run.next(); ++seed) {
    const bool dark = run.done() > 0 && (*level)[0] + (*level)[1] == 0;
    MergedPicture picture = seen.picture(dark ? 0 : 1, seed);
    // Under the second lamp the left half is full.
    const bool second = run.done() > 0 && (*level)[1] > 0;
    if (second) {
      picture.full.assign(picture.picture.luminance_cd_m2.size(), false);
      for (std::size_t i = 0; i < picture.full.size(); ++i) picture.full[i] = i % 320 < 160;
    }
    pictures += run.done() > 0 && !dark;
    ASSERT_TRUE(run.take(*level, picture));
  }
  ASSERT_EQ(pictures, 2u) << "their curves are known";
  const CameraOverflow& overflow = run.overflow();
  EXPECT_DOUBLE_EQ(overflow.pixel_share, 0.25);
  for (const SeenPlace& place : places) kept += place.x_px > 165;
  EXPECT_GT(overflow.full_places, places.size() / 4);
  EXPECT_NEAR(static_cast<double>(overflow.full_places), static_cast<double>(places.size() - kept), 3);
  EXPECT_GE(overflow.places, 2 * places.size() - 6) << "hardly any is out of the picture of the camera that was found";
  std::size_t of_second = 0;
  for (const LightReading& reading : run.readings(instrument, 0, run.curves())) {
    const bool second = reading.level[1] > 0;
    of_second += second;
    if (second) EXPECT_GT(places[reading.receiver].x_px, 155);
  }
  EXPECT_GT(of_second, 5u);
  EXPECT_LE(of_second, overflow.places / 2 - overflow.full_places);
}

TEST(CameraRun, OfALampThatIsSkippedNothingIsKnown) {
  Seen seen;
  seen.truth = stated_camera();
  const auto places = seen_places(seen.rays, stated_camera(), {}, 40);
  CameraRun run(seen.rig, seen.rays, {stated_camera()}, places, seen.brightest, std::vector<LampCurve>(2));
  LightPriors priors;
  priors.log_meter = Eigen::VectorXd::Constant(1, 0.01);
  const CameraInstrument instrument(seen.rig, room_with_boxes().materials.size(), priors);
  for (std::uint64_t seed = 3; const auto level = run.next(); ++seed) {
    const auto lamp = run.lamp_of_next();
    if (lamp == 1u) {
      run.skip(*level);
      continue;
    }
    ASSERT_TRUE(run.take(*level, seen.picture(lamp ? static_cast<float>((*level)[0]) : run.done() == 0, seed)));
  }
  EXPECT_EQ(run.done(), run.steps());
  EXPECT_FALSE(run.curves()[0].of_level.empty());
  EXPECT_TRUE(run.curves()[1].of_level.empty());
  const auto readings = run.readings(instrument, 0, run.curves());
  EXPECT_GT(readings.size(), 10u);
  for (const LightReading& reading : readings) EXPECT_EQ(reading.level[1], 0);
}

}  // namespace
}  // namespace luxrig
