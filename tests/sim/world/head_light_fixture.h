#pragma once
/// Shared by the tests of head_light.

#include <gtest/gtest.h>

#include <random>

#include "core/transport/evaluator.h"
#include "sim/world/head_light.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig::sim::head_light_fixture {

inline const JointRange kRange;  // ±270°, ±135°

inline constexpr double kRoll_rad = 0.3;

inline constexpr std::size_t kFixture = 5;  // any

// A 24° spot below the ceiling of a cube of 4 m edge with one reflectance; a dozen receivers on floor and walls.
struct Room {
  explicit Room(double reflectance) : rays(make_cube(4, reflectance)) {
    pose = {(Eigen::AngleAxisd(0.4, Vec3::UnitZ()) * Eigen::AngleAxisd(0.2, Vec3::UnitX())).toRotationMatrix(),
            {0.3, -0.2, 1.7}};
    for (const double x_m : {-1.2, 0.1, 1.3}) {
      for (const double y_m : {-1.1, 0.9}) receivers.push_back({{x_m, y_m, -2}, Vec3::UnitZ()});
      receivers.push_back({{x_m, 2, -0.5}, -Vec3::UnitY()});
      receivers.push_back({{2, x_m, 0.3}, -Vec3::UnitX()});
    }
  }

  [[nodiscard]] TransportMatrix evaluate(const std::vector<Joints>& aims, std::uint64_t max_rays) const {
    std::vector<Emitter> emitters;
    for (const Joints& joints : aims) emitters.push_back({spot, world_from_lamp(pose, joints, kRoll_rad)});
    EvaluateOptions options;
    options.wanted_relative_error = 1e-4;  // max_rays ends it
    options.max_rays = max_rays;
    auto result = make_path_evaluator(rays)->evaluate(receivers, emitters, options);
    EXPECT_TRUE(result) << (result ? "" : result.error().detail);
    return result ? *result : TransportMatrix{};
  }

  [[nodiscard]] std::unique_ptr<const HeadLight> head_light(const std::vector<Joints>& aims,
                                                            Eigen::MatrixXd indirect) const {
    HeadSamples head;
    head.fixture = kFixture;
    head.world_from_mount = pose;
    head.roll_rad = kRoll_rad;
    head.luminaire.intensity = spot;
    for (const Receiver& receiver : receivers) {
      head.sees.push_back(!rays.occluded(receiver.position_world_m, receiver.normal_world, pose.translation_m));
    }
    for (const Joints& joints : aims) head.aims_mount.push_back(beam_mount(joints));
    head.indirect_lux_per_level = std::move(indirect);
    return make_head_light(receivers, {head});
  }

  [[nodiscard]] Eigen::VectorXd zeros() const {
    return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(receivers.size()));
  }

  RayScene rays;
  Pose pose;
  Intensity spot = make_spot(900, rad_from_deg(24), rad_from_deg(40));
  std::vector<Receiver> receivers;
};

inline std::vector<Joints> random_aims(int count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> pan_rad(kRange.pan_min_rad, kRange.pan_max_rad),
      tilt_rad(kRange.tilt_min_rad, kRange.tilt_max_rad);
  std::vector<Joints> aims;
  for (int i = 0; i < count; ++i) aims.push_back({pan_rad(random), tilt_rad(random)});
  return aims;
}

}  // namespace luxrig::sim::head_light_fixture
