// Heads aimed at an object's relief: solving, showing and running it; and plans that turn heads while the rig runs.
#include <cmath>
#include <fstream>

#include "core/geometry.h"
#include "tests/tools/programs/live_rig.h"

namespace luxrig::testing {
namespace {

json plan_of(const std::filesystem::path& file) { return json::parse(text_of(file), nullptr, false); }

json solved(const std::string& rig, const std::filesystem::path& plan, const std::string& threads = "0") {
  const Ran ran = luxrig::testing::run(
      {program("luxrig"), "solve", rig, "-o", plan.string(), "--model", "direct", "--threads", threads}, 120s);
  EXPECT_EQ(ran.code, 0) << ran.output;
  return plan_of(plan);
}

TEST(Aim, BringsOutTheFriezeWithinItsLimitsAndEvaluateAgrees) {
  const Folder folder;
  const Ran ran = luxrig::testing::run(
      {program("luxrig"), "solve", source("rigs/frieze"), "-o", (folder / "plan.json").string(), "--max-error", "0.03"},
      120s);
  ASSERT_EQ(ran.code, 0) << ran.output;
  EXPECT_NE(ran.output.find("relief (aim): local contrast"), std::string::npos) << ran.output;
  const json plan = plan_of(folder / "plan.json");
  const json& aim = plan["tasks"][1];
  EXPECT_EQ(aim["kind"], "aim");
  for (const char* key : {"local_contrast", "relative_contrast", "coverage", "object_lux", "lights", "watts"})
    EXPECT_TRUE(aim.contains(key)) << key;
  EXPECT_GT(aim["relative_contrast"].get<double>(), 1.05 * aim["before_relative_contrast"].get<double>());
  EXPECT_LE(aim["object_lux"].get<double>(), 200);
  bool turned = false;
  for (const json& light : aim["lights"])
    turned = turned || light["pan_deg"] != plan["tasks"][0]["lights"][0]["pan_deg"];
  EXPECT_TRUE(turned);
  for (const json& limit : plan["limits"]) EXPECT_TRUE(limit["met"].get<bool>()) << limit;
  // evaluate uses the heads' aims in the plan, not those in the rig file.
  const Ran lit = luxrig::testing::run({program("luxrig"), "evaluate", source("rigs/frieze"), "--levels",
                                        (folder / "plan.json").string(), "--max-error", "0.03", "--json"});
  ASSERT_EQ(lit.code, 0) << lit.output;
  const json seen = json_in(lit);
  for (std::size_t i = 0; i < plan["points"].size(); ++i) {
    const double lux = plan["points"][i]["lux"].get<double>();
    EXPECT_NEAR(seen["points"][i]["lux"].get<double>(), lux, 0.1 * lux + 0.5) << plan["points"][i];
  }
}

TEST(Aim, ExplainsWhatEachLightServes) {
  const Folder folder;
  std::vector<std::string> words = {
      program("luxrig"), "solve", source("rigs/studio"), "-o", (folder / "plan.json").string(), "--model", "direct"};
  EXPECT_EQ(luxrig::testing::run(words, 120s).output.find("serves"), std::string::npos);
  EXPECT_FALSE(plan_of(folder / "plan.json")["tasks"][1].contains("explained"));
  words.emplace_back("--explain");
  const Ran ran = luxrig::testing::run(words, 120s);
  ASSERT_EQ(ran.code, 0) << ran.output;
  const json explained = plan_of(folder / "plan.json")["tasks"][1]["explained"];
  const auto why = explained["why"].get<std::string>();
  EXPECT_NE(ran.output.find("relief: " + why), std::string::npos) << ran.output << why;
  double contrast = 0;
  for (const json& light : explained["lights"]) {
    contrast += light["contrast"].get<double>();
    EXPECT_NE(why.find(light["name"].get<std::string>() + " serves"), std::string::npos) << why;
  }
  EXPECT_EQ(explained["lights"].size(), 3u);
  EXPECT_NEAR(contrast, 1, 1e-9);
}

TEST(Aim, DoesNotDependOnTheThreads) {
  const Folder folder;
  const json one = solved(source("rigs/studio"), folder / "one.json", "1"),
             two = solved(source("rigs/studio"), folder / "two.json", "2");
  EXPECT_EQ(one["tasks"][1]["lights"], two["tasks"][1]["lights"]);
  EXPECT_EQ(one["points"], two["points"]);
}

/// A slab with a small square well: relief that needs no scan.
std::string rig_with_a_well(const Folder& folder, const std::string& task) {
  std::ofstream obj(folder / "well.obj");
  constexpr int kSide = 40;
  for (int i = 0; i <= kSide; ++i)
    for (int j = 0; j <= kSide; ++j) {
      const double x = (i - kSide / 2) * 0.02, y = (j - kSide / 2) * 0.02;
      const double r = std::hypot(x, y), z = -0.08 * std::exp(-std::pow(r / 0.12, 4));
      obj << "v " << x << ' ' << y << ' ' << z << '\n';
    }
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const int a = 1 + i * (kSide + 1) + j, b = a + kSide + 1;
      obj << "f " << a << ' ' << b << ' ' << b + 1 << "\nf " << a << ' ' << b + 1 << ' ' << a + 1 << '\n';
    }
  std::ofstream(folder / "rig.toml") << R"([rig]
name = "well"
[[scene.object]]
name = "slab"
file = "well.obj"
up_axis = "z"
position_m = [0, 0, 1]
[[scene.object]]
name = "ceiling"
box_m = [4, 4, 0.1]
position_m = [0, 0, 3]
[[luminaire]]
name = "spot"
model = "spot"
beam_angle_deg = 20
field_angle_deg = 40
lumens = 800
watts = 10
[[point]]
name = "beside"
position_m = [1, 0, 1.1]
max_lx = 900
)" << task;
  return (folder / "rig.toml").string();
}

