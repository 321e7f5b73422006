/// Cameras whose pictures are files, and which device a rig file refers to.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "drivers/camera/camera_source.h"
#include "drivers/camera/file_listing.h"
#include "drivers/camera/v4l2_devices.h"
#include "tests/drivers/test_rig.h"

namespace luxrig {
namespace {

namespace fs = std::filesystem;

class InAFolder : public ::testing::Test {
 protected:
  InAFolder() {
    std::string name = (fs::temp_directory_path() / "luxrig-shots-XXXXXX").string();
    folder = ::mkdtemp(name.data());
    PictureCamera spec;
    spec.name = "folder";
    spec.width_px = 2;
    spec.height_px = 1;
    spec.taking.source = PictureSource::files;
    spec.taking.files = folder;
    rig.cameras.push_back(spec);
  }
  ~InAFolder() override { fs::remove_all(folder); }
  void pgm(const std::string& name, const std::string& samples) const {
    std::ofstream(folder / name, std::ios::binary) << "P5 2 1 255\n" << samples;
  }
  fs::path folder;
  Rig rig;
};

TEST_F(InAFolder, TakesTheNewestByName) {
  pgm("shot_9.pgm", "\x33\x33");
  pgm("shot_10_12.5ms.pgm", "\x66\xff");
  std::ofstream(folder / "notes.txt") << "no picture";
  const auto camera = make_camera(rig, 0);
  ASSERT_TRUE(camera->activate(at_ms(0)));
  const auto taken = camera->take(at_ms(1));
  ASSERT_TRUE(taken) << taken.error().detail;
  EXPECT_FLOAT_EQ(taken->light[0].x(), 0.4f);
  EXPECT_DOUBLE_EQ(taken->exposure_s, 0.0125);
  EXPECT_DOUBLE_EQ(taken->saturated_share, 0.5);
  pgm("shot_11.pgm", "\x33\x66");
  const auto next = camera->take(at_ms(2));
  ASSERT_TRUE(next);
  EXPECT_FLOAT_EQ(next->light[0].x(), 0.2f);
  EXPECT_EQ(next->exposure_s, 0) << "its name does not say";
}

TEST_F(InAFolder, ReportsFaultsAndRecovers) {
  const auto camera = make_camera(rig, 0);
  ASSERT_TRUE(camera->activate(at_ms(0)));
  EXPECT_EQ(camera->health(at_ms(0)).at(0).life, Life::faulted) << "nothing is there yet";
  pgm("a.pgm", "\x01");
  const auto cut = camera->take(at_ms(1));
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().cause, Cause::protocol);
  EXPECT_NE(cut.error().detail.find("a.pgm"), std::string::npos);
  std::ofstream(folder / "b.pgm", std::ios::binary) << "P5 1 1 255\n\x33";
  const auto small = camera->take(at_ms(2));
  ASSERT_FALSE(small);
  EXPECT_NE(small.error().detail.find("1 x 1 pixels, not 2 x 1"), std::string::npos);
  pgm("c.pgm", "\x33\x33");
  EXPECT_TRUE(camera->take(at_ms(3)));
  EXPECT_EQ(camera->health(at_ms(3)).at(0).life, Life::active);
  camera->deactivate(at_ms(4));
  EXPECT_EQ(camera->take(at_ms(5)).error().cause, Cause::inactive);
}

TEST_F(InAFolder, TakesLightInFilesUnchanged) {
  const float light[2] = {123, 4};
  std::ofstream(folder / "a.pfm", std::ios::binary) << "Pf\n2 1\n-1.0\n"
                                                    << std::string(reinterpret_cast<const char*>(light), sizeof light);
  rig.cameras[0].taking.curve = PixelCurve::srgb;
  const auto camera = make_camera(rig, 0);
  (void)camera->activate(at_ms(0));
  const auto taken = camera->take(at_ms(1));
  ASSERT_TRUE(taken) << taken.error().detail;
  EXPECT_TRUE(taken->calibrated);
  EXPECT_EQ(taken->light[0].x(), 123);
  EXPECT_EQ(taken->saturated_share, 0);
}

TEST_F(InAFolder, APatternSelectsFiles) {
  for (const char* name : {"left_1.pgm", "left_2.pgm", "right_3.pgm"}) pgm(name, "\x33\x33");
  const auto left = picture_files(folder / "left_*.pgm");
  ASSERT_TRUE(left);
  ASSERT_EQ(left->size(), 2u);
  EXPECT_EQ(left->back().filename(), "left_2.pgm");
  EXPECT_FALSE(picture_files(folder / "up_*.pgm"));
  EXPECT_FALSE(picture_files(folder / "gone" / "*.pgm"));
}

TEST(FileListing, ReadsExposuresInNames) {
  EXPECT_DOUBLE_EQ(exposure_in_name("wall_12.5ms_3.png").value_or(0), 0.0125);
  EXPECT_DOUBLE_EQ(exposure_in_name("2s.png").value_or(0), 2);
  EXPECT_DOUBLE_EQ(exposure_in_name("shot3_10ms.png").value_or(0), 0.01);
  EXPECT_FALSE(exposure_in_name("shot3.png"));
  EXPECT_FALSE(exposure_in_name("3shots.png"));
  EXPECT_FALSE(exposure_in_name("0ms.png"));
  EXPECT_FALSE(exposure_in_name(""));
}

TEST(Cameras, AreCheckedWithoutTouchingThem) {
  Rig rig;
  rig.file = "a/rig.toml";
  PictureCamera spec;
  spec.name = "cam";
  spec.width_px = 15;
  spec.in_file = {4, 1};
  rig.cameras.push_back(spec);
  EXPECT_TRUE(check_cameras(rig).empty()) << "it has no source";
  rig.cameras[0].taking.source = PictureSource::v4l2;
  rig.cameras[0].taking.format = PixelFormat::yuyv;
  rig.cameras[0].taking.curve_file = "/gone.csv";
  const auto problems = check_cameras(rig);
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_EQ(problems[0].line, 4);
  EXPECT_NE(problems[0].what.find("/gone.csv"), std::string::npos);
  EXPECT_NE(problems[1].mend.find("even width_px"), std::string::npos);
}

TEST(Cameras, AreChosenByPathBusSerialNumberOrName) {
  const std::vector<V4l2Device> devices = {{"/dev/video0", "Webcam", "usb-1", "A1", false},
                                           {"/dev/video2", "Webcam", "usb-2", "A2", false},
                                           {"/dev/video4", "Sensor", "platform:x", "", false}};
  for (const auto& [wanted, path] : {std::pair{"/dev/video2", "/dev/video2"},
                                     {"usb-1", "/dev/video0"},
                                     {"A2", "/dev/video2"},
                                     {"Sensor", "/dev/video4"}}) {
    const auto one = choose_device(devices, wanted);
    ASSERT_TRUE(one) << wanted;
    EXPECT_EQ(one->path, path);
  }
  EXPECT_NE(choose_device(devices, "Webcam").error().detail.find("2 cameras fit"), std::string::npos);
  EXPECT_NE(choose_device(devices, "").error().detail.find("3 cameras fit"), std::string::npos);
  EXPECT_NE(choose_device(devices, "gone").error().detail.find("/dev/video0"), std::string::npos);
  EXPECT_NE(choose_device({}, "").error().detail.find("no camera is there"), std::string::npos);
}

}  // namespace
}  // namespace luxrig
