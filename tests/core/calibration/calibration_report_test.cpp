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

/// The same, by a camera too.
CalibrationReport seen_example() {
  CalibrationReport report = example();
  CalibratedCamera camera;
  camera.name = "door\" onload=\"x";
  camera.offset_m = Vec3(0.03, 0.04, 0);
  camera.offset_error_m = Vec3(0.003, 0.004, 0);
  camera.turn_deg = Vec3(0, 0, 1.2);
  camera.fov_deg = {58.25, 0.11};
  camera.distortion = {-0.0123, 0.002};
  camera.lens_loss = {Known{0.2, 0.02}, Known{0.1, 0.02}, Known{-0.001, 0.01}};
  camera.flare = {0.013, 0.004};
  camera.responses = {{"amber <2>", {1.9, 0.1}}};
  report.found.cameras = {camera};
  CameraBudget budget;
  budget.lens = 0.25;
  budget.reflectance = 0.64;
  budget.noise = 0.11;
  report.seen = {{camera.name, {0.0012, 200, 3}}};
  report.variance = budget;
  LuxMap map;
  map.camera = camera.name;
  map.light = "the look in force";
  map.shares = {{"wash", 0.35}};
  map.places = {{"desk", {1, 2, 0.7}, Vec3::UnitZ(), 12.5, 30, {180, 9}},
                {"", {0, 0, 0}, Vec3::UnitZ(), 5, 6, {0, 0.2}}};
  map.lux_png = std::string("\x89PNG\0\xff", 6);
  map.error_png = "ab";
  report.maps = {map};
  return report;
}

TEST(CalibrationReport, ByACameraHasItsMapItsErrorsAndWhatWasLeftOut) {
  const std::string page = to_html(seen_example());
  for (const char* text :
       {"5.0 ± 0.5 cm", "58.25 ± 0.11°", "-0.0123 ± 0.0020", "74 %", "0.20 ± 0.02, 0.10 ± 0.02, 0.00 ± 0.01",
        "known to 5.0 % or better", "1.3 ± 0.4 %", "amber &lt;2&gt;", "1.9 ± 0.1", "under the look in force",
        "180.0 ± 9.0 lx", "5.0 %", "data:image/png;base64,iVBORwD/\"", "data:image/png;base64,YWI=\"",
        "<td>lens</td><td>25.0 %</td>", "<td>paint</td><td>64.0 %</td>", "0.12 % of the pixels", "3 of 200 times"})
    EXPECT_NE(page.find(text), std::string::npos) << text;
  EXPECT_EQ(page.find("onload=\"x"), std::string::npos);
  EXPECT_EQ(page.find("nan"), std::string::npos);
  EXPECT_EQ(page.find("<script"), std::string::npos);
  // The error of the one lit goal is 5 / 166; of the variance a quarter is the lens's, so half of it alone.
  EXPECT_NE(page.find("<td>lens</td><td>25.0 %</td><td>± 1.5 %</td>"), std::string::npos);

  const auto json = nlohmann::json::parse(to_json(seen_example()), nullptr, false);
  ASSERT_TRUE(json.is_object());
  EXPECT_EQ(json["share_of_variance"]["lens"], 0.25);
  EXPECT_EQ(json["share_of_variance"]["paint"], 0.64);
  EXPECT_EQ(json["cameras"][0]["full_pixels"], 0.0012);
  EXPECT_EQ(json["cameras"][0]["places"], 200);
  EXPECT_EQ(json["cameras"][0]["places_left_out"], 3);
  EXPECT_EQ(json["maps"][0]["light"], "the look in force");
  EXPECT_EQ(json["maps"][0]["share_of_full_light"]["wash"], 0.35);
  ASSERT_EQ(json["maps"][0]["places"].size(), 2u);
  EXPECT_EQ(json["maps"][0]["places"][0]["point"], "desk");
  EXPECT_EQ(json["maps"][0]["places"][0]["position_m"], (nlohmann::json{1.0, 2.0, 0.7}));
  EXPECT_EQ(json["maps"][0]["places"][0]["lux"], 180.0);
  EXPECT_EQ(json["maps"][0]["places"][0]["standard_error_lx"], 9.0);
  EXPECT_FALSE(json["maps"][0]["places"][1].contains("point"));
  EXPECT_FALSE(nlohmann::json::parse(to_json(example())).contains("maps")) << "no camera, no map";
}

TEST(CalibrationReport, OfACameraWithoutGoalsOrPicturesIsStillAPage) {
  CalibrationReport report;
  report.seen = {{"front", {}}, {"back", {}}};
  report.maps.emplace_back();
  const std::string page = to_html(report);
  EXPECT_NE(page.find("Camera \"front\""), std::string::npos);
  EXPECT_NE(page.find("Camera \"back\""), std::string::npos);
  EXPECT_EQ(page.find("<img"), std::string::npos);
  EXPECT_EQ(page.find("nan"), std::string::npos);
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
  EXPECT_EQ(json["luxrig_calibration_report"], 2);
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