TEST(Aim, UnlitHeadsAreComparedWithThemselvesAtFullLevelAndThatIsReported) {
  const Folder folder;
  const std::string rig = rig_with_a_well(folder, R"([[bus]]
name = "dmx"
driver = "sacn"
[[fixture]]
name = "head"
luminaire = "spot"
position_m = [0.9, 0.3, 2.9]
aim_m = [0, 0, 1]
bus = "dmx"
universe = 1
address = 1
slots = ["pan", "tilt", "dimmer"]
pan_range_deg = [-270, 270]
tilt_range_deg = [-135, 135]
pan_speed_deg_s = 180
tilt_speed_deg_s = 120
[[task]]
name = "relief"
kind = "aim"
object = "slab"
)");
  const Ran ran = luxrig::testing::run(
      {program("luxrig"), "solve", rig, "-o", (folder / "plan.json").string(), "--model", "direct"}, 120s);
  ASSERT_EQ(ran.code, 0) << ran.output;
  EXPECT_NE(ran.output.find("lx (as they hang, at full level: "), std::string::npos) << ran.output;
  EXPECT_EQ(ran.output.find(": 0.0)"), std::string::npos) << ran.output;
  EXPECT_GT(plan_of(folder / "plan.json")["tasks"][0]["before_local_contrast"].get<double>(), 0);
}

