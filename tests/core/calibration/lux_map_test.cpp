// A lamp that is brighter than its rig file has it, in a room that a camera sees: the map's light has to be that of the
// true room within its stated error, at places and between them.
#include "core/calibration/lux_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/photometry/intensity.h"
#include "tests/core/calibration/box_room.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kOutput = 1.2;

Session lit_room(double output) {
  Session session;
  session.scene = box_room::room_with_boxes();
  session.scene.materials.back().reflectance_rgb.setConstant(0.02);  // the nearest box: too dark to measure light on
  Rig& rig = session.rig;
  rig.name = "room";
  rig.luminaires.resize(1);
  rig.luminaires[0].intensity = make_isotropic(3000 * output);
  rig.fixtures.resize(2);
  rig.fixtures[0].name = "lamp";
  rig.fixtures[0].world_from_mount.translation_m = {0.4, 0.8, 2.6};
  rig.fixtures[1].name = "dark";
  rig.fixtures[1].world_from_mount.translation_m = {-3, -2, 2.6};
  rig.points.resize(1);
  rig.points[0].name = "floor";
  rig.points[0].position_world_m = {-0.4, 1.6, 0.005};
  rig.points[0].normal_world = {0, 0, 1};
  rig.points[0].goal_lx = 100;
  rig.luxmeters.resize(1);
  rig.luxmeters[0].position_world_m = {1, 1, 0.02};
  session.rays = std::make_unique<RayScene>(session.scene);
  return session;
}

Session with_points_at(const std::vector<SeenPlace>& places, double output) {
  Session session = lit_room(output);
  session.rig = with_places(std::move(session.rig), places);
  return session;
}

ComputeOptions to_one_percent() {
  ComputeOptions options;
  options.max_error = 0.01;
  return options;
}

TEST(LuxMap, IsTheLightOfTheTrueRoomWithinItsErrors) {
  const Camera camera = box_room::stated_camera();
  const Session room = lit_room(1);
  const auto places = seen_places(*room.rays, camera, room.rig.points, 40);
  ASSERT_EQ(places.front().position_world_m, room.rig.points[0].position_world_m);
  const Session stated = with_points_at(places, 1), truth = with_points_at(places, kOutput);
  const auto true_light = compute_transport(truth, to_one_percent());
  ASSERT_TRUE(true_light);
  auto light = RigLight::of(stated, usual_priors(stated.rig), to_one_percent());
  ASSERT_TRUE(light);
  const VectorXd lamp = VectorXd::Unit(2, 0);
  const auto meter = static_cast<Index>(stated.rig.points.size());
  LightReading reading;
  reading.receiver = static_cast<std::size_t>(meter);
  reading.lux = true_light->lux_per_level(meter, 0);
  reading.standard_error_lx = 0.01 * reading.lux;
  reading.level = lamp;
  ASSERT_TRUE(light->learn({&reading, 1}));

  const std::vector<double> level{0.5, 0};
  const LampShares shares = lamp_shares(light->known(), std::vector<LampCurve>(2), level, 0.5);
  EXPECT_DOUBLE_EQ(shares.share[0], 0.5);
  EXPECT_EQ(shares.share[1], 0);
  EXPECT_NEAR(shares.error[0], 0.5 * std::log(2), 1e-9) << "read at full light, used at half";
  LampCurve known;
  known.of_level = {{0.5, 0.35}, {1, 1}};
  known.error = 0.01;
  const LampShares by_curve = lamp_shares(light->known(), std::vector<LampCurve>(2, known), level, 0.5);
  EXPECT_DOUBLE_EQ(by_curve.share[0], 0.35);
  EXPECT_DOUBLE_EQ(by_curve.error[0], 0.01);

  const auto map = map_places(room.rig, *light, camera, places, 1, by_curve);
  ASSERT_EQ(map.size(), places.size());
  EXPECT_EQ(map.front().point, "floor");
  EXPECT_EQ(map.back().point, "");
  for (std::size_t k = 0; k < map.size(); ++k) {
    const double truth_lx = 0.35 * true_light->lux_per_level(static_cast<Index>(1 + k), 0);
    EXPECT_NEAR(map[k].light.lux, truth_lx, 3 * map[k].light.standard_error_lx) << k;
    EXPECT_GT(map[k].light.standard_error_lx, 0.01 * map[k].light.lux) << "its dimmer's alone";
    EXPECT_LT(map[k].light.share_of_error(), 0.25);
  }
  const auto unsure = map_places(room.rig, *light, camera, places, 1, shares);
  EXPECT_GT(unsure.front().light.share_of_error(), 0.3) << "of a dimmer that is not known";
  Camera away = camera;
  away.target_world_m = away.eye_world_m - Vec3(0, 1, 0);
  EXPECT_TRUE(map_places(room.rig, *light, away, places, 1, by_curve).empty());

  // The picture is of a room as stated, so all that makes it right between places is what places around say.
  const auto pictures = map_pictures(room, camera, map, by_curve.share, luxrig::Run{});
  ASSERT_TRUE(pictures) << pictures.error().detail;
  const auto wall = seen_places(*room.rays, camera, {}, 17);
  const Session between = with_points_at(wall, kOutput);
  const auto there = compute_transport(between, to_one_percent());
  ASSERT_TRUE(there);
  const auto pixel = [&](const Picture& picture, double x_px, double y_px) {
    return picture.illuminance_lx[static_cast<std::size_t>(y_px) * static_cast<std::size_t>(picture.width_px) +
                                  static_cast<std::size_t>(x_px)];
  };
  for (std::size_t k = 0; k < wall.size(); ++k) {
    const double lux = pixel(pictures->lux, wall[k].x_px, wall[k].y_px);
    const double error = lux * pixel(pictures->error_percent, wall[k].x_px, wall[k].y_px) / 100;
    const double truth_lx = 0.35 * there->lux_per_level(static_cast<Index>(1 + k), 0);
    EXPECT_NEAR(lux, truth_lx, 3 * error + 0.06 * truth_lx) << "place " << k;
  }
  double brightest_lx = 0;
  for (const LuxMap::Place& place : map) brightest_lx = std::max(brightest_lx, place.light.lux);
  for (const LuxMap::Place& place : map) {
    // A dim pixel has more noise.
    EXPECT_NEAR(pixel(pictures->lux, place.x_px, place.y_px), place.light.lux,
                0.15 * place.light.lux + 0.02 * brightest_lx);
    EXPECT_NEAR(pixel(pictures->error_percent, place.x_px, place.y_px), 100 * place.light.share_of_error(),
                60 * place.light.share_of_error());
  }
  const auto box = pixel_of(camera, {0.85, -0.6, 0.35});
  ASSERT_TRUE(box);
  EXPECT_LT(pixel(pictures->lux, box->x_px, box->y_px), 0) << "no matt surface that shows light";
  EXPECT_LT(pixel(pictures->error_percent, box->x_px, box->y_px), 0);

  Camera large = camera;
  large.width_px = 1600;
  large.height_px = 40;
  const auto small = map_pictures(room, large, map, by_curve.share, luxrig::Run{});
  ASSERT_TRUE(small);
  EXPECT_EQ(small->lux.width_px, 400);
  EXPECT_EQ(small->lux.height_px, 10);
}

}  // namespace
}  // namespace luxrig
