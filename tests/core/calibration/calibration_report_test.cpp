#include "core/calibration/calibration_report.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace luxrig {
namespace {

CalibrationReport example() {
  CalibrationReport report;
  report.found.rig = "hall <1>";
  report.found.made = "2026-11-28T06:12:00Z";
  CalibratedFixture spot, wash;
  spot.name = "spot\" onload=\"x";
  spot.output = {0.84, 0.02};
  spot.offset_m = Vec3(0.03, 0.04, 0);
  spot.curve = {{0.5, 0.31}, {1, 1}};
  wash.name = "wash";
  report.found.fixtures = {spot, wash};
  report.found.luxmeters = {{"meter-1", {1.02, 0.01}}};
  report.found.materials = {{"wall", {0.9, 0.05}}};
  report.by = {"luxmeters that hang"};
  report.level = 0.4;
  report.goals = {{"desk", {200, 60}, {166, 5}}, {"unlit", {}, {}}};
  report.readings = {{"\"wash\" alone at level 1", "meter-1", 80, 60, 5.2}};
  report.not_found = {"No reading told how bright \"wash\" is."};
  report.to_settle = {"desk"};
  return report;
}

TEST(CalibrationReport, IsAPageThatNoNameCanBreak) {
  const std::string page = to_html(example());
  EXPECT_NE(page.find("Calibration of hall &lt;1&gt;"), std::string::npos);
  EXPECT_EQ(page.find("onload=\"x"), std::string::npos);
  EXPECT_NE(page.find("0.840 ± 0.020"), std::string::npos);
  EXPECT_NE(page.find("5.0 ± 0.0 cm"), std::string::npos);
  EXPECT_NE(page.find("31 % of its light"), std::string::npos);
  EXPECT_NE(page.find("<td>not measured</td>"), std::string::npos);
  EXPECT_NE(page.find("+20 %"), std::string::npos) << "the file said 200 lx, there are 166";
  EXPECT_NE(page.find("class=\"odd\""), std::string::npos);
  EXPECT_NE(page.find("A luxmeter at &quot;desk&quot; would settle"), std::string::npos);
  EXPECT_EQ(page.find("nan"), std::string::npos);
  EXPECT_EQ(page.find("inf"), std::string::npos);
}

TEST(CalibrationReport, IsJsonWithEveryErrorBesideItsValue) {
  const auto json = nlohmann::json::parse(to_json(example()), nullptr, false);
  ASSERT_TRUE(json.is_object());
  EXPECT_EQ(json["luxrig_calibration_report"], 1);
  EXPECT_EQ(json["goals"][0]["stated_lx"], (nlohmann::json{200.0, 60.0}));
  EXPECT_EQ(json["goals"][0]["found_lx"], (nlohmann::json{166.0, 5.0}));
  EXPECT_EQ(json["readings"][0]["in_errors"], 5.2);
  EXPECT_EQ(json["to_settle"][0], "desk");
}

TEST(CalibrationReport, OfNothingIsStillAPage) {
  const std::string page = to_html(CalibrationReport{});
  EXPECT_NE(page.find("Nothing is left open"), std::string::npos);
  EXPECT_EQ(page.find("nan"), std::string::npos);
}

}  // namespace
}  // namespace luxrig
