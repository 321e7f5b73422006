#include "core/rig/rig_file.h"

#include <gtest/gtest.h>

#include <string>

namespace luxrig {
namespace {

const std::filesystem::path kRooms = std::filesystem::path(LUXRIG_SOURCE_DIR) / "tests/rigs/room";

std::string listed(const std::vector<Problem>& problems) {
  std::string out;
  for (const Problem& problem : problems) out += problem.text() + "\n";
  return out;
}

TEST(RigFile, ReadsTheRoomAsItIsWritten) {
  const Checked<Rig> rig = load_rig(kRooms);
  ASSERT_TRUE(rig) << listed(rig.error());
  EXPECT_EQ(rig->name, "room");
  EXPECT_EQ(rig->scene.mesh->path, kRooms / "room.obj");
  EXPECT_EQ(rig->scene.mesh->up_axis, UpAxis::z);
  ASSERT_EQ(rig->scene.reflectances.size(), 1u);
  EXPECT_EQ(rig->scene.reflectances[0].material_pattern, "wall*");
  ASSERT_EQ(rig->scene.objects.size(), 1u);
  EXPECT_EQ(rig->scene.objects[0].box_m, Vec3(0.4, 0.4, 1.0));
  EXPECT_NEAR(rig->scene.objects[0].turn_rad, kPi / 6, 1e-12);
  ASSERT_EQ(rig->luminaires.size(), 2u);
  EXPECT_EQ(rig->luminaires[0].model, LuminaireModel::spot);
  EXPECT_NEAR(rig->luminaires[0].intensity->flux_lm(), 900, 0.9);
  EXPECT_NEAR(rig->luminaires[1].intensity->flux_lm(), 800, 1e-9);
  ASSERT_EQ(rig->buses.size(), 2u);
  EXPECT_EQ(std::get<std::string>(rig->buses[1].options.at("host").value), "127.0.0.1");
  EXPECT_EQ(std::get<std::int64_t>(rig->buses[1].options.at("port").value), 1502);
  ASSERT_EQ(rig->fixtures.size(), 3u);
  const Fixture& head = rig->fixtures[1];
  EXPECT_TRUE(head.moves);
  const auto& patch = std::get<DmxPatch>(head.patch);
  EXPECT_EQ(patch.address, 10);
  ASSERT_EQ(patch.slots.size(), 7u);
  EXPECT_EQ(patch.slots[1].use, SlotUse::pan_fine);
  EXPECT_EQ(patch.slots[6].constant_dmx, 255);
  EXPECT_EQ(std::get<ModbusPatch>(rig->fixtures[2].patch).unit, 10);
  EXPECT_EQ(rig->fixtures[0].dimmer_curve, DimmerCurve::square);
  EXPECT_EQ(rig->fixtures[2].safe_level, 0.2);
  ASSERT_EQ(rig->luxmeters.size(), 2u);
  EXPECT_EQ(rig->luxmeters[0].point, 0u);
  EXPECT_EQ(rig->luxmeters[0].position_world_m, Vec3(1, 0.5, 1));
  EXPECT_FALSE(rig->luxmeters[1].point);
  ASSERT_EQ(rig->points.size(), 2u);
  EXPECT_EQ(rig->points[0].max_lx, 200);
  EXPECT_EQ(rig->points[1].weight, 0.5);
  EXPECT_EQ(rig->control.fade_s, 2);
  EXPECT_EQ(rig->safe.hold_s, 2);
}

TEST(RigFile, AimsFixturesAtTheirPoints) {
  const Checked<Rig> rig = load_rig(kRooms / "rig.toml");
  ASSERT_TRUE(rig) << listed(rig.error());
  for (const std::size_t i : {0u, 1u}) {
    const Fixture& fixture = rig->fixtures[i];
    const Vec3 wanted = (*fixture.aim_world_m - fixture.world_from_mount.translation_m).normalized();
    EXPECT_LT((fixture.world_from_lamp().direction(-Vec3::UnitZ()) - wanted).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace luxrig
