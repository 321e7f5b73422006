// Notes of `check`, and that `evaluate` and `solve` end with a rig that deserves such notes.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "tests/tools/programs/live_rig.h"

namespace luxrig::testing {
namespace {

/// A reading room that tests can spoil.
class SpoiltRoom {
 public:
  SpoiltRoom() {
    std::filesystem::copy(source("rigs/reading-room"), folder_ / "room");
    text_ = text_of(folder_ / "room/rig.toml");
  }
  void replace(const std::string& from, const std::string& to) {
    const auto at = text_.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text_.replace(at, from.size(), to);
    write();
  }
  void add(const std::string& text) {
    text_ += "\n" + text;
    write();
  }
  [[nodiscard]] std::string path() const { return (folder_ / "room").string(); }
  /// Number of the line that contains a text, from 1.
  [[nodiscard]] int line_of(const std::string& text) const {
    const auto end = text_.begin() + static_cast<std::ptrdiff_t>(text_.find(text));
    return 1 + static_cast<int>(std::count(text_.begin(), end, '\n'));
  }
  Ran run(const std::string& command, const std::vector<std::string>& options = {}) const {
    std::vector<std::string> words = {program("luxrig"), command, path()};
    words.insert(words.end(), options.begin(), options.end());
    return luxrig::testing::run(words, 120s);
  }

