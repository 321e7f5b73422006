#pragma once
/// Shared by the tests of camera.

#include <gtest/gtest.h>

#include "sim/devices/camera.h"
#include "tests/sim/tiny_rig.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig::sim::camera_fixture {

struct PhotographedRoom {
  Rig rig = tiny_rig();
  RayScene room{make_cube(8, 0.5)};
  std::vector<FixtureTruth> truths = draw_fixtures(rig, Deviations::none());
  PictureCamera camera;
  Deviations deviations = Deviations::none();  ///< of the camera
  LightNow light;

  PhotographedRoom() {
    camera.position_world_m = {-3, -3, 0};
    camera.aim_world_m = {1, 1, -1};
    camera.width_px = 48;
    camera.height_px = 32;
    light.levels = {1, 0.5, 0};
    light.joints.resize(3);
  }
  [[nodiscard]] Picture taken(const Sensor& sensor, const Shot& shot) const {
    const auto picture = photograph(room, rig, truths, light, draw_camera(rig, camera, 0, deviations), sensor, shot);
    EXPECT_TRUE(picture);
    return *picture;
  }
};

}  // namespace luxrig::sim::camera_fixture
