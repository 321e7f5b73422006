/// The driver of video cameras with a model device: settings kept or refused, fresh frames, faults.
#include <gtest/gtest.h>

#include <limits>

#include "drivers/camera/camera_source.h"
#include "tests/drivers/camera/model_video.h"
#include "tests/drivers/test_rig.h"

namespace luxrig {
namespace {

class AtAModel : public ::testing::Test {
 protected:
  AtAModel() {
    PictureCamera spec;
    spec.name = "cam";
    spec.width_px = 16;
    spec.height_px = 8;
    spec.taking.source = PictureSource::v4l2;
    spec.taking.exposure_s = 0.010;
    rig.cameras.push_back(spec);
  }
  PictureTaking& taking() { return rig.cameras[0].taking; }
  CameraSource& source() {
    if (!camera) camera = make_video_camera_over(std::make_unique<ModelVideoChannel>(device), rig, 0);
    (void)camera->activate(at_ms(time_ms));
    return *camera;
  }
  Result<TakenPicture> take() { return source().take(at_ms(time_ms += 1000)); }
  std::string refusal_of_take() {
    const auto taken = take();
    return taken ? "" : taken.error().detail;
  }
  Life life() { return source().health(at_ms(time_ms)).at(0).life; }
  std::int64_t control(VideoControl which) { return device.controls.at(which).second; }

  Rig rig;
  ModelVideo device;
  std::unique_ptr<CameraSource> camera;
  double time_ms = 0;
};

TEST_F(AtAModel, DisablesAutomaticControlsAndSetsTheExposure) {
  const auto taken = take();
  ASSERT_TRUE(taken) << taken.error().detail;
  EXPECT_EQ(control(VideoControl::exposure_auto), 1);
  EXPECT_EQ(control(VideoControl::exposure_auto_priority), 0);
  EXPECT_EQ(control(VideoControl::exposure), 100);
  EXPECT_EQ(control(VideoControl::gain), 10) << "its default";
  EXPECT_EQ(control(VideoControl::gamma), 100) << "linear";
  EXPECT_EQ(control(VideoControl::brightness), 0);
  EXPECT_DOUBLE_EQ(taken->exposure_s, 0.010);
  EXPECT_FALSE(taken->calibrated);
  EXPECT_NEAR(taken->light[0].x(), 0.5, 1.0 / 4095) << "the format with most bits";
  EXPECT_EQ(life(), Life::active);
}

TEST_F(AtAModel, ConvertsSamplesToLight) {
  taking().full_scale_cd_m2 = 1000;
  taking().dark_share = 0.1;
  const auto taken = take();
  ASSERT_TRUE(taken);
  EXPECT_TRUE(taken->calibrated);
  EXPECT_NEAR(taken->light[5].y(), 1000 * 0.4 / 0.9, 0.5);
  EXPECT_EQ(taken->saturated_share, 0);
  device.full_scale_per_s = 200;
  const auto full = take();
  ASSERT_TRUE(full);
  EXPECT_EQ(full->saturated_share, 1);
}

TEST_F(AtAModel, DiscardsFramesFromBeforeAChangeOfExposure) {
  ASSERT_TRUE(take());
  for (const bool times : {true, false}) {
    device.has_times = times;
    for (const double exposure_s : {0.002, 0.016, 0.004}) {
      ASSERT_TRUE(source().set_exposure(exposure_s));
      const auto taken = take();
      ASSERT_TRUE(taken) << taken.error().detail;
      EXPECT_DOUBLE_EQ(taken->exposure_s, exposure_s);
      EXPECT_NEAR(taken->light[0].x(), exposure_s * 50, 1.0 / 4095) << "of an exposure before";
    }
  }
}

TEST_F(AtAModel, DiscardsFramesFromBeforeTheCall) {
  device.pipeline = 0;
  for (const bool times : {true, false}) {
    device.has_times = times;
    device.full_scale_per_s = 10;
    ASSERT_TRUE(take());
    device.clock += std::chrono::seconds(1);  // frames queue up
    ASSERT_TRUE(take());
    device.clock += std::chrono::milliseconds(200);
    device.full_scale_per_s = 10;
    (void)camera->take_raw(at_ms(time_ms));
    device.full_scale_per_s = 90;  // the light changes, then a picture is requested
    const auto taken = take();
    ASSERT_TRUE(taken);
    EXPECT_NEAR(taken->light[0].x(), 0.9, 0.001);
  }
}

TEST_F(AtAModel, RefusesAnExposureThatTheCameraDoesNotKeep) {
  device.keeps_exposure = 0.5;
  EXPECT_NE(refusal_of_take().find("exposes for 5 ms where 10 ms were set"), std::string::npos);
  EXPECT_EQ(life(), Life::faulted);
  device.keeps_exposure = 1;
  EXPECT_EQ(refusal_of_take(), "");
  EXPECT_EQ(life(), Life::active);
}

TEST_F(AtAModel, RefusesUnsupportedSettings) {
  taking().exposure_s = 0.9;
  EXPECT_NE(refusal_of_take().find("0.1 to 500 ms"), std::string::npos);
  camera.reset();
  taking().exposure_s.reset();
  EXPECT_NE(refusal_of_take().find("write exposure_ms"), std::string::npos);
  camera.reset();
  taking().exposure_s = 0.01;
  taking().gain = 400;
  EXPECT_NE(refusal_of_take().find("write gain within 0 to 100"), std::string::npos);
  camera.reset();
  taking().gain.reset();
  taking().format = PixelFormat::yuyv;
  EXPECT_NE(refusal_of_take().find("any of Y12, GREY"), std::string::npos);
  camera.reset();
  taking().format = PixelFormat::any;
  rig.cameras[0].width_px = 640;
  EXPECT_NE(refusal_of_take().find("16 x 8 pixels"), std::string::npos);
  camera.reset();
  rig.cameras[0].width_px = 16;
  device.controls.erase(VideoControl::exposure);
  EXPECT_NE(refusal_of_take().find("leave exposure_ms out"), std::string::npos);
  camera.reset();
  taking().exposure_s.reset();
  const auto unknown = take();
  ASSERT_TRUE(unknown) << unknown.error().detail;
  EXPECT_EQ(unknown->exposure_s, 0) << "not known";
}

TEST_F(AtAModel, DetectsThatSomethingElseChangedTheCamera) {
  ASSERT_TRUE(take());
  device.resets_itself = true;
  EXPECT_NE(refusal_of_take().find("something else changed"), std::string::npos);
}

TEST_F(AtAModel, ReportsThatItIsUnpluggedAndRecoversByItself) {
  ASSERT_TRUE(take());
  device.plugged_in = false;
  const auto gone = take();
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().cause, Cause::network);
  EXPECT_EQ(gone.error().device, "cam");
  EXPECT_EQ(life(), Life::faulted);
  EXPECT_FALSE(take());
  device.plugged_in = true;
  EXPECT_TRUE(take());
  EXPECT_EQ(life(), Life::active);
  EXPECT_EQ(device.opened, 2);
}

TEST_F(AtAModel, StartsFaultedWithoutACameraAndLimitsItsRetries) {
  device.plugged_in = false;
  EXPECT_TRUE(source().activate(at_ms(0)).has_value());
  EXPECT_EQ(life(), Life::faulted);
  device.plugged_in = true;
  EXPECT_FALSE(source().take(at_ms(100))) << "too soon";
  EXPECT_EQ(device.opened, 0);
  EXPECT_TRUE(source().take(at_ms(600)));
}

TEST_F(AtAModel, ReportsAStalledStreamWithinItsBound) {
  ASSERT_TRUE(take());
  device.stalls = true;
  const Duration before = device.clock;
  const auto stalled = take();
  ASSERT_FALSE(stalled);
  EXPECT_EQ(stalled.error().cause, Cause::timeout);
  EXPECT_LE(device.clock - before, source().bounds().read);
  device.stalls = false;
  EXPECT_TRUE(take());
}

TEST_F(AtAModel, SkipsDamagedFramesAndRefusesTruncatedOnes) {
  ASSERT_TRUE(take());
  device.damaged = 2;
  EXPECT_TRUE(take());
  EXPECT_EQ(source().health(at_ms(time_ms)).at(0).errors, 2u);
  device.cut = 100;
  const auto cut = take();
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().cause, Cause::protocol);
  device.cut = 0;
  EXPECT_TRUE(take());
}