TEST(Highlight, FindsLightsOnTheCeilingAndThePlanCanBeShown) {
  const Folder folder;
  const std::string rig = rig_with_a_well(folder, R"([mounting]
surfaces = ["ceiling"]
[[task]]
name = "detail"
kind = "highlight"
luminaire = "spot"
object = "slab"
lights = 2
max_object_lx = 5000
)");
  const json plan = solved(rig, folder / "plan.json");
  const json& task = plan["tasks"][0];
  EXPECT_EQ(task["kind"], "highlight");
  ASSERT_EQ(task["lights"].size(), 2u) << task;
  for (const json& light : task["lights"]) {
    const auto at = light["position"].get<std::vector<double>>(), aim = light["aim"].get<std::vector<double>>();
    EXPECT_GT(at[2], 2.7) << "off the ceiling, below it";
    EXPECT_LT(at[2], 3);
    // On the well, within a beam.
    EXPECT_LT(std::hypot(aim[0], aim[1]), 0.6) << light;
    EXPECT_GT(light["level"].get<double>(), 0);
  }
  EXPECT_LE(task["object_lux"].get<double>(), 5000 * 1.001);
  EXPECT_GT(task["relative_contrast"].get<double>(), 0);
  EXPECT_TRUE(plan["limits"][0]["met"].get<bool>());
  const Ran lit =
      luxrig::testing::run({program("luxrig"), "evaluate", rig, "--levels", (folder / "plan.json").string(), "--json"});
  EXPECT_EQ(lit.code, 0) << lit.output;
}

TEST(Highlight, ChoosesTheNumberAndListsTheOthers) {
  const Folder folder;
  const std::string rig = rig_with_a_well(folder, R"([[task]]
name = "detail"
kind = "highlight"
luminaire = "spot"
object = "slab"
max_lights = 3
)");
  const json task = solved(rig, folder / "plan.json")["tasks"][0];
  ASSERT_EQ(task["numbers"].size(), 3u) << task;
  for (const json& number : task["numbers"]) EXPECT_GT(number["local_contrast"].get<double>(), 0);
  EXPECT_GE(task["lights"].size(), 1u);
  EXPECT_LE(task["lights"].size(), 3u);
}

TEST(Highlight, ReportsWhatAnObjectLacks) {
  const Folder folder;
  const std::string rig = rig_with_a_well(folder,
                                          "[[task]]\nname = \"detail\"\nkind = \"highlight\"\n"
                                          "luminaire = \"spot\"\nobject = \"slab\"\n");
  std::ofstream(folder / "well.obj") << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
  const Ran ran = luxrig::testing::run({program("luxrig"), "solve", rig});
  EXPECT_NE(ran.code, 0);
  EXPECT_NE(ran.output.find("object \"slab\": the target"), std::string::npos) << ran.output;
}

TEST(Aim, HeadsWithEmittersAreOneLightThatZooms) {
  const Folder folder;
  const std::string rig = rig_with_a_well(folder, R"([[luminaire]]
name = "wash"
model = "spot"
beam_angle_deg = 40
field_angle_deg = 70
zoom_deg = [5, 50]
emitters = [{ name = "warm", lumens = 600, watts = 8, cct_k = 2700 }, { name = "cold", lumens = 300, watts = 4 }]
[[bus]]
name = "dmx"
driver = "sacn"
[[fixture]]
name = "left"
luminaire = "wash"
position_m = [-1.5, 0, 2.5]
aim_m = [-0.5, 0, 1]
bus = "dmx"
address = 1
slots = ["pan", "tilt", "zoom", "emitter:warm", "emitter:cold"]
[[fixture]]
name = "right"
luminaire = "wash"
position_m = [1.5, 0.3, 2.5]
aim_m = [0.5, 0, 1]
bus = "dmx"
address = 11
slots = ["pan", "tilt", "zoom", "emitter:warm", "emitter:cold"]
zoom_inverted = true
[[task]]
name = "look"
kind = "aim"
object = "slab"
key = "left"
heads = ["left", "rig*"]
contrast = "lux"
)");
  const json plan = solved(rig, folder / "plan.json");
  const json& task = plan["tasks"][0];
  ASSERT_EQ(task["lights"].size(), 4u) << task;
  EXPECT_GT(task["relative_contrast"].get<double>(), 0);
  bool narrowed = false;
  for (std::size_t head = 0; head < 4; head += 2) {
    const json &warm = task["lights"][head], &cold = task["lights"][head + 1];
    for (const char* key : {"level", "pan_deg", "tilt_deg", "beam_angle_deg"}) EXPECT_EQ(warm[key], cold[key]) << key;
    const double beam_deg = warm["beam_angle_deg"].get<double>();
    EXPECT_GE(beam_deg, 5 - 1e-9);
    EXPECT_LE(beam_deg, 50 + 1e-9);
    narrowed = narrowed || (warm["level"].get<double>() > 0 && beam_deg < 20);
    EXPECT_NEAR(warm["lumens"].get<double>(), 2 * cold["lumens"].get<double>(), 1e-6);
  }
  // Contrast in lux over a well of 0.3 m favours the flux of a narrow beam.
  EXPECT_TRUE(narrowed) << task["lights"];
  const Ran lit = luxrig::testing::run(
      {program("luxrig"), "evaluate", rig, "--levels", (folder / "plan.json").string(), "--model", "direct", "--json"});
  ASSERT_EQ(lit.code, 0) << lit.output;
  const json seen = json_in(lit);
  EXPECT_NEAR(seen["points"][0]["lux"].get<double>(), plan["points"][0]["lux"].get<double>(), 1e-3);
}

