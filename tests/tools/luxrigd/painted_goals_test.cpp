// Goals painted by clients: what a new list of strokes changes, what is refused, and what is on disk after it.
#include "tools/luxrigd/painted_goals.h"

#include <algorithm>
#include <cmath>

#include "tests/tools/luxrigd/painted_room.h"

namespace luxrig {
namespace {

using testing::PaintedRoomTest;
using testing::text_of;
using Why = PaintingRefusal::Why;

class PaintedGoalsTest : public PaintedRoomTest {};

TEST_F(PaintedGoalsTest, AListIsTheDocumentAndIsToldWithWhatItChanged) {
  const auto goals = this->goals();
  ASSERT_EQ(goals->all().size(), 1u);
  const std::string bare = goals->all()[0].painting.version;
  EXPECT_EQ(goals->put("floor", {bucket(120)}, bare).error().why, Why::not_yet) << "the surfaces are not cut yet";
  const std::string unpainted = patches_of(*goals);
  const auto filled = goals->put("floor", {bucket(120)}, bare);
  ASSERT_TRUE(filled) << filled.error().text;
  EXPECT_GT(filled->patches.size(), 20u);
  EXPECT_TRUE(std::is_sorted(filled->patches.begin(), filled->patches.end()));
  for (const float lux : filled->lux) EXPECT_EQ(lux, 120);
  EXPECT_NE(filled->version, bare);
  EXPECT_EQ(goals->document("floor")->strokes, std::vector{bucket(120)});
  EXPECT_FALSE(goals->document("floor")->saved);

  const auto brushed = goals->put("floor", {bucket(120), brush(300, 4)}, filled->version);
  ASSERT_TRUE(brushed) << brushed.error().text;
  EXPECT_GT(brushed->patches.size(), 3u);
  EXPECT_LT(brushed->patches.size(), filled->patches.size());
  // The same again, as a client sends it whose answer was lost.
  const auto again = goals->put("floor", {bucket(120), brush(300, 4)}, filled->version);
  ASSERT_TRUE(again) << again.error().text;
  EXPECT_EQ(again->version, brushed->version);
  EXPECT_TRUE(again->patches.empty());

  const auto undone = goals->put("floor", {}, {});
  ASSERT_TRUE(undone) << undone.error().text;
  EXPECT_EQ(undone->version, bare);
  EXPECT_EQ(undone->patches.size(), filled->patches.size());
  for (const float lux : undone->lux) EXPECT_TRUE(std::isnan(lux));
  EXPECT_EQ(patches_of(*goals), unpainted);
  EXPECT_TRUE(goals->document("floor")->saved) << "as on disk";
}

TEST_F(PaintedGoalsTest, AClientThatIsNotUpToDateGetsWhatThereIs) {
  const auto goals = this->goals();
  (void)patches_of(*goals);
  const std::string bare = goals->document("floor")->version;
  ASSERT_TRUE(goals->put("floor", {bucket(120)}, bare));
  const auto late = goals->put("floor", {bucket(500)}, bare);
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().why, Why::stale);
  ASSERT_TRUE(late.error().present);
  EXPECT_EQ(late.error().present->strokes, std::vector{bucket(120)});
  EXPECT_EQ(goals->document("floor")->strokes, std::vector{bucket(120)});
}

TEST_F(PaintedGoalsTest, StrokesThatComePieceByPieceGiveWhatTheWholeGives) {
  const auto by_pieces = goals(), at_once = goals();
  (void)patches_of(*by_pieces);
  (void)patches_of(*at_once);
  for (int places = 1; places <= 9; ++places)
    ASSERT_TRUE(by_pieces->put("floor", {bucket(80), brush(300, places)}, {})) << places;
  ASSERT_TRUE(by_pieces->put("floor", {bucket(80), brush(300, 9), brush(40, 2)}, {}));
  ASSERT_TRUE(by_pieces->put("floor", {bucket(80), brush(300, 9)}, {})) << "taken back";
  ASSERT_TRUE(at_once->put("floor", {bucket(80), brush(300, 9)}, {}));
  EXPECT_EQ(patches_of(*by_pieces), patches_of(*at_once));
}

TEST_F(PaintedGoalsTest, HostileStrokesAreRefusedAndChangeNothing) {
  const auto goals = this->goals();
  (void)patches_of(*goals);
  const std::string before = goals->document("floor")->version;
  Stroke outside = bucket(100);
  outside.path[0].position_world_m += Vec3(1e6, 0, 0);
  Stroke endless = brush(100, 2);
  endless.radius_m = 1e300;
  endless.path.resize(200000, place(0, 0));
  Stroke far = brush(100, 2);
  far.path[1].position_world_m.x() = 1e300;
  far.path.resize(100000, far.path[1]);
  for (const Stroke& stroke : {outside, endless, far}) {
    const auto refused = goals->put("floor", {bucket(50), stroke}, {});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().why, Why::invalid) << refused.error().text;
  }
  EXPECT_EQ(goals->put("floor", std::vector<Stroke>(20000, bucket(1)), {}).error().why, Why::invalid);
  EXPECT_EQ(goals->put("flor", {}, {}).error().why, Why::unknown);
  EXPECT_NE(goals->put("flor", {}, {}).error().text.find("did you mean \"floor\""), std::string::npos);
  EXPECT_EQ(goals->document("floor")->version, before);
}

