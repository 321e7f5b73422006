#include "core/tasks/rig_notes/rig_notes.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "core/picture/picture.h"
#include "core/tasks/scene_builder.h"

namespace luxrig {
namespace {

/// A room of 6 x 5 x 3 m (z up, its corner at the origin) from an OBJ file, with a plinth in it, three lamps under the
/// ceiling, three points at table height and a luxmeter: no faults.
class RigNotes : public testing::Test {
 protected:
  RigNotes() {
    file_ = std::filesystem::temp_directory_path() / ("luxrig-notes-" + std::to_string(::getpid()) + ".obj");
    rig.file = "rig.toml";
    rig.scene.mesh = MeshFile{file_, 1.0, UpAxis::z};
    write_room(1.0);
    SceneObject plinth;
    plinth.name = "plinth";
    plinth.box_m = Vec3(0.6, 0.6, 1);
    plinth.position_world_m = Vec3(4.5, 3.5, 0);
    rig.scene.objects.push_back(plinth);
    rig.luminaires.resize(1);
    rig.luminaires[0].name = "bulb";
    rig.luminaires[0].intensity = make_isotropic(3000);
    for (int i = 0; i < 3; ++i) {
      Fixture fixture;
      fixture.name = "lamp " + std::to_string(i + 1);
      fixture.world_from_mount.translation_m = Vec3(1.5 + 1.5 * i, 2.5, 2.8);
      fixture.in_file = {10 + i, 1};
      rig.fixtures.push_back(fixture);
      Point point;
      point.name = "desk " + std::to_string(i + 1);
      point.position_world_m = Vec3(1.5 + 1.5 * i, 1.5, 0.8);
      point.goal_lx = 300;
      point.in_file = {20 + i, 1};
      rig.points.push_back(point);
    }
    Luxmeter meter;
    meter.name = "meter";
    meter.position_world_m = Vec3(1, 4, 0.8);
    meter.in_file = {30, 1};
    rig.luxmeters.push_back(meter);
  }
  ~RigNotes() override { std::filesystem::remove(file_); }

  void write_room(double scale, bool y_up = false) {
    std::ofstream out(file_);
    for (int i = 0; i < 8; ++i) {
      const Vec3 at = scale * Vec3(i & 1 ? 6 : 0, i & 2 ? 5 : 0, i & 4 ? 3 : 0);
      out << "v " << at.x() << ' ' << (y_up ? at.z() : at.y()) << ' ' << (y_up ? -at.y() : at.z()) << '\n';
    }
    out << "f 1 2 4 3\nf 5 6 8 7\nf 1 2 6 5\nf 3 4 8 7\nf 1 3 7 5\nf 2 4 8 6\n";
  }

  /// 20 km wide, 1 cm below the room.
  void add_ground() {
    SceneObject ground;
    ground.name = "ground";
    ground.box_m = Vec3(20000, 20000, 1);
    ground.position_world_m = Vec3(3, 2, -1.01);
    rig.scene.objects.push_back(ground);
  }

