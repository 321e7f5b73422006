// A rig file that changes under a running daemon: noticing it, naming the differences, and changes that need a restart.
#include <gtest/gtest.h>

#include <fstream>
#include <thread>

#include "core/estimation/calibration.h"
#include "core/tasks/rig_version.h"
#include "core/tasks/session.h"
#include "tests/tools/programs/process.h"
#include "tools/luxrig/open_session.h"
#include "tools/luxrigd/by_hand_names.h"
#include "tools/luxrigd/reload_check.h"
#include "tools/luxrigd/rig_file_watch.h"

namespace luxrig {
namespace {

using luxrig::testing::Folder;
using luxrig::testing::source;
using luxrig::testing::text_of;

class RoomThatChanges : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::copy(source("tests/rigs/room"), folder_ / "room", std::filesystem::copy_options::recursive);
    before_ = open();
  }
  [[nodiscard]] std::filesystem::path file() const { return folder_ / "room" / "rig.toml"; }
  std::shared_ptr<Session> open() {
    auto session = open_session(file());
    EXPECT_TRUE(session) << session.error()[0].text();
    return std::make_shared<Session>(std::move(*session));
  }
  void replace(const std::string& from, const std::string& to) {
    std::string text = text_of(file());
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    std::ofstream(file()) << text.replace(at, from.size(), to);
  }
  void put_back() {
    std::filesystem::copy_file(source("tests/rigs/room/rig.toml"), file(),
                               std::filesystem::copy_options::overwrite_existing);
  }
  /// Names of the parts that differ after the change.
  std::string differs(const std::string& from, const std::string& to) {
    replace(from, to);
    const auto after = open();
    put_back();
    return what_differs(version_of(before_->rig, before_->scene), version_of(after->rig, after->scene));
  }
  /// The first problem; empty if the change can be taken.
  std::string refused(const std::string& from, const std::string& to) {
    replace(from, to);
    const auto after = open();
    put_back();
    const auto problems = needs_a_restart(before_->rig, after->rig, false);
    return problems.empty() ? "" : problems[0].text();
  }

  Folder folder_;
  std::shared_ptr<Session> before_;
};

TEST_F(RoomThatChanges, DistinguishesChangedPartsAndIgnoresComments) {
  EXPECT_EQ(differs("# The smallest rig", "# A small rig"), "");
  EXPECT_EQ(differs("goal_lx = 150", "goal_lx = 151"), "goals");
  EXPECT_EQ(differs("weight = 0.5", "weight = 0.6"), "goals");
  EXPECT_EQ(differs("max_lx = 200", "max_lx = 190"), "limits");
  EXPECT_EQ(differs("max_level = 0.9", "max_level = 0.8"), "limits");
  const std::string light = "scene, photometry or places";
  EXPECT_EQ(differs("beam_angle_deg = 24", "beam_angle_deg = 25"), light);
  EXPECT_EQ(differs("lumens = 900", "lumens = 901"), light);
  EXPECT_EQ(differs("position_m = [-1.5, 0.0, 2.9]", "position_m = [-1.5, 0.1, 2.9]"), light);
  EXPECT_EQ(differs("reflectance = 0.6", "reflectance = 0.61"), light);
  EXPECT_EQ(differs("turn_deg = 30", "turn_deg = 31"), light);
  EXPECT_EQ(differs("safe_level = 0.2", "safe_level = 0.3"), "") << "no plan rests on it";
  EXPECT_EQ(differs("aim = \"floor\"", "aim = \"plinth-top\""), "") << "a plan says where a head looks";
  EXPECT_EQ(differs("aim = \"plinth-top\"    ", "aim = \"floor\"    "), light) << "this one hangs so";
}

