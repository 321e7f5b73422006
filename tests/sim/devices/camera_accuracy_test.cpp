/// camera: accuracy over many samples.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/tasks/rig_transport.h"
#include "sim/devices/camera.h"
#include "tests/sim/devices/camera_fixture.h"
#include "tests/sim/tiny_rig.h"

namespace luxrig::sim {
namespace {

using namespace camera_fixture;

double mean_cd_m2(const Picture& picture) {
  double sum = 0;
  for (const Vec3f& pixel : picture.luminance_cd_m2) sum += static_cast<double>(pixel.sum()) / 3;
  return sum / static_cast<double>(picture.luminance_cd_m2.size());
}

TEST(SimCamera, ShowsTheTrueLightOfTheWorld) {
  PhotographedRoom room;
  const double planned_cd_m2 = mean_cd_m2(room.taken({}, {}));
  Camera view;
  view.eye_world_m = room.camera.position_world_m;
  view.target_world_m = room.camera.aim_world_m;
  view.vertical_fov_rad = room.camera.vertical_fov_rad;
  view.width_px = 48;
  view.height_px = 32;
  PictureOptions options;
  options.max_passes = 64;
  options.wanted_relative_error = 0;
  const auto rendered = render_picture(room.room, emitters_of(room.rig), room.light.levels, view, options);
  ASSERT_TRUE(rendered);
  EXPECT_NEAR(planned_cd_m2, mean_cd_m2(*rendered), 0.02 * planned_cd_m2);
  // Lamps at three quarters of the rig file's output are seen so.
  for (double& level : room.light.levels) level *= 0.75;
  EXPECT_NEAR(mean_cd_m2(room.taken({}, {})), 0.75 * planned_cd_m2, 0.005 * planned_cd_m2);
}

// Variance of the difference of two shots: twice that of electrons and read-out.
TEST(SimCamera, HasTheNoiseOfItsElectrons) {
  const PhotographedRoom room;
  for (const double full_well : {1000.0, 50000.0}) {
    Sensor sensor;
    sensor.full_well_electrons = full_well;
    sensor.read_noise_electrons = 3;
    sensor.bits = 16;
    Shot second;
    second.number = 1;
    const Picture a = room.taken(sensor, {}), b = room.taken(sensor, second);
    // The brightest hundredth is exposed to four fifths of full scale.
    std::vector<float> brightest;
    for (const Vec3f& pixel : a.luminance_cd_m2) brightest.push_back(pixel.maxCoeff());
    std::sort(brightest.begin(), brightest.end());
    const double full_cd_m2 =
        brightest[static_cast<std::size_t>(0.99 * static_cast<double>(brightest.size() - 1))] / 0.8;
    double ratio = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.luminance_cd_m2.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        const double x = static_cast<double>(a.luminance_cd_m2[i][c]) / full_cd_m2 * full_well,
                     y = static_cast<double>(b.luminance_cd_m2[i][c]) / full_cd_m2 * full_well;
        if (std::max(x, y) > 0.95 * full_well || std::min(x, y) < 30) continue;
        ratio += (x - y) * (x - y) / (2 * ((x + y) / 2 + 9));
        ++count;
      }
    ASSERT_GT(count, 1000u);
    EXPECT_NEAR(ratio / static_cast<double>(count), 1, 0.15) << full_well;
  }
}

}  // namespace
}  // namespace luxrig::sim
