#include "tools/luxrigd/state/light_store.h"

#include <gtest/gtest.h>

#include <random>

namespace luxrig {
namespace {

Rig rig_of(std::size_t fixtures, std::size_t points, std::size_t meters) {
  Rig rig;
  rig.fixtures.resize(fixtures);
  rig.points.resize(points);
  rig.luxmeters.resize(meters);
  return rig;
}

KeptLight random_light(const Rig& rig, bool daylit) {
  const auto points = static_cast<Eigen::Index>(rig.points.size());
  const auto meters = static_cast<Eigen::Index>(rig.luxmeters.size());
  const auto lights = static_cast<Eigen::Index>(rig.fixtures.size());
  KeptLight light;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f)
    light.joints.push_back({0.1 * static_cast<double>(f), -0.2, 0.3});
  light.model.point_lux_per_level = Eigen::MatrixXd::Random(points, lights);
  light.model.meter_lux_per_level = Eigen::MatrixXd::Random(meters, lights);
  if (daylit) {
    light.model.point_standard_error = Eigen::MatrixXd::Random(points, lights);
    light.model.meter_standard_error = Eigen::MatrixXd::Random(meters, lights);
    light.model.point_fixed_lx = Eigen::VectorXd::Random(points);
    light.model.meter_fixed_lx = Eigen::VectorXd::Random(meters);
  }
  return light;
}

TEST(LightStore, RoundTrips) {
  for (const bool daylit : {false, true}) {
    for (const std::size_t meters : {0u, 2u}) {
      const Rig rig = rig_of(3, 5, meters);
      const KeptLight light = random_light(rig, daylit);
      const auto back = light_of_bytes(light_bytes(light, 42), 42, rig);
      ASSERT_TRUE(back) << daylit << meters;
      EXPECT_EQ(back->joints, light.joints);
      EXPECT_EQ(back->model.point_lux_per_level, light.model.point_lux_per_level);
      EXPECT_EQ(back->model.meter_lux_per_level.size(), light.model.meter_lux_per_level.size());
      EXPECT_EQ(back->model.point_standard_error, light.model.point_standard_error);
      EXPECT_EQ(back->model.point_fixed_lx, light.model.point_fixed_lx);
    }
  }
}

TEST(LightStore, RefusesFilesOfAnotherRigOrKey) {
  const Rig rig = rig_of(3, 5, 2);
  const std::string bytes = light_bytes(random_light(rig, true), 42);
  EXPECT_FALSE(light_of_bytes(bytes, 43, rig));
  EXPECT_FALSE(light_of_bytes(bytes, 42, rig_of(4, 5, 2)));
  EXPECT_FALSE(light_of_bytes(bytes, 42, rig_of(3, 6, 2)));
  EXPECT_FALSE(light_of_bytes(bytes, 42, rig_of(3, 5, 1)));
}

TEST(LightStore, RefusesDamagedFiles) {
  const Rig rig = rig_of(3, 5, 2);
  const std::string bytes = light_bytes(random_light(rig, true), 42);
  std::mt19937 random(7);
  for (std::size_t cut = 0; cut < bytes.size(); cut += 7) EXPECT_FALSE(light_of_bytes(bytes.substr(0, cut), 42, rig));
  for (int trial = 0; trial < 2000; ++trial) {
    std::string damaged = bytes;
    const std::size_t at = random() % bytes.size();
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (random() % 8)));
    EXPECT_FALSE(light_of_bytes(damaged, 42, rig)) << at;
  }
  EXPECT_FALSE(light_of_bytes("", 42, rig));
}

}  // namespace
}  // namespace luxrig
