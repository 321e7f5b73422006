// Where a calibration looks for a camera, and which cameras it keeps.
#include "tools/luxrig/calibrate/by_camera.h"

#include <gtest/gtest.h>

#include "core/rig/rig_file.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

Session room_session() {
  auto rig = load_rig(test::source_folder() / "tests/rigs/room/rig.toml");
  EXPECT_TRUE(rig) << rig.error().front().text();
  auto session = session_of(std::move(*rig));
  EXPECT_TRUE(session) << session.error().front().text();
  return std::move(*session);
}

CalibratedCamera door_off_by(const Vec3& offset_m, const Session& session) {
  CalibratedCamera camera;
  camera.name = "door";
  camera.offset_m = offset_m;
  camera.fov_deg = {deg_from_rad(session.rig.cameras.front().vertical_fov_rad), 0.1};
  return camera;
}

TEST(CameraView, StartsWhereAnEarlierCalibrationFoundTheCameraIfThatSeesTheRoom) {
  const Session session = room_session();
  ASSERT_EQ(session.rig.cameras.front().name, "door");
  LightPriors priors = usual_priors(session.rig);
  const auto first = camera_view(session, "door", nullptr, priors);
  ASSERT_TRUE(first) << first.error().detail;
  EXPECT_FALSE(first->start.found_before);

  Calibration before;
  before.cameras = {door_off_by({0.02, 0.01, -0.03}, session)};
  priors = usual_priors(session.rig);
  const auto again = camera_view(session, "door", &before, priors);
  ASSERT_TRUE(again && again->start.found_before);
  EXPECT_TRUE((again->start.best().eye_world_m - again->start.stated.eye_world_m).isApprox(Vec3(0.02, 0.01, -0.03)));
  ASSERT_FALSE(again->places.empty());

  before.cameras = {door_off_by({0, 0, 5}, session)};  // above the ceiling
  priors = usual_priors(session.rig);
  const auto from_file = camera_view(session, "door", &before, priors);
  ASSERT_TRUE(from_file) << from_file.error().detail;
  EXPECT_FALSE(from_file->start.found_before);
  EXPECT_EQ(from_file->places.size(), first->places.size());
}

TEST(CameraView, KeepsWhatIsKnownOfCamerasThatWereNotUsed) {
  const Session session = room_session();
  LightPriors priors = usual_priors(session.rig);
  const auto view = camera_view(session, "door", nullptr, priors);
  ASSERT_TRUE(view);
  ComputeOptions coarse;
  coarse.max_error = 0.1;
  const auto light = RigLight::of(*view->session, priors, coarse);
  ASSERT_TRUE(light) << light.error().detail;
  MeasuredByCamera measured;
  measured.found.camera = view->start.stated;
  measured.found.camera.eye_world_m.z() += 0.02;
  Calibration before, found;
  before.cameras = {door_off_by({1, 1, 1}, session), door_off_by({0.1, 0, 0}, session)};
  before.cameras[1].name = "balcony";
  put_cameras(session.rig, &*view, &measured, *light, &before, found);
  ASSERT_EQ(found.cameras.size(), 2u);
  EXPECT_EQ(found.cameras[0].name, "door");
  EXPECT_TRUE(found.cameras[0].offset_m.isApprox(Vec3(0, 0, 0.02), 1e-9));
  EXPECT_EQ(found.cameras[1].name, "balcony");
  EXPECT_EQ(found.cameras[1].offset_m, Vec3(0.1, 0, 0));

  Calibration by_meters;
  put_cameras(session.rig, nullptr, nullptr, *light, &before, by_meters);
  EXPECT_EQ(by_meters.cameras.size(), 2u);
}

}  // namespace
}  // namespace luxrig
