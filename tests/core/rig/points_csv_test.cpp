#include "core/rig/points_csv.h"

#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "tests/core/rig/listed_problems.h"

namespace luxrig {
namespace {

TEST(PointsCsv, ReadsEveryColumnInAnyOrder) {
  const auto table = parse_points_csv(
      "max_lx,weight,goal_lx,nz,ny,nx,z_m,y_m,x_m,name\n"
      "400,2,300,0,0,2,3,2.5,-1e0,a\n",
      "p.csv", 10);
  ASSERT_TRUE(table.problems.empty()) << test::listed(table.problems);
  ASSERT_EQ(table.rows.size(), 1u);
  const Point& p = table.rows[0].point;
  EXPECT_EQ(p.name, "a");
  EXPECT_EQ(p.position_world_m, Vec3(-1, 2.5, 3));
  EXPECT_EQ(p.normal_world, Vec3::UnitX());
  EXPECT_EQ(p.goal_lx, 300);
  EXPECT_EQ(p.weight, 2);
  EXPECT_EQ(p.max_lx, 400);
}

TEST(PointsCsv, UsesDefaultsForMissingValues) {
  const auto table = parse_points_csv("name,x_m,y_m,z_m,nx,ny,nz,goal_lx\na,1,2,3,,,,\n", "p.csv", 10);
  ASSERT_EQ(table.rows.size(), 1u) << test::listed(table.problems);
  EXPECT_EQ(table.rows[0].point.normal_world, Vec3::UnitZ());
  EXPECT_FALSE(table.rows[0].point.goal_lx);
  EXPECT_EQ(table.rows[0].point.weight, 1);
}

TEST(PointsCsv, ReadsQuotesCommentsByteOrderMarkAndCarriageReturns) {
  const auto table = parse_points_csv(
      "\xEF\xBB\xBFname,x_m,y_m,z_m\r\n\r\n# not a point\r\n \"a \"\"b\"\", c\" , 1 ,2,3\r\nd,4,5,6", "p.csv", 10);
  ASSERT_EQ(table.rows.size(), 2u) << test::listed(table.problems);
  EXPECT_EQ(table.rows[0].point.name, "a \"b\", c");
  EXPECT_EQ(table.rows[0].in_file.line, 4);
  EXPECT_EQ(table.rows[0].in_file.column, 2);
  EXPECT_EQ(table.rows[1].point.position_world_m, Vec3(4, 5, 6));
}

TEST(PointsCsv, WhatIsWrittenIsReadAsTheSame) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> any(-9, 9);
  for (const std::string name : {"a", "a, \"b\"", " padded ", "#1", "Gemälde"}) {
    std::vector<Point> points(3);
    for (Point& point : points) {
      point.name = name + std::to_string(&point - points.data());
      point.position_world_m = Vec3(any(random), any(random), any(random));
      point.normal_world = Vec3(any(random), any(random), any(random)).normalized();
      point.weight = std::abs(any(random));
    }
    points[0].goal_lx = 1 / 3.0;
    points[1].max_lx = 200;
    points[2].goal_tolerance = 0.1;
    const auto table = parse_points_csv(points_csv(points, "0123"), "p.csv", 10);
    ASSERT_TRUE(table.problems.empty()) << test::listed(table.problems);
    EXPECT_EQ(table.made_for, "0123");
    ASSERT_EQ(table.rows.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Point& read = table.rows[i].point;
      EXPECT_EQ(read.name, points[i].name);
      EXPECT_EQ(read.position_world_m, points[i].position_world_m);
      EXPECT_NEAR((read.normal_world - points[i].normal_world).norm(), 0, 1e-15);
      EXPECT_EQ(read.goal_lx, points[i].goal_lx);
      EXPECT_EQ(read.max_lx, points[i].max_lx);
      EXPECT_EQ(read.weight, points[i].weight);
      EXPECT_EQ(read.goal_tolerance, points[i].goal_tolerance);
    }
  }
}

TEST(PointsCsv, CountsColumnsInCharactersNotBytes) {
  const auto table = parse_points_csv("name,x_m,y_m,z_m\nGemälde,?,2,3\n", "p.csv", 10);
  ASSERT_EQ(table.problems.size(), 1u);
  EXPECT_EQ(table.problems[0].line, 2);
  EXPECT_EQ(table.problems[0].column, 9);
}

TEST(PointsCsv, RefusesABadHeaderWithoutReadingFurther) {
  const auto unknown = parse_points_csv("name,x,y_m,z_m,y_m\na,1,2,3,4\nb,?\n", "p.csv", 10);
  ASSERT_EQ(unknown.problems.size(), 3u) << test::listed(unknown.problems);
  EXPECT_NE(unknown.problems[0].what.find("no column x_m"), std::string::npos);
  EXPECT_NE(unknown.problems[1].what.find("unknown column \"x\""), std::string::npos);
  EXPECT_NE(unknown.problems[1].mend.find("x_m"), std::string::npos);
  EXPECT_NE(unknown.problems[2].what.find("column y_m stands there twice"), std::string::npos);
  EXPECT_EQ(parse_points_csv("name,x_m,y_m,z_m,nx\n", "p.csv", 10).problems.size(), 1u);
  EXPECT_EQ(parse_points_csv("", "p.csv", 10).problems.size(), 1u);
  EXPECT_EQ(parse_points_csv("# nothing\n\n", "p.csv", 10).problems.size(), 1u);
}

TEST(PointsCsv, RefusesNamesWithInvalidText) {
  for (const std::string name : {"\xff", "a\x01", "\xc0\xaf", "\xed\xa0\x80"}) {
    const auto table = parse_points_csv("name,x_m,y_m,z_m\n" + name + ",1,2,3\n", "p.csv", 10);
    EXPECT_EQ(table.problems.size(), 1u);
    EXPECT_TRUE(table.rows.empty());
  }
}

TEST(PointsCsv, RefusesMoreRowsThanAllowed) {
  std::string text = "name,x_m,y_m,z_m\n";
  for (int i = 0; i < 11; ++i) text += "p" + std::to_string(i) + ",1,2,3\n";
  EXPECT_EQ(parse_points_csv(text, "p.csv", 11).problems.size(), 0u);
  EXPECT_EQ(parse_points_csv(text, "p.csv", 10).problems.size(), 1u);
}

TEST(PointsCsv, RoundTripsRandomPoints) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place_m(-1e6, 1e6), lux(1e-3, 1e6);
  std::string text = "name,x_m,y_m,z_m,goal_lx\n";
  std::vector<std::pair<Vec3, double>> written;
  char line[200];
  for (int i = 0; i < 1000; ++i) {
    written.emplace_back(Vec3(place_m(random), place_m(random), place_m(random)), lux(random));
    const auto& [p, goal] = written.back();
    std::snprintf(line, sizeof line, "p%d,%.17g,%.17g,%.17g,%.17g\n", i, p.x(), p.y(), p.z(), goal);
    text += line;
  }
  const auto table = parse_points_csv(text, "p.csv", 1000);
  ASSERT_EQ(table.rows.size(), written.size()) << test::listed(table.problems);
  for (std::size_t i = 0; i < written.size(); ++i) {
    EXPECT_EQ(table.rows[i].point.position_world_m, written[i].first);
    EXPECT_EQ(table.rows[i].point.goal_lx, written[i].second);
  }
}

TEST(PointsCsv, ReadsGoalColours) {
  const PointsTable table = parse_points_csv(
      "name,x_m,y_m,z_m,goal_lx,goal_y,goal_x,goal_cct_k\na,0,0,0,100,0.4,0.45,\nb,0,0,0,100,,,3000\nc,0,0,0,,,,\n",
      "points.csv", 10);
  ASSERT_TRUE(table.problems.empty()) << table.problems[0].text();
  ASSERT_EQ(table.rows.size(), 3u);
  EXPECT_EQ(table.rows[0].goal_xy, Chromaticity(0.45, 0.4));
  EXPECT_EQ(table.rows[1].point.goal_rgb, rgb_of_cct(3000));
  EXPECT_FALSE(table.rows[2].goal_xy || table.rows[2].point.goal_rgb);
}

}  // namespace
}  // namespace luxrig
