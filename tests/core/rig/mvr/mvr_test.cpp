// MVR files: real ones against the values in their XML, and small ones made here.
#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "core/rig/mvr/mvr_rig.h"
#include "core/rig/rig_file.h"
#include "core/text/plain_text.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

const std::filesystem::path kMvr = test::source_folder() / "tests/data/fixtures";

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return std::string((std::istreambuf_iterator<char>(in)), {});
}

/// Writes an imported rig into a folder of its own and reads it.
Checked<Rig> written_and_read(const ImportedRig& imported, const std::string& name) {
  const auto folder = std::filesystem::temp_directory_path() / ("luxrig_mvr_test_" + name);
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  for (const ImportedRig::File& file : imported.files)
    std::ofstream(folder / file.name, std::ios::binary) << file.bytes;
  std::ofstream(folder / "rig.toml") << imported.rig_toml;
  Checked<Rig> rig = load_rig(folder);
  std::filesystem::remove_all(folder);
  return rig;
}

TEST(Mvr, SevenFixturesStandAndTurnAsTheFileStates) {
  const Checked<MvrFile> mvr = read_mvr(bytes_of(kMvr / "7-fixtures-sample.mvr"), "7.mvr");
  ASSERT_TRUE(mvr) << mvr.error().front().text();
  ASSERT_EQ(mvr->scene.fixtures.size(), 7u);
  ASSERT_EQ(mvr->gdtf_files.size(), 1u) << "named without its extension in the scene";
  const MvrFixture& second = mvr->scene.fixtures[1];  // {0,-1,0}{0,0,-1}{1,0,0}{5000,0,0}
  EXPECT_EQ(second.world_from_base.translation_m, Vec3(5, 0, 0));
  EXPECT_LT((second.world_from_base.direction(Vec3::UnitX()) - Vec3(0, -1, 0)).norm(), 1e-12);
  EXPECT_LT((second.world_from_base.direction(Vec3::UnitZ()) - Vec3(1, 0, 0)).norm(), 1e-12);
  EXPECT_TRUE(second.addresses.empty()) << "0 is not patched";

  const ImportedRig imported = rig_of_mvr(*mvr, "seven");
  const Checked<Rig> rig = written_and_read(imported, "seven");
  ASSERT_TRUE(rig) << rig.error().front().text();
  ASSERT_EQ(rig->fixtures.size(), 7u);
  EXPECT_EQ(rig->luminaires.size(), 1u);
  EXPECT_EQ(rig->luminaires[0].lumens, 10000);
  EXPECT_NEAR(deg_from_rad(rig->luminaires[0].beam_angle_rad), 25, 1e-9);
  for (std::size_t i = 0; i < 7; ++i) {
    const MvrFixture& from = mvr->scene.fixtures[i];
    const Fixture& to = rig->fixtures[i];
    EXPECT_LT((to.world_from_mount.rotation - from.world_from_base.rotation).norm(), 2e-5) << i;
    // The pivot is the body's origin: 0.079450 + 0.280664 + 0.148184 below the fixture's.
    const Vec3 pivot_in_base(-0.001187 + 0.000019, -0.019933 + 0.019933 - 0.000008, -0.508298);
    EXPECT_LT((to.world_from_mount.translation_m - from.world_from_base.point(pivot_in_base)).norm(), 1e-4) << i;
    EXPECT_TRUE(to.moves);
    const auto& patch = std::get<DmxPatch>(to.patch);
    EXPECT_EQ(patch.universe, 1);
    EXPECT_EQ(patch.address, 1 + 16 * static_cast<int>(i)) << "made up, one after another";
  }
  EXPECT_EQ(rig->fixtures[6].name, "Robe ColorWash 2500 AT 7");
}

TEST(Mvr, TheParHasItsGdtfsBeam) {
  const Checked<MvrFile> mvr = read_mvr(bytes_of(kMvr / "basic_fixture.mvr"), "basic.mvr");
  ASSERT_TRUE(mvr) << mvr.error().front().text();
  const Checked<Rig> rig = written_and_read(rig_of_mvr(*mvr, "basic"), "basic");
  ASSERT_TRUE(rig) << rig.error().front().text();
  ASSERT_EQ(rig->fixtures.size(), 1u);
  EXPECT_EQ(rig->luminaires[0].lumens, 7000);
  EXPECT_NEAR(deg_from_rad(rig->luminaires[0].beam_angle_rad), 60, 1e-9);
  EXPECT_NEAR(deg_from_rad(rig->luminaires[0].field_angle_rad), 90, 1e-9);
  EXPECT_EQ(*rig->luminaires[0].watts, 216);
  EXPECT_LT((rig->fixtures[0].world_from_mount.translation_m - Vec3(5, 5, 5 - 0.134)).norm(), 1e-9) << "at its lens";
}

