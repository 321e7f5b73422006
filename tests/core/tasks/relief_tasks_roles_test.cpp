/// Roles and set-ups of relief tasks, on a bust with lamps around it.
#include <fmt/format.h>

#include "core/tasks/light_role.h"
#include "tests/core/tasks/relief_tasks_fixture.h"

namespace luxrig {
namespace {

using namespace relief_tasks_fixture;

const Vec3 kMiddle_m{0, 0, 1.5};
constexpr double kLampAway_m = 2;

/// Aside of the camera, which looks from -y; positive to the picture's right.
Vec3 lamp_at(double aside_deg, double above_deg, double away_m = kLampAway_m) {
  const double aside = rad_from_deg(aside_deg), above = rad_from_deg(above_deg);
  return kMiddle_m +
         away_m * Vec3(std::cos(above) * std::sin(aside), -std::cos(above) * std::cos(aside), std::sin(above));
}

std::string head(const std::string& name, const Vec3& at_m, int address, bool dims_only = false) {
  return fmt::format(
      "[[fixture]]\nname = \"{}\"\nluminaire = \"spot\"\nposition_m = [{}, {}, {}]\naim_m = [0, 0, 1.5]\n"
      "bus = \"dmx\"\naddress = {}\nslots = [{}\"dimmer\"]\n{}",
      name, at_m.x(), at_m.y(), at_m.z(), address, dims_only ? "" : "\"pan\", \"tilt\", ",
      dims_only ? "" : "pan_range_deg = [-200, 200]\ntilt_range_deg = [-130, 130]\n");
}

const std::string kBust = R"([rig]
name = "bust"
[scene]
default_reflectance = 0.3
[[scene.object]]
name = "bust"
file = "bust.obj"
up_axis = "z"
position_m = [0, 0, 1.3]
[[scene.object]]
name = "backdrop"
box_m = [5, 0.02, 4]
position_m = [0, 1.5, -0.5]
[[camera]]
name = "front"
position_m = [0, -4, 1.5]
aim_m = [0, 0, 1.5]
fov_deg = 20
[[luminaire]]
name = "spot"
model = "spot"
beam_angle_deg = 20
field_angle_deg = 40
lumens = 800
[[bus]]
name = "dmx"
driver = "sacn"
)";

const std::string kTask =
    "[[task]]\nname = \"{}\"\nkind = \"aim\"\nobject = \"bust\"\nobjective = \"seen\"\n"
    "seen_by = \"front\"\nheads = [{}]\n{}";

std::string task(const std::string& name, const std::string& heads, const std::string& more) {
  return fmt::format(fmt::runtime(kTask), name, heads, more);
}

/// Whether a direction is in the window of a camera that looks from -y at a sphere, to 1°.
bool in_window(enum SetUp set_up, const Vec3& towards) {
  const LightWindow window(set_up, LightRole::any, {-Vec3::UnitY(), Vec3::UnitX(), -Vec3::UnitY(), 0});
  for (const double about_x : {0.0, -1.0, 1.0})
    for (const double about_z : {0.0, -1.0, 1.0})
      if (window.has(Eigen::AngleAxisd(rad_from_deg(about_x), Vec3::UnitX()) *
                     (Eigen::AngleAxisd(rad_from_deg(about_z), Vec3::UnitZ()) * towards)))
        return true;
  return false;
}

/// A sphere of 0.2 m with waves of 1 cm.
class LightRoles : public ReliefTask {
 protected:
  void SetUp() override {
    ReliefTask::SetUp();
    constexpr int kAround = 72, kUp = 36;
    std::ofstream obj(folder_ / "bust.obj");
    for (int j = 0; j <= kUp; ++j)
      for (int i = 0; i < kAround; ++i) {
        const double phi = 2 * kPi * i / kAround, theta = kPi * (0.01 + 0.98 * j / kUp);
        const double radius_m = 0.2 + 0.01 * std::sin(theta) * std::cos(8 * phi) * std::cos(6 * theta);
        obj << "v " << radius_m * std::sin(theta) * std::cos(phi) << ' ' << radius_m * std::sin(theta) * std::sin(phi)
            << ' ' << radius_m * std::cos(theta) << '\n';
      }
    for (int j = 0; j < kUp; ++j)
      for (int i = 0; i < kAround; ++i) {
        const int a = 1 + j * kAround + i, b = 1 + j * kAround + (i + 1) % kAround, c = b + kAround, d = a + kAround;
        obj << "f " << a << ' ' << d << ' ' << c << "\nf " << a << ' ' << c << ' ' << b << '\n';
      }
  }
  [[nodiscard]] SolvedTasks solved(const std::string& rig) const { return solved_of(well(rig), direct_light()); }
};

double level_of(const SolvedTasks& solved, std::size_t task, const std::string& name) {
  for (const PlannedLight& light : solved.plan.tasks[task].lights)
    if (light.name == name) return light.level;
  ADD_FAILURE() << "no " << name;
  return -1;
}

const std::string kHeadsAround = head("low", lamp_at(-20, 0), 1) + head("loop", lamp_at(37, 20), 11) +
                                 head("high", lamp_at(-45, 45), 21) + head("side", lamp_at(90, 0), 31) +
                                 head("behind", lamp_at(150, 40), 41) + head("left", lamp_at(-45, 0), 51) +
                                 head("right", lamp_at(45, 0), 61);

TEST_F(LightRoles, OnlyTheHeadOfTheSetUpIsLit) {
  const std::pair<const char*, const char*> wanted[] = {{"rembrandt", "high"}, {"loop", "loop"}, {"split", "side"}};
  for (const auto& [set_up, name] : wanted) {
    const SolvedTasks of =
        solved(kBust + kHeadsAround + task("key", "\"*\"", fmt::format("role = \"key\"\nset_up = \"{}\"\n", set_up)));
    for (const PlannedLight& light : of.plan.tasks[0].lights)
      EXPECT_EQ(light.level > 0, light.name == name) << set_up << ": " << light.name;
    ASSERT_EQ(of.reasons.size(), 1u);
    EXPECT_EQ(of.reasons[0].dark, 6u);
    EXPECT_GT(*of.plan.tasks[0].relief->lit_share, 0.3);
  }
}

TEST_F(LightRoles, CopyIsAPairThatLightsEvenly) {
  const SolvedTasks of = solved(kBust + kHeadsAround + task("copy", "\"*\"", "set_up = \"copy\"\n"));
  for (const PlannedLight& light : of.plan.tasks[0].lights)
    EXPECT_EQ(light.level > 0, light.name == "left" || light.name == "right") << light.name;
  EXPECT_NEAR(level_of(of, 0, "left"), level_of(of, 0, "right"), 0.05);
}

TEST_F(LightRoles, ASetUpWithoutAHeadSaysWhatToHangWhere) {
  const std::string text = refusal_of(kBust + head("low", lamp_at(-20, 0), 1) +
                                      task("key", "\"*\"", "role = \"key\"\nset_up = \"rembrandt\"\n"));
  EXPECT_NE(text.find("30 to 60° aside of the camera and 30 to 60° above the level"), std::string::npos) << text;
  // 45° and 45°, as far off as the head that hangs.
  const Vec3 there_m = lamp_at(45, 45);
  EXPECT_NE(text.find(fmt::format("{:.2f} {:.2f} {:.2f}", there_m.x(), there_m.y(), there_m.z())), std::string::npos)
      << text;
  const std::string pair = refusal_of(kBust + head("left", lamp_at(-45, 0), 1) + head("low", lamp_at(-20, 0), 11) +
                                      task("copy", "\"*\"", "set_up = \"copy\"\n"));
  const Vec3 right_m = lamp_at(45, 0);
  EXPECT_NE(pair.find(fmt::format("hang one at {:.2f} {:.2f}", right_m.x(), right_m.y())), std::string::npos) << pair;
}

// The key is left alone (locked by leaving it out of heads) and the fill brings what the ratio asks.
TEST_F(LightRoles, FillKeepsItsRatioToTheKeyThatIsThere) {
  const std::string heads = kBust + head("key", lamp_at(-70, 20), 1) + head("fill", lamp_at(45, 5), 11);
  const std::string key = task("key", "\"key\"", "role = \"key\"\n");
  std::vector<double> own_lx;
  for (const double ratio : {2.0, 4.0, 8.0}) {
    const SolvedTasks of =
        solved(heads + key + task("fill", "\"fill\"", fmt::format("role = \"fill\"\nratio = {}\n", ratio)));
    EXPECT_NEAR(*of.plan.tasks[1].relief->key_to_fill, ratio, 0.01 * ratio);
    own_lx.push_back(of.reasons[1].score.role->wanted_lx);
    EXPECT_GT(level_of(of, 1, "fill"), 0);
    EXPECT_GT(*of.plan.tasks[1].relief->lit_share, *of.plan.tasks[0].relief->lit_share);
  }
  // With what light the dark parts have already, each is half of the one before.
  EXPECT_NEAR((own_lx[0] - own_lx[1]) / (own_lx[1] - own_lx[2]), 2, 0.05);
  EXPECT_NE(refusal_of(heads + task("fill", "\"fill\"", "role = \"fill\"\n")).find("put the key's task before it"),
            std::string::npos);
}

TEST_F(LightRoles, KeyKeepsItsRatioToAllOtherLight) {
  const SolvedTasks of = solved(kBust + head("key", lamp_at(-45, 30), 1) + head("other", lamp_at(30, 0, 4), 11) +
                                task("other", "\"other\"", "") + task("key", "\"key\"", "role = \"key\"\nratio = 2\n"));
  EXPECT_NEAR(*of.plan.tasks[1].relief->key_to_fill, 2, 0.02);
}

TEST_F(LightRoles, RimIsFromBehindAndLeavesTheFrontDark) {
  const SolvedTasks of = solved(kBust + kHeadsAround + task("key", "\"loop\"", "role = \"key\"\n") +
                                task("rim", "\"low\", \"behind\", \"side\"", "role = \"rim\"\n"));
  EXPECT_GT(level_of(of, 1, "behind"), 0);
  EXPECT_EQ(level_of(of, 1, "low"), 0);
  EXPECT_EQ(level_of(of, 1, "side"), 0);
  const RoleScore& rim = *of.reasons[1].score.role;
  EXPECT_GT(rim.wanted_lx, 0);
  EXPECT_LE(rim.spared_lx, kRimSpill * rim.wanted_lx * 1.01);
}

TEST_F(LightRoles, BackgroundLightsWhatIsBehindAndSparesTheObject) {
  const Vec3 aside_m{-2, 0.6, 1.6};
  const SolvedTasks of =
      solved(kBust + head("key", lamp_at(-40, 30), 1) + head("wall", aside_m, 11) +
             task("key", "\"key\"", "role = \"key\"\n") + task("wall", "\"wall\"", "role = \"background\"\n"));
  EXPECT_GT(level_of(of, 1, "wall"), 0);
  const RoleScore& wall = *of.reasons[1].score.role;
  EXPECT_GT(wall.wanted_lx, 0);
  EXPECT_LE(wall.spared_lx, kBackgroundSpill * wall.wanted_lx * 1.01);
  EXPECT_GT(wall.even, 0.5);
}

TEST_F(LightRoles, PlacesComeOutInTheirWindows) {
  const std::string mounting = "[mounting]\nbox_m = [[-2.5, -3, 0.2], [2.5, 1.4, 4]]\n";
  for (const char* set_up : {"rembrandt", "loop", "split", "broad", "raking", "copy"}) {
    const SolvedTasks of = solved(kBust +
                                  fmt::format("[[task]]\nname = \"key\"\nkind = \"highlight\"\nluminaire = \"spot\"\n"
                                              "object = \"bust\"\nobjective = \"seen\"\nseen_by = \"front\"\n"
                                              "set_up = \"{}\"\n",
                                              set_up) +
                                  mounting);
    const auto& lights = of.plan.tasks[0].lights;
    const bool copy = std::string(set_up) == "copy";
    ASSERT_EQ(lights.size(), copy ? 2u : 1u) << set_up;
    const SetUpFrame frame{-Vec3::UnitY(), Vec3::UnitX(), -Vec3::UnitY(), 0};
    enum SetUp asked = SetUp::none;
    for (int k = 1; k <= static_cast<int>(SetUp::copy); ++k)
      if (std::string(set_up) == name_of(static_cast<enum SetUp>(k))) asked = static_cast<enum SetUp>(k);
    for (const PlannedLight& light : lights) {
      const Vec3 towards = light.position_world_m - kMiddle_m;
      const AsideAbove at = aside_above(frame, towards);
      EXPECT_TRUE(in_window(asked, towards))
          << set_up << ": " << deg_from_rad(at.aside_rad) << "° aside, " << deg_from_rad(at.above_rad) << "° above";
    }
    if (!copy) continue;
    EXPECT_LT(lights[0].position_world_m.x() * lights[1].position_world_m.x(), 0);
  }
}

TEST_F(LightRoles, DirectionsComeOutInTheirWindows) {
  const auto held = [&](const std::string& set_up) {
    return solved(kBust + fmt::format("[[task]]\nname = \"held\"\nkind = \"directions\"\nobject = \"bust\"\n"
                                      "seen_by = \"front\"\ndistance_m = 1\nset_up = \"{}\"\n",
                                      set_up))
        .plan.tasks[0]
        .directions;
  };
  for (const auto& [name, asked] : {std::pair{"rembrandt", SetUp::rembrandt}, {"raking", SetUp::raking}}) {
    const auto lamps = held(name);
    ASSERT_EQ(lamps.size(), 1u) << name;
    EXPECT_TRUE(in_window(asked, lamps[0].towards_world)) << name;
  }
  const auto pair = held("copy");
  ASSERT_EQ(pair.size(), 2u);
  for (const PlannedDirection& lamp : pair) EXPECT_TRUE(in_window(SetUp::copy, lamp.towards_world));
  EXPECT_LT(pair[0].towards_world.x() * pair[1].towards_world.x(), 0);
}

// A light that is alone serves all; two of which one is dark say so.
TEST_F(LightRoles, ReasonsSayWhatEachLightServes) {
  const SolvedTasks of =
      solved(kBust + head("key", lamp_at(-60, 30), 1) + head("other", lamp_at(60, 10), 11) + task("look", "\"*\"", ""));
  const ReliefReasons& reasons = of.reasons.at(0);
  ASSERT_EQ(reasons.lights.size(), 2u);
  double lit = 0;
  for (const LightService& light : reasons.lights) lit += light.lit;
  EXPECT_NEAR(lit, 1, 1e-9);
  const std::string why = in_two_sentences(reasons);
  EXPECT_EQ(std::count(why.begin(), why.end(), '.'), 2) << why;
  EXPECT_NE(why.find("key serves"), std::string::npos) << why;
  EXPECT_NE(why.find("of what is seen is lit"), std::string::npos) << why;
}

}  // namespace
}  // namespace luxrig