TEST(Aim, AnAppliedPlanTurnsAHeadAndAnImpossibleOneIsRefused) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  const auto file = rig.file("plan.json");
  ASSERT_EQ(luxrig::testing::run(
                {program("luxrig"), "solve", source("tests/rigs/room"), "-o", file.string(), "--max-error", "0.05"})
                .code,
            0);
  json plan = plan_of(file);
  double pan_deg = 0;
  for (json& light : plan["tasks"][0]["lights"])
    if (light["name"] == "head-1") pan_deg = (light["pan_deg"] = light["pan_deg"].get<double>() - 25).get<double>();
  std::ofstream(file) << plan;
  const std::string port = std::to_string(rig.port());
  const Ran applied = luxrig::testing::run({program("luxrig"), "apply", file.string(), "--port", port}, 60s);
  ASSERT_EQ(applied.code, 0) << applied.output;
  ASSERT_TRUE(rig.wait_status([](const json& s) { return s["phase"] == "moving" || s["phase"] == "fading"; }, 5s));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.last().dump(1);
  const json truth = rig.truth();
  for (const json& fixture : truth["fixtures"]) {
    if (fixture["name"] == "head-1") {
      EXPECT_NEAR(fixture["pan_deg"].get<double>(), pan_deg, 0.1);
    }
  }
  EXPECT_TRUE(truth["violations"].empty()) << truth["violations"];

  // Beyond the end of its travel: refused, and nothing moves.
  for (json& light : plan["tasks"][0]["lights"])
    if (light["name"] == "head-1") light["tilt_deg"] = 170;
  std::ofstream(file) << plan;
  const Ran refused = luxrig::testing::run({program("luxrig"), "apply", file.string(), "--port", port}, 60s);
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.output.find("tilt_deg"), std::string::npos) << refused.output;
}

TEST(Aim, RunTakesPicturesBeforeAndAfter) {
  const Folder folder;
  const Ran ran = luxrig::testing::run({program("luxrig"), "run", source("tests/rigs/room"), "--sim", "--once",
                                        "--port", "0", "--pictures", (folder / "pictures").string()},
                                       150s);
  EXPECT_EQ(ran.code, 0) << ran.output;
  for (const char* name : {"door-before.png", "door-after.png"}) {
    EXPECT_EQ(text_of(folder / "pictures" / name).substr(1, 3), "PNG") << name;
    EXPECT_NE(ran.output.find(name), std::string::npos) << ran.output;
  }
  const Ran none = luxrig::testing::run(
      {program("luxrig"), "run", source("rigs/stage"), "--sim", "--pictures", (folder / "none").string()});
  EXPECT_EQ(none.code, 2);
  EXPECT_NE(none.output.find("has no [[camera]]"), std::string::npos) << none.output;
}

}  // namespace
}  // namespace luxrig::testing