// The matrix in the examples of the MVR specification: rows are the directions of x, y and z, then the origin in mm.
TEST(Mvr, TheSpecificationsMatrixGivesPlaceAndRotationByItsRows) {
  const Checked<MvrScene> scene = parse_mvr_scene(
      R"(<GeneralSceneDescription verMajor="1" verMinor="6"><Scene><Layers><Layer name="l"><ChildList><Fixture name="a">)"
      "<Matrix>{0.158127,-0.987419,0.000000}{0.987419,0.158127,0.000000}{0.000000,0.000000,1.000000}"
      "{6020.939200,2838.588955,4978.134459}</Matrix></Fixture></ChildList></Layer></Layers></Scene>"
      "</GeneralSceneDescription>",
      "spec.xml");
  ASSERT_TRUE(scene) << scene.error().front().text();
  const Pose& pose = scene->fixtures.at(0).world_from_base;
  EXPECT_LT((pose.translation_m - Vec3(6.0209392, 2.838588955, 4.978134459)).norm(), 1e-9);
  EXPECT_LT((pose.rotation.col(0) - Vec3(0.158127, -0.987419, 0)).norm(), 1e-5) << "where its x points";
  EXPECT_LT((pose.rotation.col(1) - Vec3(0.987419, 0.158127, 0)).norm(), 1e-5) << "where its y points";
  EXPECT_NEAR(mount_deg_of(pose.rotation).x(), -80.902, 1e-3) << "turned clockwise, seen from above";
}

std::string scene_of(const std::string& children) {
  return R"(<GeneralSceneDescription verMajor="1" verMinor="6"><Scene><Layers><Layer name="l"><ChildList>)" + children +
         "</ChildList></Layer></Layers></Scene></GeneralSceneDescription>";
}
std::string fixture_of(const std::string& name, const std::string& inside) {
  return "<Fixture name=\"" + name + "\">" + inside + "</Fixture>";
}

TEST(Mvr, GroupsMultiplyFocusPointsAimAndAddressesCountFromOne) {
  const std::string turned = "<Matrix>{0,1,0}{-1,0,0}{0,0,1}{1000,0,0}</Matrix>";  // a quarter turn, 1 m along x
  const auto scene = parse_mvr_scene(
      scene_of("<FocusPoint uuid=\"f\"><Matrix>{1,0,0}{0,1,0}{0,0,1}{1000,3000,0}</Matrix></FocusPoint><GroupObject>" +
               turned + "<ChildList>" +
               fixture_of("a",
                          "<Matrix>{1,0,0}{0,1,0}{0,0,1}{2000,0,4000}</Matrix><Focus>f</Focus><Addresses>"
                          "<Address break=\"0\">513</Address></Addresses>") +
               fixture_of("b", "<Addresses><Address break=\"0\">3.17</Address></Addresses>") +
               "</ChildList></GroupObject>"),
      "x");
  ASSERT_TRUE(scene) << scene.error().front().text();
  ASSERT_EQ(scene->fixtures.size(), 2u);
  const MvrFixture& a = scene->fixtures[0];
  EXPECT_LT((a.world_from_base.translation_m - Vec3(1, 2, 4)).norm(), 1e-12);
  EXPECT_LT((a.world_from_base.direction(Vec3::UnitX()) - Vec3::UnitY()).norm(), 1e-12);
  ASSERT_TRUE(a.focus_world_m);
  EXPECT_EQ(*a.focus_world_m, Vec3(1, 3, 0));
  ASSERT_EQ(a.addresses.size(), 1u);
  EXPECT_EQ(a.addresses[0].universe, 2);
  EXPECT_EQ(a.addresses[0].address, 1);
  EXPECT_EQ(scene->fixtures[1].addresses[0].universe, 3);
  EXPECT_EQ(scene->fixtures[1].addresses[0].address, 17);

  const ImportedRig imported = rig_of_mvr({*scene, {}}, "x");
  const Checked<Rig> rig = written_and_read(imported, "groups");
  ASSERT_TRUE(rig) << rig.error().front().text() << imported.rig_toml;
  EXPECT_EQ(*rig->fixtures[0].aim_world_m, Vec3(1, 3, 0));
  EXPECT_EQ(std::get<DmxPatch>(rig->fixtures[0].patch).universe, 2);
  EXPECT_NE(imported.rig_toml.find("FILL IN: \"a\": the DMX slots are not known"), std::string::npos);
}