TEST_F(RoomThatChanges, OnlyOutputChangesNeedARestart) {
  for (const auto& [from, to] :
       {std::pair{"goal_lx = 150", "goal_lx = 20"}, std::pair{"max_lx = 200", "max_lx = 50"},
        std::pair{"lumens = 900", "lumens = 1900"}, std::pair{"max_level = 0.9", "max_level = 0.8"},
        std::pair{"safe_level = 0.2", "safe_level = 0.3"}, std::pair{"rounds = 3", "rounds = 2"}})
    EXPECT_EQ(refused(from, to), "") << to;
  for (const auto& [from, to, what] :
       {std::tuple{"address = 10", "address = 20", "[[fixture]] \"head-1\": its patch"},
        std::tuple{"register = 0", "register = 5", "[[fixture]] \"bulb-1\": its patch"},
        std::tuple{"dimmer_curve = \"square\"", "dimmer_curve = \"linear\"", "[[fixture]] \"spot-1\": dimmer_curve"},
        std::tuple{"pan_speed_deg_s = 180", "pan_speed_deg_s = 90", "[[fixture]] \"head-1\": its speeds"},
        std::tuple{"tilt_range_deg = [-135, 135]", "tilt_range_deg = [-130, 135]", "[[fixture]] \"head-1\": the range"},
        std::tuple{"port = 1502", "port = 1503", "[[bus]] \"field\""},
        std::tuple{"destination = \"127.0.0.1\"", "destination = \"127.0.0.2\"", "[[bus]] \"dmx\""},
        std::tuple{"lux_per_count = 0.001", "lux_per_count = 0.01", "[[luxmeter]] \"meter-1\""},
        std::tuple{"http_port = 9620", "http_port = 9621", "http_port of [daemon]"},
        std::tuple{"http_port = 9620", "accounts = \"a.json\"", "accounts of [daemon]"},
        std::tuple{"name = \"room\"", "name = \"hall\"", "the rig's name"}}) {
    const std::string text = refused(from, to);
    EXPECT_NE(text.find(what), std::string::npos) << to << ": " << text;
    EXPECT_NE(text.find("needs a restart"), std::string::npos) << text;
    EXPECT_NE(text.find("rig.toml:"), std::string::npos) << text;
  }
}

TEST_F(RoomThatChanges, ACalibrationOfASimulatedRigNeedsARestartWhichThenRefusesIt) {
  std::ofstream(calibration_file(before_->rig))
      << R"({"luxrig_calibration": 1, "rig": "room", "made": "today", "simulated": "real, seed 3"})";
  const auto problems = needs_a_restart(before_->rig, open()->rig, true);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_NE(problems[0].text().find("which rig calibration.json was measured on"), std::string::npos)
      << problems[0].text();
}

TEST_F(RoomThatChanges, AFileIsReportedOnlyWhileItsContentDiffers) {
  const auto files = files_of(before_->rig);
  EXPECT_EQ(files.size(), 3u) << "the rig file, its mesh, and the calibration that there may be";
  const RigFileWatch watch(files, std::chrono::milliseconds(20));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_TRUE(watch.changed().empty());
  const auto reported = [&](std::size_t count) {
    return luxrig::testing::wait_for([&] { return watch.changed().size() == count; }, std::chrono::seconds(10));
  };
  const auto touch = [&](int seconds) {
    std::filesystem::last_write_time(file(),
                                     std::filesystem::file_time_type::clock::now() + std::chrono::seconds(seconds));
  };
  touch(5);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_TRUE(watch.changed().empty());
  replace("goal_lx = 150", "goal_lx = 151");
  touch(10);
  ASSERT_TRUE(reported(1));
  EXPECT_EQ(watch.changed()[0].filename(), "rig.toml");
  std::filesystem::remove(folder_ / "room" / "room.obj");
  EXPECT_TRUE(reported(2));
  put_back();
  touch(15);
  EXPECT_TRUE(reported(1));
  std::ofstream(calibration_file(before_->rig)) << "{}";
  EXPECT_TRUE(reported(2));
}

TEST_F(RoomThatChanges, NamesMayHaveWildcardsAndUnknownOnesAreRefused) {
  const Rig& rig = before_->rig;
  EXPECT_EQ(fixtures_called(rig, {"spot-1"})->size(), 1u);
  EXPECT_EQ(fixtures_called(rig, {"*-1"})->size(), 3u);
  EXPECT_EQ(fixtures_called(rig, {"*-1", "spot-1"})->size(), 3u) << "each once";
  EXPECT_EQ(points_called(rig, {"pl*", "floor"})->size(), 2u);
  EXPECT_EQ(anything_called(rig, {"*"})->size(), 5u);
  const auto nobody = fixtures_called(rig, {"spot-1", "sput-1"});
  ASSERT_FALSE(nobody);
  EXPECT_NE(nobody.error().detail.find("did you mean \"spot-1\"?"), std::string::npos) << nobody.error().detail;
  EXPECT_FALSE(points_called(rig, {"spot-1"}));
}

}  // namespace
}  // namespace luxrig
