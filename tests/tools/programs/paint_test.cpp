// `paint`: strokes and points beside a rig, which every other command then asks for.
#include <filesystem>
#include <fstream>

#include "tests/tools/programs/live_rig.h"

namespace luxrig::testing {
namespace {

/// A reading room with a surface goal.
class PaintedRoom {
 public:
  PaintedRoom() {
    std::filesystem::copy(source("rigs/reading-room"), folder_ / "room");
    std::ofstream(folder_ / "room/rig.toml", std::ios::app)
        << "\n[[surface_goal]]\nname = \"desk\"\nstrokes = \"desk.json\"\nmax_lx = 900\nmin_spacing_m = 0.3\n";
  }
  Ran run(const std::string& command, const std::vector<std::string>& options = {}) const {
    std::vector<std::string> words = {program("luxrig"), command, (folder_ / "room").string()};
    words.insert(words.end(), options.begin(), options.end());
    return luxrig::testing::run(words, 120s);
  }
  /// Of a table desk; from above.
  Ran paint(std::vector<std::string> options) const {
    options.insert(options.begin(), "desk");
    return run("paint", options);
  }
  [[nodiscard]] std::filesystem::path file(const char* name) const { return folder_ / "room" / name; }

 private:
  Folder folder_;
};

TEST(Paint, StrokesBecomePointsOfTheRigAndAreTakenBackWhole) {
  const PaintedRoom room;
  const Ran unpainted = room.run("check");
  EXPECT_EQ(unpainted.code, 2) << "not solved without the painted light";
  EXPECT_NE(unpainted.output.find("lay out its points: luxrig paint"), std::string::npos) << unpainted.output;

  const Ran first = room.paint({"--bucket", "1.8", "2.6", "0.74", "--lux", "400", "--json"});
  ASSERT_EQ(first.code, 0) << first.output;
  const json one = json_in(first)["surface_goals"][0];
  EXPECT_EQ(one["strokes"], 1);
  EXPECT_EQ(one["highest_lux"], 400);
  EXPECT_GT(one["area_m2"], 0.3);
  EXPECT_GE(one["points"], 1);
  const std::string strokes = text_of(room.file("desk.json")), points = text_of(room.file("desk.csv"));

  const Ran second =
      room.paint({"--brush", "1.7", "2.6", "0.74", "1.9", "2.6", "0.74", "--radius", "0.15", "--lux", "600", "--json"});
  ASSERT_EQ(second.code, 0) << second.output;
  EXPECT_EQ(json_in(second)["surface_goals"][0]["strokes"], 2);
  EXPECT_EQ(json_in(second)["surface_goals"][0]["highest_lux"], 600);
  EXPECT_NE(text_of(room.file("desk.csv")), points);
  ASSERT_EQ(room.paint({"--picture", room.file("asked.png").string()}).code, 0);
  EXPECT_EQ(text_of(room.file("asked.png")).substr(1, 3), "PNG");
  const Ran picked = room.paint({"--pick", "1.8", "2.6", "0.74"});
  EXPECT_NE(picked.output.find("\"desk\" asks for 600 lx there"), std::string::npos) << picked.output;

  ASSERT_EQ(room.paint({"--undo", "1"}).code, 0);
  EXPECT_EQ(text_of(room.file("desk.json")), strokes);
  EXPECT_EQ(text_of(room.file("desk.csv")), points);

  const json lit = json_in(room.run("evaluate", {"--json"}));
  int painted = 0;
  for (const json& point : lit["points"])
    if (point["name"].get<std::string>().starts_with("desk ") && point.contains("goal_lux")) {
      EXPECT_EQ(point["goal_lux"], 400);
      EXPECT_EQ(point["max_lux"], 900);
      ++painted;
    }
  EXPECT_EQ(painted, one["points"]);
}

TEST(Paint, WhatCannotBePaintedChangesNoFile) {
  const PaintedRoom room;
  ASSERT_EQ(room.paint({"--bucket", "1.8", "2.6", "0.74", "--lux", "400"}).code, 0);
  const std::string strokes = text_of(room.file("desk.json")), points = text_of(room.file("desk.csv"));
  const std::vector<std::pair<std::vector<std::string>, std::string>> refused = {
      {{"--bucket", "90", "2.6", "0.74", "--lux", "400"}, "no surface is within 1 m"},
      {{"--bucket", "1.8", "2.6", "0.74"}, "a stroke needs its light: --lux"},
      {{"--brush", "1.8", "2.6", "0.74", "--lux", "400"}, "a brush needs its size: --radius"},
      {{"--bucket", "1.8", "2.6", "0.74", "--lux", "400"}, "the stroke would change nothing"},
      {{"--bucket", "1.8", "2.6", "0.74", "--lux", "-4"}, "lux"},
      {{"--bucket", "1.8", "2.6", "0.74", "--lux", "nan"}, "lux"},
      {{"--erase", "0.1", "0.1", "0"}, "nothing is painted there"},
      {{"--picture", "a.jpg"}, "end it in .png"},
      {{"--undo", "2"}, "has 1 strokes to take back"},
      {{"--undo", "1", "--erase", "1.8", "2.6", "0.74"}, "excludes"},
  };
  for (const auto& [options, why] : refused) {
    const Ran ran = room.paint(options);
    EXPECT_EQ(ran.code, 2) << ran.output;
    EXPECT_NE(ran.output.find(why), std::string::npos) << why << "\n" << ran.output;
    EXPECT_EQ(text_of(room.file("desk.json")), strokes);
    EXPECT_EQ(text_of(room.file("desk.csv")), points);
  }
  const Ran unknown = room.run("paint", {"dezk", "--undo", "1"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_NE(unknown.output.find("did you mean \"desk\""), std::string::npos) << unknown.output;

  // Strokes that somebody changed by hand are laid out anew, and not before.
  std::ofstream(room.file("desk.json")) << R"({"luxrig_painting": 1, "strokes": []})";
  EXPECT_EQ(room.run("check").code, 2);
  ASSERT_EQ(room.run("paint").code, 0);
  EXPECT_EQ(room.run("check").code, 0);
  // A file that is none stays as it is.
  std::ofstream(room.file("desk.json")) << "{";
  EXPECT_EQ(room.run("paint").code, 2);
  EXPECT_EQ(text_of(room.file("desk.json")), "{");
}

}  // namespace
}  // namespace luxrig::testing