  std::vector<Problem> notes() {
    const auto scene = build_scene(rig);
    EXPECT_TRUE(scene.has_value()) << (scene ? "" : scene.error()[0].text());
    if (!scene) return {};
    const RayScene rays(*scene);
    return notes_on(rig, *scene, rays, 2);
  }
  /// There is exactly one note, at that line, and its text contains all of these.
  void expect_one(int line, std::initializer_list<const char*> parts) {
    const std::vector<Problem> all = notes();
    std::string text;
    for (const Problem& note : all) text += note.text() + "\n";
    ASSERT_EQ(all.size(), 1u) << text;
    EXPECT_EQ(all[0].line, line) << text;
    EXPECT_FALSE(all[0].mend.empty());
    for (const char* part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << " is not in " << text;
  }

  std::filesystem::path file_;
  Rig rig;
};

TEST_F(RigNotes, ARigThatFitsItsSceneHasNone) { EXPECT_TRUE(notes().empty()) << notes()[0].text(); }

TEST_F(RigNotes, AFixtureBehindTheWallIsNoted) {
  rig.fixtures[1].world_from_mount.translation_m = Vec3(8, 2.5, 2.8);
  expect_one(11,
             {"fixture \"lamp 2\"", "2.00 m outside of the scene", "no point or luxmeter can be seen", "position_m"});
}

TEST_F(RigNotes, AFixtureFarAwayIsNotedEvenWhereItSeesAPoint) {
  rig.scene.mesh.reset();  // no walls: the plinth stands in the open
  rig.fixtures[1].world_from_mount.translation_m = Vec3(500, 2.5, 2.8);
  expect_one(11, {"fixture \"lamp 2\"", "outside of the scene"});
}

TEST_F(RigNotes, LampsAboutALoneObjectAreNotOutside) {
  rig.scene.mesh.reset();
  EXPECT_TRUE(notes().empty()) << notes()[0].text();
}

TEST_F(RigNotes, AHugeGroundHidesNothingOutsideTheRoom) {
  add_ground();
  EXPECT_TRUE(notes().empty()) << notes()[0].text();
  rig.fixtures[1].world_from_mount.translation_m = Vec3(500, 2.5, 2.8);
  expect_one(11, {"fixture \"lamp 2\"", "494.00 m outside of the scene (x 0.00 to 6.00, y 0.00 to 5.00"});
  rig.fixtures[1].world_from_mount.translation_m = Vec3(8, 2.5, 2.8);
  expect_one(11, {"fixture \"lamp 2\"", "2.00 m outside of the scene"});
  rig.fixtures[1].world_from_mount.translation_m = Vec3(3, 2.5, 2.8);
  rig.points[1].position_world_m = Vec3(6.5, 2.5, 0.8);
  expect_one(21, {"point \"desk 2\"", "0.50 m outside of the scene"});
}

TEST_F(RigNotes, LampsAroundALoneObjectOnOpenGroundAreNotOutside) {
  rig.scene.mesh.reset();
  add_ground();
  EXPECT_TRUE(notes().empty()) << notes()[0].text();
}

TEST_F(RigNotes, ARoomOnGroundReadWithTheWrongUpAxisIsNoted) {
  write_room(1.0, false);
  std::ofstream(file_, std::ios::app) << "v -10000 -10000 -0.01\nv 10000 -10000 -0.01\nv 10000 10000 -0.01\n"
                                         "v -10000 10000 -0.01\nf 9 10 11 12\n";
  EXPECT_TRUE(notes().empty()) << notes()[0].text();
  rig.scene.mesh->up_axis = UpAxis::y;
  expect_one(rig.scene.in_file.line, {"set up_axis = \"z\" in [scene]"});
}

TEST_F(RigNotes, TheRoomOfARigExcludesItsGround) {
  add_ground();
  const auto scene = build_scene(rig);
  ASSERT_TRUE(scene);
  const Eigen::AlignedBox3d room = room_of(rig, *scene);
  EXPECT_LT((room.min() - Vec3(0, 0, 0)).norm() + (room.max() - Vec3(6, 5, 3)).norm(), 1e-3);
  const PlanView plan = render_plan_view(RayScene(*scene), 104, std::nullopt, 1, room);
  EXPECT_NEAR(plan.metres_per_px, 0.06, 1e-6) << "the plan shows the room";
  rig.fixtures.clear();
  rig.points.clear();
  rig.luxmeters.clear();
  EXPECT_GT(room_of(rig, *scene).sizes().x(), 19000) << "nothing says where the room is";
}

TEST_F(RigNotes, APointRightBehindAWallIsNoted) {
  rig.points[0].position_world_m = Vec3(2, 5.01, 1.5);
  rig.points[0].normal_world = -Vec3::UnitY();
  expect_one(20, {"point \"desk 1\" faces a surface of the scene", "10.0 mm before it", "0 lx with every lamp",
                  "its goal is 300 lx", "move it along its normal"});
}

TEST_F(RigNotes, APointFacingAWallACentimetreAwayIsNoted) {
  rig.points[2].position_world_m = Vec3(5.99, 2.5, 1.5);
  rig.points[2].normal_world = Vec3::UnitX();
  expect_one(22, {"point \"desk 3\" faces", "10.0 mm before it", "turn its normal"});
}

TEST_F(RigNotes, ALuxmeterInsideAnObjectIsNoted) {
  rig.luxmeters[0].position_world_m = Vec3(4.5, 3.5, 0.8);
  expect_one(30, {"luxmeter \"meter\" is inside of object \"plinth\", 0.20 m below its surface"});
}

TEST_F(RigNotes, APointOutsideTheRoomIsNoted) {
  rig.points[1].position_world_m = Vec3(6.5, 2.5, 0.8);
  expect_one(21, {"point \"desk 2\" is at 6.500 2.500 0.800, 0.50 m outside of the scene", "gets 0 lx"});
}

TEST_F(RigNotes, OnlyPointsReachedByNeitherLampsNorReflectionsAreNoted) {
  rig.points[1].position_world_m = Vec3(3, 2.5, 2.95);
  rig.points[1].normal_world = Vec3::UnitZ();  // looks at the ceiling, which only reflects
  EXPECT_TRUE(notes().empty()) << notes()[0].text();
  rig.scene.default_reflectance_rgb.setZero();
  for (SceneObject& object : rig.scene.objects) object.reflectance_rgb = Vec3::Zero();
  expect_one(21,
             {"point \"desk 2\" gets 0 lx with every lamp at full level, its goal is 300 lx", "no lamp is in sight"});
}

TEST_F(RigNotes, LightsYetToBePlacedMayReachAnyPoint) {
  rig.points[1].position_world_m = Vec3(3, 2.5, 2.9);
  rig.points[1].normal_world = Vec3::UnitZ();
  rig.scene.default_reflectance_rgb.setZero();
  Task task;
  task.kind = TaskKind::placement;
  rig.tasks.push_back(task);
  EXPECT_TRUE(notes().empty()) << notes()[0].text();
}

TEST_F(RigNotes, AMeshReadWithTheWrongUpAxisIsNoted) {
  rig.scene.in_file = {3, 1};
  rig.scene.objects.clear();
  rig.scene.mesh->up_axis = UpAxis::y;
  expect_one(3, {"is read with y up", "with z up, 7 of them", "set up_axis = \"z\""});
  write_room(1, true);
  EXPECT_TRUE(notes().empty()) << notes()[0].text();
  rig.scene.mesh->up_axis = UpAxis::z;
  expect_one(3, {"is read with z up", "set up_axis = \"y\""});
}

TEST_F(RigNotes, AMeshInAnotherUnitIsNoted) {
  rig.scene.in_file = {3, 1};
  rig.scene.objects.clear();
  write_room(1000);  // millimetres, read as metres
  expect_one(3, {"6000.00 x 5000.00 x 3000.00 m in size, far too large", "set unit = \"mm\"", "6.00 x 5.00 x 3.00 m"});
  write_room(100);
  expect_one(3, {"far too large", "set unit = \"cm\""});
  write_room(1);
  rig.scene.mesh->metres_per_unit = 0.001;
  expect_one(3, {"0.0060 x 0.0050 x 0.0030 m in size, far too small", "set unit = \"m\"", "6.00 x 5.00 x 3.00 m"});
}

TEST_F(RigNotes, AMeshInMetresReadAsFeetIsNotedWhenAllPointsLieOutside) {
  rig.scene.in_file = {3, 1};
  rig.scene.objects.clear();
  rig.scene.mesh->metres_per_unit = 0.3048;  // 1.8 x 1.5 x 0.9 m: not far too small, and in the open all are in sight
  for (Point& point : rig.points) point.position_world_m += Vec3(1, 1, 0);
  expect_one(3, {"is read as 1.83 x 1.52 x 0.91 m in size, with all 4 points and luxmeters outside",
                 "set unit = \"m\" in [scene], which makes it 6.00 x 5.00 x 3.00 m"});
  // A lone object with the points on it: no note about how it is read.
  rig.scene.mesh->metres_per_unit = 0.1;
  rig.luxmeters.clear();
  for (Point& point : rig.points) point.position_world_m = Vec3(0.3, 0.25, 0.31);
  EXPECT_TRUE(notes().empty()) << notes()[0].text();
}

TEST_F(RigNotes, ARigInOtherCoordinatesThanItsSceneIsNoted) {
  rig.scene.in_file = {3, 1};
  rig.scene.objects.clear();
  for (Fixture& fixture : rig.fixtures) fixture.world_from_mount.translation_m += Vec3(1e5, -2e4, 0);
  for (Point& point : rig.points) point.position_world_m += Vec3(1e5, -2e4, 0);
  rig.luxmeters.front().position_world_m += Vec3(1e5, -2e4, 0);
  expect_one(3, {"the scene (x 0.00 to 6.00", "away from all fixtures, points and luxmeters (x 100001.00",
                 "the mesh moved by about"});
}

TEST_F(RigNotes, ALampNearAPointIsNotedAndOneInItIsRefused) {
  EXPECT_TRUE(lamps_in_points(rig).empty());
  rig.fixtures[2].world_from_mount.translation_m = rig.points[2].position_world_m + Vec3(0, 0, 0.005);
  EXPECT_TRUE(lamps_in_points(rig).empty());
  expect_one(12, {"fixture \"lamp 3\" is 5.0 mm from point \"desk 3\"", "9549297 lx"});
  rig.fixtures[2].world_from_mount.translation_m = rig.points[2].position_world_m;
  const auto refused = lamps_in_points(rig);
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].line, 12);
  EXPECT_NE(refused[0].what.find("fixture \"lamp 3\" lies in point \"desk 3\""), std::string::npos)
      << refused[0].text();
}

TEST_F(RigNotes, ManyOfAKindAreSummedUpInOne) {
  for (int i = 0; i < 30; ++i) {
    rig.points.push_back(rig.points[0]);
    rig.points.back().name = "lost " + std::to_string(i);
    rig.points.back().position_world_m = Vec3(20 + i, 1, 1);
  }
  const auto all = notes();
  ASSERT_EQ(all.size(), 9u);
  EXPECT_NE(all.back().what.find("22 more points and luxmeters likewise: lost 8"), std::string::npos)
      << all.back().text();
}

}  // namespace
}  // namespace luxrig