TEST_F(AtAModel, RestoresTheCamerasOriginalSettings) {
  device.controls.at(VideoControl::exposure).second = 321;
  const auto found = device.controls;
  ASSERT_TRUE(take());
  EXPECT_EQ(control(VideoControl::exposure), 100);
  device.cut = 100;  // and after a failure that closes it
  EXPECT_FALSE(take());
  camera->deactivate(at_ms(time_ms));
  for (const auto& [which, value] : found) EXPECT_EQ(control(which), value.second) << name_of(which);
  EXPECT_EQ(device.opened, device.closed);
  device.cut = 0;
  ASSERT_TRUE(take());
  camera.reset();  // ended without a goodbye
  for (const auto& [which, value] : found) EXPECT_EQ(control(which), value.second) << name_of(which);
}

TEST_F(AtAModel, RestoresTheSettingsFoundAfterAPowerCycle) {
  ASSERT_TRUE(take());
  auto fresh = device.controls;
  fresh.at(VideoControl::exposure_auto).second = 3;
  fresh.at(VideoControl::gain).second = 33;
  device.plugged_in = false;
  EXPECT_FALSE(take());
  device.controls = fresh;
  device.plugged_in = true;
  ASSERT_TRUE(take());
  camera->deactivate(at_ms(time_ms));
  EXPECT_EQ(control(VideoControl::exposure_auto), 3);
  EXPECT_EQ(control(VideoControl::gain), 33);
}

TEST_F(AtAModel, RefusesInvalidExposures) {
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(source().set_exposure(bad).error().cause, Cause::invalid);
  const auto taken = take();
  ASSERT_TRUE(taken);
  EXPECT_DOUBLE_EQ(taken->exposure_s, 0.010);
}

TEST_F(AtAModel, ReportsThatItIsInUse) {
  device.in_use = true;
  EXPECT_NE(refusal_of_take().find("in use"), std::string::npos);
}

TEST_F(AtAModel, FollowsTheDriverLifecycle) {
  CameraSource& camera_of = source();
  EXPECT_TRUE(camera_of.activate(at_ms(1)).has_value()) << "twice";
  EXPECT_EQ(camera_of.picture_taker(), &camera_of);
  EXPECT_EQ(camera_of.level_output(), nullptr);
  camera_of.deactivate(at_ms(2));
  camera_of.deactivate(at_ms(3));
  EXPECT_EQ(device.opened, device.closed);
  EXPECT_EQ(camera_of.health(at_ms(4)).at(0).life, Life::configured);
  const auto inactive = camera_of.take(at_ms(5));
  ASSERT_FALSE(inactive);
  EXPECT_EQ(inactive.error().cause, Cause::inactive);
  EXPECT_EQ(device.opened, 1);
}

}  // namespace
}  // namespace luxrig