TEST(Mvr, FixturesThatShareSlotsAreMovedApartAndReported) {
  const std::string patch = "<Addresses><Address>7</Address></Addresses>";
  const auto scene = parse_mvr_scene(scene_of(fixture_of("a", patch) + fixture_of("a", patch)), "x");
  ASSERT_TRUE(scene);
  const ImportedRig imported = rig_of_mvr({*scene, {}}, "x");
  const Checked<Rig> rig = written_and_read(imported, "shared");
  ASSERT_TRUE(rig) << rig.error().front().text();
  EXPECT_EQ(std::get<DmxPatch>(rig->fixtures[0].patch).address, 7);
  EXPECT_EQ(std::get<DmxPatch>(rig->fixtures[1].patch).universe, 2);
  EXPECT_NE(imported.rig_toml.find("are taken"), std::string::npos);
}

TEST(Mvr, MountAnglesExpressAnyRotation) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> angle(-180, 180);
  const auto rotation_of = [](const Vec3& deg) {
    return Mat3(Eigen::AngleAxisd(rad_from_deg(deg[0]), Vec3::UnitZ()) *
                Eigen::AngleAxisd(rad_from_deg(deg[1]), Vec3::UnitX()) *
                Eigen::AngleAxisd(rad_from_deg(deg[2]), Vec3::UnitY()));
  };
  for (int i = 0; i < 1000; ++i) {
    const double pitch = i % 10 == 0 ? (i % 20 == 0 ? 90 : -90) : angle(random);
    const Mat3 rotation = rotation_of({angle(random), pitch, angle(random)});
    EXPECT_LT((rotation_of(mount_deg_of(rotation)) - rotation).norm(), 1e-7);
  }
}

TEST(Mvr, HostileScenesAreRefusedWithAReason) {
  const std::pair<std::string, const char*> cases[] = {
      {scene_of(fixture_of("a", "<Matrix>{1,0,0}{0,1,0}{0,0,1}{nan,0,0}</Matrix>")), "Matrix"},
      {scene_of(fixture_of("a", "<Matrix>{1,0,0}</Matrix>")), "Matrix"},
      {scene_of(fixture_of("a", "<Matrix>{1,0,0}{0,1,0}{0,0,1}{1e300,0,0}</Matrix>")), "Matrix"},
      {"<GeneralSceneDescription verMajor=\"2\"><Scene/></GeneralSceneDescription>", "not known"},
      {"<x/>", "no <GeneralSceneDescription>"},
      {"<!DOCTYPE x><x/>", "DOCTYPE"},
  };
  for (const auto& [xml, reason] : cases) {
    const auto scene = parse_mvr_scene(xml, "x");
    ASSERT_FALSE(scene) << xml;
    EXPECT_NE(scene.error()[0].what.find(reason), std::string::npos) << scene.error()[0].text();
  }
  EXPECT_FALSE(read_mvr("PK", "x"));
  const std::string whole = bytes_of(kMvr / "basic_fixture.mvr");
  for (std::size_t length = 0; length < whole.size(); length += 997)
    EXPECT_FALSE(read_mvr(whole.substr(0, length), "x"));
}

TEST(Mvr, NamesCannotBreakOutOfTextOrFolder) {
  MvrScene scene;
  scene.fixtures.push_back({"a\"]\\ \n[x]", "../../etc/pass\"wd", "m\"", {}, {}, {}, false, false, 1});
  scene.fixtures[0].name = made_plain(scene.fixtures[0].name);
  std::ifstream in(kMvr / "virtual_channel.gdtf", std::ios::binary);
  MvrFile file{scene, {{"../../etc/pass\"wd", std::string((std::istreambuf_iterator<char>(in)), {})}}};
  file.scene.fixtures[0].gdtf_mode = "Default";
  const ImportedRig imported = rig_of_mvr(file, "\"\\");
  ASSERT_EQ(imported.files.size(), 1u);
  EXPECT_EQ(imported.files[0].name.find('/'), std::string::npos);
  EXPECT_NE(imported.files[0].name.front(), '.');
  const Checked<Rig> rig = written_and_read(imported, "names");
  ASSERT_TRUE(rig) << rig.error().front().text() << imported.rig_toml;
  EXPECT_EQ(rig->fixtures[0].name, scene.fixtures[0].name);
}

}  // namespace
}  // namespace luxrig