TEST_F(PaintedGoalsTest, WhatIsSavedIsWhatTheRigAsksFor) {
  const auto goals = this->goals();
  (void)patches_of(*goals);
  ASSERT_TRUE(goals->put("floor", {bucket(120)}, {}));
  EXPECT_EQ(text_of(file("floor.json")), painting_to_json({})) << "not on disk before it is asked for";
  EXPECT_EQ(*goals->save({}), 1u);
  EXPECT_TRUE(goals->document("floor")->saved);
  EXPECT_EQ(text_of(file("floor.json")), painting_to_json(std::vector{bucket(120)}));
  EXPECT_FALSE(std::filesystem::exists(file("floor.csv.next")));
  const std::size_t before = session_->rig.points.size();
  const auto after = open();
  EXPECT_GT(after->rig.points.size(), before);
  EXPECT_EQ(after->rig.points.back().goal_lx, 120);
  EXPECT_EQ(*goals->save({"floor"}), 0u);
  EXPECT_EQ(goals->save({"flor"}).error().why, Why::unknown);
  // A reload keeps what is not saved.
  ASSERT_TRUE(goals->put("floor", {bucket(130)}, {}));
  session_ = after;
  EXPECT_EQ(goals->document("floor")->strokes, std::vector{bucket(130)});
  // What another program paints is taken if nothing is unsaved; else a person decides.
  (void)patches_of(*goals);
  ASSERT_TRUE(save_painting(goal(), painting_to_json({}), {}));
  EXPECT_EQ(goals->save({}).error().why, Why::conflict);
  EXPECT_EQ(text_of(file("floor.json")), painting_to_json({}));
  EXPECT_EQ(*goals->save({}), 1u);
  EXPECT_EQ(text_of(file("floor.json")), painting_to_json(std::vector{bucket(130)}));
}

TEST_F(PaintedGoalsTest, ARigThatCouldNotBeReadIsNotSaved) {
  append("\n[[point]]\nname = \"floor 1\"\nposition_m = [1, 1, 1]\n");
  session_ = open();
  const auto goals = this->goals();
  (void)patches_of(*goals);
  ASSERT_TRUE(goals->put("floor", {bucket(120)}, {}));
  const std::string points = text_of(file("floor.csv"));
  const auto saved = goals->save({});
  ASSERT_FALSE(saved);
  EXPECT_EQ(saved.error().why, Why::conflict);
  EXPECT_NE(saved.error().text.find("floor 1"), std::string::npos) << saved.error().text;
  EXPECT_EQ(text_of(file("floor.json")), painting_to_json({}));
  EXPECT_EQ(text_of(file("floor.csv")), points);
  EXPECT_NE(open(), nullptr);
}

TEST_F(PaintedGoalsTest, AStopAtAnyWriteLeavesARigThatCanBeRead) {
  const std::string strokes = text_of(file("floor.json")), points = text_of(file("floor.csv"));
  const auto goals = this->goals();
  (void)patches_of(*goals);
  ASSERT_TRUE(goals->put("floor", {bucket(120)}, {}));
  ASSERT_TRUE(goals->save({}));
  const std::string new_strokes = text_of(file("floor.json")), new_points = text_of(file("floor.csv"));
  // In the order of the writes: the points beside, the strokes, the points.
  std::ofstream(file("floor.csv.next")) << new_points;
  std::ofstream(file("floor.csv")) << points;
  std::ofstream(file("floor.json")) << strokes;
  EXPECT_EQ(open()->rig.points.size(), session_->rig.points.size()) << "as before";
  std::ofstream(file("floor.json")) << new_strokes;
  EXPECT_EQ(open()->rig.points.back().goal_lx, 120);
}

TEST_F(PaintedGoalsTest, ANewGoalIsAddedToTheRigFileAsAPersonWould) {
  const std::string before = text_of(file());
  const auto goals = this->goals();
  ASSERT_TRUE(goals->add("The \"north\" wall", 200.0));
  const std::string after = text_of(file());
  ASSERT_EQ(after.substr(0, before.size()), before) << "comments and all";
  EXPECT_EQ(after.substr(before.size()),
            "\n[[surface_goal]]\nname = \"The \\\"north\\\" wall\"\nstrokes = \"the-north-wall.json\"\nmax_lx = 200\n");
  ASSERT_EQ(goals->all().size(), 2u);
  EXPECT_FALSE(goals->all()[1].in_force);
  EXPECT_EQ(goals->add("floor", {}).error().why, Why::conflict);
  // It is painted and saved before the rig is read again.
  (void)patches_of(*goals, "The \"north\" wall");
  ASSERT_TRUE(goals->put("The \"north\" wall", {bucket(90)}, {}));
  EXPECT_EQ(*goals->save({}), 1u);
  const auto read = open();
  EXPECT_EQ(read->rig.surface_goals.back().name, "The \"north\" wall");
  EXPECT_EQ(read->rig.surface_goals.back().max_lx, 200);
  EXPECT_EQ(read->rig.points.back().goal_lx, 90);
  session_ = read;
  EXPECT_TRUE(goals->all()[1].in_force);
}

TEST_F(PaintedGoalsTest, ANewGoalIsRefusedWhereTheRigFileCannotBeRead) {
  const auto goals = this->goals();
  ASSERT_EQ(goals->all().size(), 1u);
  append("\n[[point]]\n");  // somebody is writing
  const std::string before = text_of(file());
  const auto added = goals->add("wall", {});
  ASSERT_FALSE(added);
  EXPECT_EQ(added.error().why, Why::conflict);
  EXPECT_EQ(text_of(file()), before);
  EXPECT_FALSE(std::filesystem::exists(file("wall.json")));
  EXPECT_FALSE(std::filesystem::exists(file("wall.csv")));
}

}  // namespace
}  // namespace luxrig
