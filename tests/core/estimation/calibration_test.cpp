#include "core/estimation/calibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/output/dimming.h"

namespace luxrig {
namespace {

Calibration example() {
  Calibration calibration;
  calibration.rig = "gallery";
  calibration.made = "2026-11-28T06:12:00Z";
  calibration.made_for = 0xfeedULL << 40;
  CalibratedFixture lamp;
  lamp.name = "wash/red";
  lamp.output = {1.07, 0.012};
  lamp.first = {"2026-08-01T06:12:00Z", {1.12, 0.01}};
  lamp.offset_m = {0.03, -0.05, 0};
  lamp.offset_error_m = {0.01, 0.01, 0.02};
  lamp.turn_deg = {1, 0, -2};
  lamp.turn_error_deg = {0.2, 0.2, 0.4};
  lamp.curve = {{0.1, 0.04}, {0.5, 0.42}, {1, 1}};
  lamp.curve_error = 0.01;
  calibration.simulated = "real, seed 3";
  CalibratedFixture spot;
  spot.name = "spot";
  CalibratedHead& head = spot.head.emplace();
  head.upside_down = true;
  head.pan_scale = {-0.857, 0.001};
  head.tilt_scale = {1.002, 0.001};
  head.tilt_zero_deg = {-1.5, 0.05};
  head.askew_deg = {0.7, 0.05};
  head.pan_backlash_deg = {0.9, 0.02};
  head.tilt_backlash_deg = {1.1, 0.02};
  head.settling_s = {0.4, 0.1};
  calibration.fixtures = {lamp, spot};
  calibration.materials = {{"plaster, white", {0.93, 0.02}}};
  calibration.luxmeters = {{"meter", {1.01, 0.004}}};
  calibration.lights = {{"picture", "spot", {410, 6}}, {"picture", "wash/red", {0, 0.1}}};
  CalibratedCamera camera;
  camera.name = "balcony \"left\"";
  camera.offset_m = {0.02, -0.01, 0.005};
  camera.offset_error_m = {0.004, 0.002, 0.003};
  camera.turn_deg = {0.4, -0.9, 0.1};
  camera.turn_error_deg = {0.05, 0.06, 0.02};
  camera.fov_deg = {58.3, 0.1};
  camera.distortion = {-0.012, 0.002};
  camera.lens_loss = {Known{0.3, 0.02}, Known{-0.1, 0.05}, Known{0.04, 0.04}};
  camera.flare = {0.012, 0.003};
  camera.halo = {-0.001, 0.004};
  camera.responses = {{"amber/wide", {1.9, 0.1}}, {"white", {0.003, 0.0001}}};
  calibration.cameras = {camera};
  return calibration;
}

/// What is wrong with this text, as a person reads it.
std::string refused(const std::string& text) {
  const auto read = calibration_from_json(text, "c.json");
  return read ? "nothing" : read.error().front().text();
}

std::string with(const std::string& fixture) {
  return R"({"luxrig_calibration": 1, "rig": "r", "made": "today",
"fixtures": {"lamp": )" +
         fixture + "}}";
}

TEST(Calibration, IsTheSameAfterItsFile) {
  const std::string text = to_json(example());
  const auto read = calibration_from_json(text, "c.json");
  ASSERT_TRUE(read) << read.error().front().text();
  EXPECT_EQ(to_json(*read), text);
  ASSERT_EQ(read->fixtures.size(), 2u);  // by name
  EXPECT_EQ(read->fixtures[1].name, "wash/red");
  EXPECT_EQ(read->fixtures[1].output, (Known{1.07, 0.012}));
  ASSERT_TRUE(read->fixtures[1].first);
  EXPECT_EQ(read->fixtures[1].first->since, "2026-08-01T06:12:00Z");
  EXPECT_EQ(read->fixtures[1].first->output, (Known{1.12, 0.01}));
  EXPECT_FALSE(read->fixtures[0].first);
  EXPECT_EQ(read->fixtures[1].turn_deg, example().fixtures[0].turn_deg);
  EXPECT_EQ(read->fixtures[1].curve, example().fixtures[0].curve);
  ASSERT_TRUE(read->fixtures[0].head);
  EXPECT_TRUE(read->fixtures[0].head->upside_down);
  EXPECT_EQ(read->fixtures[0].head->pan_scale, (Known{-0.857, 0.001}));
  EXPECT_EQ(read->fixtures[0].head->settling_s, (Known{0.4, 0.1}));
  EXPECT_EQ(read->fixtures[0].head->pan_speed_deg_s, Known{}) << "not measured";
  EXPECT_FALSE(read->fixtures[1].head);
  EXPECT_EQ(read->made_for, example().made_for);
  ASSERT_EQ(read->lights.size(), 2u);
  EXPECT_EQ(read->lights[0].lux, (Known{410, 6}));
  ASSERT_EQ(read->cameras.size(), 1u);
  const CalibratedCamera &camera = read->cameras[0], wrote = example().cameras[0];
  EXPECT_EQ(camera.name, wrote.name);
  EXPECT_EQ(camera.offset_m, wrote.offset_m);
  EXPECT_EQ(camera.offset_error_m, wrote.offset_error_m);
  EXPECT_EQ(camera.turn_deg, wrote.turn_deg);
  EXPECT_EQ(camera.turn_error_deg, wrote.turn_error_deg);
  EXPECT_EQ(camera.fov_deg, wrote.fov_deg);
  EXPECT_EQ(camera.distortion, wrote.distortion);
  EXPECT_EQ(camera.lens_loss, wrote.lens_loss);
  EXPECT_EQ(camera.flare, wrote.flare);
  EXPECT_EQ(camera.halo, wrote.halo);
  EXPECT_EQ(camera.responses, wrote.responses);
}

TEST(Calibration, WithoutACameraHasTheBytesThatItHadBefore) {
  Calibration none = example();
  none.cameras.clear();
  EXPECT_EQ(to_json(none).find("cameras"), std::string::npos);
  const auto read = calibration_from_json(to_json(none), "c.json");
  ASSERT_TRUE(read) << read.error().front().text();
  EXPECT_TRUE(read->cameras.empty());
}

TEST(Calibration, SaysWhatIsWrongOfACamera) {
  const auto of_camera = [](const std::string& camera) {
    return refused(R"({"luxrig_calibration": 1, "rig": "r", "made": "today",
"cameras": {"front": )" +
                   camera + "}}");
  };
  EXPECT_EQ(of_camera(R"({"fov_deg": [40, 0.1]})"), "nothing");
  EXPECT_EQ(of_camera(R"({"fov_deg": [40, 0.1], "response": {"led": [0, 0.1]}})").find("c.json:2:"), 0u);
  EXPECT_NE(of_camera("{}").find("/cameras/front/fov_deg is missing: measure the rig again"), std::string::npos)
      << of_camera("{}");
  for (const char* wrong :
       {"7", R"({"fov_deg": 40})", R"({"fov_deg": [0, 0]})", R"({"fov_deg": [180, 1]})", R"({"fov_deg": [40, -1]})",
        R"({"fov_deg": [40, 1], "offset_m": [0, 9, 0]})", R"({"fov_deg": [40, 1], "turn_deg": [1, 2]})",
        R"({"fov_deg": [40, 1], "distortion": [3, 0]})", R"({"fov_deg": [40, 1], "lens_b": [1e9, 0]})",
        R"({"fov_deg": [40, 1], "flare": [2, 0]})", R"({"fov_deg": [40, 1], "halo": "much"})",
        R"({"fov_deg": [40, 1], "response": 1})", R"({"fov_deg": [40, 1], "response": {"led": 1}})",
        R"({"fov_deg": [40, 1], "response": {"led": [1, -1]}})"})
    EXPECT_NE(of_camera(wrong), "nothing") << wrong;
}

TEST(Calibration, SaysWhereAndWhatIsWrong) {
  EXPECT_EQ(refused(with(R"({"output": [1.1, 0.01]})")), "nothing");
  EXPECT_EQ(refused(with(R"({"output": [0, 0.01]})")).find("c.json:2:"), 0u) << refused(with(R"({"output": [0, 1]})"));
  for (const char* wrong :
       {"{}",
        "7",
        R"({"output": 1})",
        R"({"output": [1, -0.1]})",
        R"({"output": [1e400, 0]})",
        R"({"output": [99, 0]})",
        R"({"output": [1, 0], "offset_m": [1, 2]})",
        R"({"output": [1, 0], "head": 1})",
        R"({"output": [1, 0], "head": {}})",
        R"({"output": [1, 0], "first": 1})",
        R"({"output": [1, 0], "first": {"since": "today"}})",
        R"({"output": [1, 0], "first": {"output": [1, 0]}})",
        R"({"output": [1, 0], "first": {"since": 3, "output": [0, 0]}})",
        R"({"output": [1, 0], "head": {"pan_scale": [0, 0.1], "tilt_scale": [1, 0]}})",
        R"({"output": [1, 0], "head": {"pan_scale": [1, 0], "tilt_scale": [1, 0], "askew_deg": [50, 0]}})",
        R"({"output": [1, 0], "head": {"pan_scale": [1, 0], "tilt_scale": [1, 0], "upside_down": "no"}})",
        R"({"output": [1, 0], "offset_m": [0, 0, 9]})",
        R"({"output": [1, 0], "turn_deg": [0, 0, 400]})",
        R"({"output": [1, 0], "curve": [[0.5, 0.4]]})",
        R"({"output": [1, 0], "curve": [[1, 1]]})",
        R"({"output": [1, 0], "curve": [[0.5, 0.4], [0.4, 0.5], [1, 1]]})",
        R"({"output": [1, 0], "curve": [[0, 0], [1, 1]]})",
        R"({"output": [1, 0], "curve": [[0.5, "x"], [1, 1]]})"})
    EXPECT_NE(refused(with(wrong)), "nothing") << wrong;
  EXPECT_NE(refused("[]"), "nothing");
  EXPECT_NE(refused(R"({"luxrig_calibration": 2, "rig": "r", "made": ""})"), "nothing");
}

TEST(Calibration, NeverThrowsOnBrokenText) {
  std::mt19937_64 random(5);
  const std::string whole = to_json(example());
  for (int k = 0; k < 3000; ++k) {
    std::string text = whole;
    for (int edits = 1 + static_cast<int>(random() % 4); edits > 0; --edits) {
      const std::size_t at = random() % text.size();
      if (random() % 3 == 0)
        text.erase(at, 1 + random() % 20);
      else
        text[at] = "{}[]\",:0-9e.x\n"[random() % 14];
      if (text.empty()) text = " ";
    }
    const auto read = calibration_from_json(text, "c.json");
    if (!read)
      for (const Problem& problem : read.error()) EXPECT_FALSE(problem.mend.empty());
  }
}

TEST(Calibration, NamesThatTheRigDoesNotHaveAreProblems) {
  Rig rig;
  rig.name = "gallery";
  const auto applied = calibrated(rig, example(), "c.json");
  ASSERT_FALSE(applied);
  EXPECT_EQ(applied.error().size(), 2u);
  rig.name = "hall";
  Calibration of_gallery;
  of_gallery.rig = "gallery";
  EXPECT_EQ(calibrated(rig, of_gallery, "c.json").error().size(), 1u);
}

TEST(Calibration, IsLaidOverTheRig) {
  Rig rig;
  rig.name = "gallery";
  Luminaire luminaire;
  luminaire.name = "bulb";
  luminaire.lumens = 1000;
  luminaire.intensity = make_isotropic(1000);
  rig.luminaires = {luminaire};
  rig.fixtures.resize(2);
  rig.fixtures[0].name = "wash/red";
  rig.fixtures[1].name = "spot";
  const auto applied = calibrated(rig, example(), "c.json");
  ASSERT_TRUE(applied) << applied.error().front().text();
  const Fixture& lamp = applied->fixtures[0];
  EXPECT_NEAR(applied->luminaires[lamp.luminaire].intensity->flux_lm(), 1070, 1e-9);
  EXPECT_NEAR(applied->luminaires[applied->fixtures[1].luminaire].intensity->flux_lm(), 1000, 1e-9);
  EXPECT_TRUE(lamp.world_from_mount.translation_m.isApprox(Vec3(0.03, -0.05, 0)));
  const Eigen::AngleAxisd turned(lamp.world_from_mount.rotation);
  EXPECT_NEAR(turned.angle(), rad_from_deg(std::sqrt(5.0)), 1e-12);
  EXPECT_EQ(applied->scene.paint.size(), 1u);
  EXPECT_TRUE(applied->cameras.empty()) << "one that is gone lights nothing";
  // Half of its full light needs more than half of its drive.
  EXPECT_NEAR(level_at(lamp, drive_for(lamp, 0.5)), 0.5, 1e-12);
  EXPECT_GT(drive_for(lamp, 0.5), 0.5);
}

TEST(Calibration, TurnsAHeadToWhereItShallLookFromItsTruePlace) {
  Rig rig;
  rig.name = "gallery";
  rig.fixtures.resize(2);
  rig.luminaires.resize(1);
  rig.luminaires[0].intensity = make_isotropic(1000);
  rig.luminaires[0].lumens = 1000;
  for (const char* name : {"wash/red", "spot"}) rig.fixtures[name[0] == 's'].name = name;
  Fixture& head = rig.fixtures[0];
  head.moves = true;
  head.range = {-kPi, kPi, -kPi / 2, kPi / 2};
  head.world_from_mount.translation_m = Vec3(0, 0, 3);
  head.aim_world_m = Vec3(1, 2, 0);
  const auto applied = calibrated(rig, example(), "c.json");
  ASSERT_TRUE(applied) << applied.error().front().text();
  const Pose lamp = applied->fixtures[0].world_from_lamp();
  const Vec3 wanted = (*head.aim_world_m - lamp.translation_m).normalized();
  EXPECT_GT(lamp.rotation.col(2).cwiseAbs().dot(wanted.cwiseAbs()), 0.999999) << "its axis, up or down";
  EXPECT_EQ(applied->calibrated, example().made);
  // What is left uncertain: of the one lamp its curve's 1 %, of the other its light at the one point that it lights.
  ASSERT_TRUE(applied->fixtures[0].known_to && applied->fixtures[1].known_to);
  EXPECT_NEAR(applied->fixtures[0].known_to->output, 0.012 / 1.07, 1e-12);
  EXPECT_NEAR(applied->fixtures[0].known_to->local, 0.01, 1e-12);
  EXPECT_NEAR(applied->fixtures[1].known_to->local, 6.0 / 410, 1e-12);
  EXPECT_TRUE(std::isnan(applied->fixtures[1].known_to->output)) << "not measured: as wide as the rig file allows";
  // An aim that it cannot reach is said, not approached.
  rig.fixtures[0].range = {0, 0.01, 0, 0.01};
  const auto refused = calibrated(rig, example(), "c.json");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().front().text().find("out of its reach"), std::string::npos);
}

TEST(MeasuredCurve, RisesAndItsInverseReturnsTheLevel) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> unit(0.01, 1);
  for (int k = 0; k < 300; ++k) {
    // A power with a wobble, at random levels.
    const double exponent = 0.8 + 1.6 * unit(random);
    std::vector<double> levels{1};
    for (std::size_t n = 1 + random() % 6; n > 0; --n) levels.push_back(unit(random));
    std::sort(levels.begin(), levels.end());
    levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
    if (levels.size() < 2) continue;
    MeasuredCurve curve;
    for (const double level : levels) curve.emplace_back(level, std::pow(level, exponent));
    double before = 0;
    for (int i = 1; i <= 200; ++i) {
      const double level = i / 200.0, share = share_at_level(curve, level);
      EXPECT_GT(share, before);
      before = share;
      EXPECT_NEAR(share, std::pow(level, exponent), 1e-9) << "a power is met everywhere";
      EXPECT_NEAR(level_of_share(curve, share), level, 1e-9);
    }
    EXPECT_EQ(share_at_level(curve, 0), 0);
    EXPECT_EQ(share_at_level(curve, 1), 1);
  }
}

}  // namespace
}  // namespace luxrig