 private:
  void write() const { std::ofstream(folder_ / "room/rig.toml") << text_; }
  Folder folder_;
  std::string text_;
};

constexpr const char* kInsideADesk = R"([[point]]
name = "inside"
position_m = [1.8, 2.6, 0.4]
normal = [0, 0, 1]
)";

TEST(Check, NotesAMisfitRigWithPlaceFigureAndRemedyWithoutRefusingIt) {
  SpoiltRoom room;
  room.add(kInsideADesk);
  room.add("[[point]]\nname = \"behind\"\nposition_m = [3.0, 5.01, 1.5]\nnormal = [0, -1, 0]\n");
  const Ran ran = room.run("check");
  EXPECT_EQ(ran.code, 0) << ran.output;
  EXPECT_NE(ran.output.find("point \"inside\" is inside of object \"desk middle-west\", 0.34 m below its surface"),
            std::string::npos)
      << ran.output;
  EXPECT_NE(ran.output.find("point \"behind\" faces a surface of the scene"), std::string::npos) << ran.output;
  EXPECT_NE(ran.output.find("10.0 mm before it"), std::string::npos) << ran.output;
  EXPECT_NE(ran.output.find("the 2 notes above are worth a look"), std::string::npos) << ran.output;
  EXPECT_EQ(ran.output.find("no problems found"), std::string::npos) << ran.output;
  const json out = json_in(room.run("check", {"--json"}));
  ASSERT_EQ(out["notes"].size(), 2u) << out;
  EXPECT_TRUE(out["ok"].get<bool>());
  EXPECT_GT(out["notes"][0]["line"].get<int>(), 0);
  EXPECT_FALSE(out["notes"][0]["mend"].get<std::string>().empty());
}

TEST(Check, NotesAZUpMeshReadAsYUp) {
  SpoiltRoom room;
  room.replace("up_axis = \"z\"", "# up_axis");
  const Ran ran = room.run("check");
  EXPECT_EQ(ran.code, 0) << ran.output;
  EXPECT_NE(ran.output.find("set up_axis = \"z\" in [scene]"), std::string::npos) << ran.output;
}

TEST(Check, NotesAMeshInMetresReadAsMillimetres) {
  SpoiltRoom room;
  room.replace("up_axis = \"z\"", "up_axis = \"z\"\nunit = \"mm\"");
  const Ran ran = room.run("check");
  EXPECT_EQ(ran.code, 0) << ran.output;
  EXPECT_NE(ran.output.find("set unit = \"m\" in [scene]"), std::string::npos) << ran.output;
}

TEST(Check, NotesNothingOnShippedRigs) {
  for (const auto& entry : std::filesystem::directory_iterator(source("rigs"))) {
    if (!std::filesystem::exists(entry.path() / "rig.toml")) continue;
    const json out = json_in(luxrig::testing::run({program("luxrig"), "check", entry.path().string(), "--json"}));
    EXPECT_EQ(out["notes"], json::array()) << entry.path();
  }
}

TEST(Check, EveryComputingCommandRefusesALampInAPointByName) {
  SpoiltRoom room;
  room.add(R"([[luminaire]]
name = "bulb"
model = "isotropic"
lumens = 800

[[fixture]]
name = "fallen"
luminaire = "bulb"
position_m = [3.0, 3.5, 0.9]
bus = "dmx"
universe = 9
address = 1

[[point]]
name = "under it"
position_m = [3.0, 3.5, 0.9]
normal = [0, 0, 1]
)");
  for (const char* command : {"check", "evaluate", "solve"}) {
    const Ran ran = room.run(command);
    EXPECT_EQ(ran.code, 2) << command << '\n' << ran.output;
    EXPECT_NE(ran.output.find("fixture \"fallen\" lies in point \"under it\""), std::string::npos) << ran.output;
  }
}

TEST(Check, ANullBusCanBePlannedButNotRun) {
  SpoiltRoom room;
  for (const char* driver : {"driver = \"sacn\"", "driver = \"modbus_tcp\""}) room.replace(driver, "driver = \"null\"");
  for (int address = 1; address <= 6; ++address) room.replace("address = " + std::to_string(address) + "\n", "");
  const Ran checked = room.run("check", {"--outputs"});
  EXPECT_EQ(checked.code, 0) << checked.output;
  EXPECT_NE(checked.output.find("it can be planned and not yet run"), std::string::npos) << checked.output;
  EXPECT_NE(checked.output.find("nothing: it is a null bus"), std::string::npos) << checked.output;
  EXPECT_EQ(room.run("check", {"--json", "--outputs"}).code, 0);
  EXPECT_EQ(room.run("solve", {"--max-error", "0.05"}).code, 0);
  const std::string line = std::to_string(room.line_of("[[bus]]\nname = \"dmx\""));
  for (const std::vector<std::string>& how : {std::vector<std::string>{"--sim", "--once"}, {"--once"}}) {
    const Ran ran = room.run("run", how);
    EXPECT_EQ(ran.code, 2) << ran.output;
    EXPECT_NE(ran.output.find("rig.toml:" + line + ":1: bus \"dmx\" is a null bus"), std::string::npos) << ran.output;
  }
  EXPECT_EQ(luxrig::testing::run({program("luxrig-sim"), room.path()}).code, 2);
}

TEST(Check, ALampOnAPointIsRefusedByName) {
  SpoiltRoom room;
  room.add(R"([[luminaire]]
name = "bulb"
model = "isotropic"
lumens = 800
[[fixture]]
name = "bare bulb"
luminaire = "bulb"
position_m = [3.0, 2.6, 1.5]
bus = "dmx"
address = 100
[[point]]
name = "at the lamp"
position_m = [3.0, 2.6, 1.5]
normal = [0, 0, 1]
)");
  for (const char* command : {"check", "evaluate", "solve"}) {
    const Ran ran = room.run(command);
    EXPECT_EQ(ran.code, 2) << ran.output;
    EXPECT_NE(ran.output.find("at the lamp"), std::string::npos) << ran.output;
    EXPECT_NE(ran.output.find("bare bulb"), std::string::npos) << ran.output;
  }
}

/// Light enters rarely, over its door: an error of 0.3 % used to take minutes.
constexpr const char* kCupboard = R"([[scene.object]]
name = "left"
box_m = [0.02, 0.5, 1.0]
position_m = [2.7, 4.7, 0]
[[scene.object]]
name = "right"
box_m = [0.02, 0.5, 1.0]
position_m = [3.3, 4.7, 0]
[[scene.object]]
name = "back"
box_m = [0.6, 0.02, 1.0]
position_m = [3.0, 4.95, 0]
[[scene.object]]
name = "door"
box_m = [0.6, 0.02, 0.93]
position_m = [3.0, 4.45, 0]
[[scene.object]]
name = "lid"
box_m = [0.62, 0.52, 0.02]
position_m = [3.0, 4.7, 1.0]
[[point]]
name = "cupboard"
position_m = [3.0, 4.7, 0.3]
normal = [0, 0, -1]
)";

