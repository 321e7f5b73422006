// Where a calibration looks for a camera, and which cameras it keeps.
#include "tools/luxrig/calibrate/by_camera.h"

#include <gtest/gtest.h>

#include "core/rig/rig_file.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

const std::vector<std::string> kDoor = {"door"};

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
  const auto first = camera_views(session, kDoor, nullptr, priors);
  ASSERT_TRUE(first) << first.error().detail;
  EXPECT_FALSE(first->each[0].start.found_before);

  Calibration before;
  before.cameras = {door_off_by({0.02, 0.01, -0.03}, session)};
  priors = usual_priors(session.rig);
  const auto again = camera_views(session, kDoor, &before, priors);
  ASSERT_TRUE(again && again->each[0].start.found_before);
  EXPECT_TRUE((again->each[0].start.best().eye_world_m - again->each[0].start.stated.eye_world_m)
                  .isApprox(Vec3(0.02, 0.01, -0.03)));
  ASSERT_FALSE(again->each[0].places.empty());

  before.cameras = {door_off_by({0, 0, 5}, session)};  // above the ceiling
  priors = usual_priors(session.rig);
  const auto from_file = camera_views(session, kDoor, &before, priors);
  ASSERT_TRUE(from_file) << from_file.error().detail;
  EXPECT_FALSE(from_file->each[0].start.found_before);
  EXPECT_EQ(from_file->each[0].places.size(), first->each[0].places.size());
}

TEST(CameraView, OfSeveralCamerasEachHasItsOwnPlacesAndUnknowns) {
  Session session = room_session();
  PictureCamera window = session.rig.cameras.front();
  window.name = "window";
  window.position_world_m.x() += 0.3;
  session.rig.cameras.push_back(window);
  LightPriors priors = usual_priors(session.rig);
  const Eigen::Index before = priors.log_meter.size();
  const std::vector<std::string> both{"door", "window"};
  const auto views = camera_views(session, both, nullptr, priors);
  ASSERT_TRUE(views) << views.error().detail;
  ASSERT_EQ(views->each.size(), 2u);
  const CameraView &door = views->each[0], &other = views->each[1];
  EXPECT_EQ(door.first_point, session.rig.points.size());
  EXPECT_EQ(other.first_point, door.first_point + door.places.size());
  EXPECT_EQ(views->session->rig.points.size(), other.first_point + other.places.size());
  EXPECT_EQ(views->points().size(), door.places.size() + other.places.size());
  EXPECT_EQ(views->points().front(), door.first_point);
  EXPECT_NE(door.instrument.response_to(0), other.instrument.response_to(0));
  EXPECT_GT(priors.log_meter.size() - before, 2 * 3) << "lenses, responses and paint of both";

  const std::vector<std::string> twice{"door", "door"}, unknown{"door", "windw"};
  EXPECT_FALSE(camera_views(session, twice, nullptr, priors));
  const auto refused = camera_views(session, unknown, nullptr, priors);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().detail.find("windw"), std::string::npos);
}

TEST(CameraView, KeepsWhatIsKnownOfCamerasThatWereNotUsed) {
  const Session session = room_session();
  LightPriors priors = usual_priors(session.rig);
  const auto views = camera_views(session, kDoor, nullptr, priors);
  ASSERT_TRUE(views);
  ComputeOptions coarse;
  coarse.max_error = 0.1;
  const auto light = RigLight::of(*views->session, priors, coarse);
  ASSERT_TRUE(light) << light.error().detail;
  MeasuredByCameras measured;
  MeasuredByCamera& by_door = measured.each.emplace_back().emplace();
  by_door.found.camera = views->each[0].start.stated;
  by_door.found.camera.eye_world_m.z() += 0.02;
  Calibration before, found;
  before.cameras = {door_off_by({1, 1, 1}, session), door_off_by({0.1, 0, 0}, session)};
  before.cameras[1].name = "balcony";
  put_cameras(session.rig, *views, measured, *light, &before, found);
  ASSERT_EQ(found.cameras.size(), 2u);
  EXPECT_EQ(found.cameras[0].name, "door");
  EXPECT_TRUE(found.cameras[0].offset_m.isApprox(Vec3(0, 0, 0.02), 1e-9));
  EXPECT_EQ(found.cameras[1].name, "balcony");
  EXPECT_EQ(found.cameras[1].offset_m, Vec3(0.1, 0, 0));

  Calibration by_meters;
  put_cameras(session.rig, {}, {}, *light, &before, by_meters);
  EXPECT_EQ(by_meters.cameras.size(), 2u);
}

}  // namespace
}  // namespace luxrig
