#include "tools/bench/rooms/room_plan.h"

namespace luxrig {

LitRoom make_box_room(std::uint64_t seed) {
  constexpr double kLength_m = 4, kWidth_m = 3, kHeight_m = 2.5;
  RoomDice dice(seed);
  SolidModel model;
  const auto white = model.material("white paint", {0.80, 0.79, 0.76});
  const auto ceiling = model.material("ceiling", {0.84, 0.84, 0.82});
  const auto parquet = model.material("parquet", {0.36, 0.25, 0.15});
  const auto beech = model.material("beech", {0.56, 0.42, 0.27});
  const auto red = model.material("red cloth", {0.45, 0.04, 0.03});
  const auto green = model.material("green paint", {0.16, 0.42, 0.17});
  model.begin_object("room");
  model.shell(Vec3::Zero(), {kLength_m, kWidth_m, kHeight_m}, 0.3, parquet, ceiling, {white, white, green, white});
  model.begin_object("cupboard");
  model.box({0, 0.6, 0}, {0.55, 1.6, 2.0}, beech);
  model.begin_object("table");
  const Vec3 table_m(dice.between(1.7, 2.1), dice.between(1.0, 1.3), 0);
  model.box(table_m + Vec3(0, 0, 0.70), table_m + Vec3(1.4, 0.8, 0.74), beech);
  model.box(table_m + Vec3(0.05, 0.1, 0), table_m + Vec3(0.11, 0.7, 0.70), beech);
  model.box(table_m + Vec3(1.29, 0.1, 0), table_m + Vec3(1.35, 0.7, 0.70), beech);
  model.begin_object("armchair");
  model.turned_box({dice.between(0.9, 1.1), 2.3, 0}, {0.8, 0.8, 0.42}, dice.between(-0.4, 0.4), red);

  LitRoom room{"box", {}, {}, {}};
  room.emitters.push_back({make_isotropic(900), {Mat3::Identity(), {2.0, 1.5, kHeight_m - dice.between(0.2, 0.4)}}});
  room.emitters.push_back(
      {make_spot(450, rad_from_deg(38), rad_from_deg(64)), aimed({3.6, 0.4, 2.4}, table_m + Vec3(0.7, 0.4, 0.74))});
  const auto free = [&](const Vec3& p) { return !model.occupied(p, 0.02) && model.open_above(p, 1.0); };
  const auto on_table = [](const Vec3&) { return true; };
  spread_receivers(room, 24, {0.1, 0.1, 0.75}, {kLength_m - 0.2, 0, 0}, {0, kWidth_m - 0.2, 0}, Vec3::UnitZ(), dice,
                   free);
  const auto free_floor = [&](const Vec3& p) { return free(p + Vec3(0, 0, 0.03)); };
  spread_receivers(room, 16, {0.1, 0.1, kOffSurface_m}, {kLength_m - 0.2, 0, 0}, {0, kWidth_m - 0.2, 0}, Vec3::UnitZ(),
                   dice, free_floor);
  spread_receivers(room, 8, table_m + Vec3(0.05, 0.05, 0.74 + kOffSurface_m), {1.3, 0, 0}, {0, 0.7, 0}, Vec3::UnitZ(),
                   dice, on_table);
  spread_receivers(room, 12, {0.4, kWidth_m - kOffSurface_m, 0.8}, {3.2, 0, 0}, {0, 0, 1.3}, -Vec3::UnitY(), dice,
                   on_table);
  room.interior_m = Eigen::AlignedBox3d(Vec3::Zero(), Vec3(kLength_m, kWidth_m, kHeight_m));
  room.scene = model.scene();
  return room;
}

}  // namespace luxrig