TEST(Enough, APointInACupboardDoesNotKeepEvaluateAndSolveRunning) {
  SpoiltRoom room;
  room.add(kCupboard);
  const json out = json_in(room.run("evaluate", {"--max-error", "0.003", "--json"}));
  ASSERT_TRUE(out.is_object());
  EXPECT_TRUE(out["reached"].get<bool>()) << out;
  EXPECT_DOUBLE_EQ(out["wanted"].get<double>(), 0.003);
  EXPECT_EQ(out["wanted_of"], "rms");
  EXPECT_LE(out["rms_error"].get<double>(), 0.003);
  EXPECT_GT(out["error_floor_lux"].get<double>(), 0);
  const Ran solved = room.run("solve", {"--max-error", "0.003", "--json"});
  EXPECT_TRUE(json_in(solved)["transport"]["reached"].get<bool>()) << solved.output;
}

TEST(Enough, ReportsProgressAndTheReachedErrorWhenTheTimeIsUp) {
  SpoiltRoom room;
  const Ran ran = room.run("evaluate", {"--model", "path", "--max-error", "0.0001", "--max-seconds", "3", "--json"});
  EXPECT_EQ(ran.code, 0) << ran.output;
  EXPECT_NE(ran.output.find("evaluating: "), std::string::npos) << ran.output;
  EXPECT_LT(ran.output.find("evaluating: "), ran.output.find("{\n"));
  EXPECT_NE(ran.output.find("warning: not as exact as wanted"), std::string::npos) << ran.output;
  EXPECT_NE(ran.output.find("when 3 s were over: give it more time (--max-seconds)"), std::string::npos) << ran.output;
  // The warning may come before or after the JSON: skip to where the JSON begins and read to its end.
  const std::string text = ran.output.substr(ran.output.find("{\n"));
  const json out = json::parse(text.substr(0, text.rfind('}') + 1), nullptr, false);
  ASSERT_TRUE(out.is_object()) << ran.output;
  EXPECT_FALSE(out["reached"].get<bool>());
  EXPECT_TRUE(out["ended_by_time"].get<bool>());
  EXPECT_GT(out["rms_error"].get<double>(), 0.0001);
  EXPECT_FALSE(out["warning"].get<std::string>().empty());
  for (const json& point : out["points"]) EXPECT_GT(point["standard_error_lux"].get<double>(), 0) << point;
}

TEST(Enough, HoldsTheWorstPointToItsErrorOnRequest) {
  const json out = json_in(luxrig::testing::run(
      {program("luxrig"), "evaluate", source("tests/rigs/room"), "--worst-error", "0.02", "--json"}));
  ASSERT_TRUE(out.is_object());
  EXPECT_EQ(out["wanted_of"], "worst");
  EXPECT_TRUE(out["reached"].get<bool>()) << out;
  EXPECT_LE(2 * out["relative_error"].get<double>(), 0.02);
  EXPECT_EQ(luxrig::testing::run({program("luxrig"), "evaluate", source("tests/rigs/room"), "--worst-error", "0.02",
                                  "--max-error", "0.02"})
                .code,
            2)
      << "one of both";
}

TEST(Enough, StrictFailsOnlyWhenTheErrorIsNotReached) {
  SpoiltRoom room;
  const std::vector<std::string> too_much = {"--max-error", "0.0001", "--max-seconds", "1", "--strict"};
  EXPECT_EQ(room.run("evaluate", too_much).code, 1);
  EXPECT_EQ(room.run("solve", too_much).code, 1);
  EXPECT_EQ(room.run("evaluate", {"--strict"}).code, 0);
  EXPECT_EQ(room.run("solve", {"--strict"}).code, room.run("solve", {}).code);
}

}  // namespace
}  // namespace luxrig::testing
