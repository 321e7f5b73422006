#include "core/goals/painting_file.h"

#include <gtest/gtest.h>

#include "core/goals/painting.h"
#include "tests/core/goals/built_scene.h"
#include "tests/mutants.h"

namespace luxrig {
namespace {

std::vector<Stroke> any_strokes(Random& random) {
  constexpr StrokeKind kKinds[] = {StrokeKind::brush, StrokeKind::bucket, StrokeKind::selective, StrokeKind::eraser};
  std::vector<Stroke> strokes(random.below(6));
  for (Stroke& stroke : strokes) {
    stroke.kind = kKinds[random.below(4)];
    const bool brush = stroke.kind == StrokeKind::brush;
    for (std::size_t i = 0, places = brush ? 1 + random.below(4) : 1; i < places; ++i)
      stroke.path.push_back({1000 * random.in_cube(), random.direction()});
    if (stroke.kind != StrokeKind::eraser) stroke.lux = random.log_between(1e-3, 1e5);
    if (brush) {
      stroke.radius_m = random.log_between(1e-3, 10);
      stroke.falloff = random.between(0, 1);
    }
  }
  return strokes;
}

std::string problems_of(const std::string& text) {
  const auto strokes = painting_from_json(text, "wall.json");
  std::string all;
  if (!strokes)
    for (const Problem& problem : strokes.error()) all += problem.text() + "\n";
  return all;
}

TEST(PaintingFile, AnyStrokesAreReadAsTheyWereWritten) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const std::vector<Stroke> strokes = any_strokes(random);
    const auto read = painting_from_json(painting_to_json(strokes), "wall.json");
    ASSERT_TRUE(read) << read.error().front().text();
    ASSERT_EQ(read->size(), strokes.size());
    for (std::size_t s = 0; s < strokes.size(); ++s) {
      EXPECT_EQ((*read)[s].kind, strokes[s].kind);
      EXPECT_EQ((*read)[s].lux, strokes[s].lux);
      EXPECT_EQ((*read)[s].radius_m, strokes[s].radius_m);
      EXPECT_EQ((*read)[s].falloff, strokes[s].falloff);
      ASSERT_EQ((*read)[s].path.size(), strokes[s].path.size());
      for (std::size_t p = 0; p < strokes[s].path.size(); ++p) {
        EXPECT_EQ((*read)[s].path[p].position_world_m, strokes[s].path[p].position_world_m);
        EXPECT_EQ((*read)[s].path[p].normal_world, strokes[s].path[p].normal_world);
      }
    }
  }
}

TEST(PaintingFile, AStrokeIsALine) {
  const Stroke stroke{StrokeKind::bucket, {{{1, 2, 0}, Vec3::UnitZ()}}, 300, 0, 0};
  EXPECT_EQ(painting_to_json(std::vector<Stroke>{stroke, stroke}),
            "{\n \"luxrig_painting\": 1,\n \"strokes\": [\n"
            "  {\"kind\":\"bucket\",\"lux\":300.0,\"path\":[{\"position\":[1.0,2.0,0.0],\"normal\":[0.0,0.0,1.0]}]},\n"
            "  {\"kind\":\"bucket\",\"lux\":300.0,\"path\":[{\"position\":[1.0,2.0,0.0],\"normal\":[0.0,0.0,1.0]}]}\n"
            " ]\n}\n");
}

TEST(PaintingFile, WhatIsWrongIsSaidWithItsPlaceAndHowToMendIt) {
  const auto strokes = [](const std::string& list) { return "{\"luxrig_painting\": 1,\n\"strokes\": [" + list + "]}"; };
  const std::string place = R"("path": [{"position": [0, 0, 0], "normal": [0, 0, 1]}])";
  EXPECT_EQ(problems_of(strokes("{\"kind\": \"bucket\", \"lux\": 5, " + place + "}")), "");
  EXPECT_EQ(problems_of(strokes("{\"kind\": \"bucket\", \"lux\": -5, " + place + "}")),
            "wall.json:2:39: /strokes/0/lux is -5: give 0 to 1e+06 lx\n");
  EXPECT_EQ(problems_of(strokes("{\"kind\": \"spray\"}")),
            "wall.json:2:22: /strokes/0/kind is not known: give \"brush\", \"bucket\", \"selective\" or \"eraser\"\n");
  EXPECT_EQ(problems_of(strokes("{\"kind\": \"brush\", \"lux\": 5, \"radius_m\": 1, \"falloff\": 1.5, " + place + "}")),
            "wall.json:2:67: /strokes/0/falloff is 1.5: give 0 to 1\n");
  EXPECT_EQ(problems_of(strokes("{\"kind\": \"eraser\", \"path\": []}")),
            "wall.json:2:40: /strokes/0/path has 0 places: give one\n");
  EXPECT_NE(problems_of(strokes(R"({"kind": "eraser", "path": [{"position": [0, 0, 0], "normal": [0, 0, 2]}]})"))
                .find("/strokes/0/path/0/normal has length 2: give a length of 1"),
            std::string::npos);
  EXPECT_NE(problems_of(strokes(R"({"kind": "eraser", "path": [{"normal": [0, 0, 1]}]})"))
                .find("/strokes/0/path/0/position is missing"),
            std::string::npos);
  EXPECT_NE(problems_of("{}").find("/luxrig_painting is missing"), std::string::npos);
  EXPECT_NE(problems_of(R"({"luxrig_painting": 2, "strokes": []})").find("reads version 1"), std::string::npos);
  EXPECT_NE(problems_of("[").find("not valid JSON"), std::string::npos);
}

TEST(PaintingFile, DamagedFilesAreRefusedInWordsOrPaintedSafely) {
  Random random(2);
  const Scene scene = BuiltScene().sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}).scene();
  const RayScene rays(scene);
  const SurfacePatches surface = *make_surface_patches(scene, rays, {0.3, 1});
  const std::string good = painting_to_json(std::vector<Stroke>{
      {StrokeKind::brush, {{{0, 0, 0}, Vec3::UnitZ()}, {{0.5, 0, 0}, Vec3::UnitZ()}}, 300, 0.4, 0.5},
      {StrokeKind::selective, {{{0, 0, 0}, -Vec3::UnitZ()}}, 50, 0, 0},
      {StrokeKind::eraser, {{{0, 0, 0}, Vec3::UnitZ()}}, 0, 0, 0}});
  int read = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto strokes = painting_from_json(mutant_of(good, random), "wall.json");
    if (!strokes) {
      ASSERT_FALSE(strokes.error().empty());
      for (const Problem& problem : strokes.error()) EXPECT_FALSE(problem.what.empty() || problem.mend.empty());
      continue;
    }
    ++read;
    Painting painting(surface, rays);
    for (const Stroke& stroke : *strokes) painting.add(stroke);
    for (const float lux : painting.lux()) EXPECT_FALSE(lux < 0 || lux > 1.001e6F);
  }
  EXPECT_GT(read, 50) << "some damage is harmless";
}

}  // namespace
}  // namespace luxrig
