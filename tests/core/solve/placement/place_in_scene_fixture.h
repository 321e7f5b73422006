#pragma once
/// Shared by the tests of place_in_scene.

#include "core/solve/placement/scene/place_in_scene.h"
#include "tests/core/solve/placement/mounted_room.h"

namespace luxrig::place_in_scene_fixture {

/// Points on the floor of the mounted room, and their lux from lights off its ceiling, by the inverse square law.
struct LitFloor {
  Scene scene = mounted_room();
  RayScene rays{scene};
  Mounting mounting = *Mounting::make(off_the_ceiling(), "rig.toml", scene, rays);
  Emitter bulb{make_isotropic(1), {}};
  std::vector<Receiver> receivers;

  LitFloor() {
    for (double y = 0.3; y < 3; y += 0.6)
      for (double x = 0.25; x < 4; x += 0.5) receivers.push_back({Vec3(x, y, 0.01), Vec3::UnitZ()});
  }
  static MountingSpec off_the_ceiling() {
    MountingSpec spec;
    spec.surfaces = {{"ceiling", {}}};
    spec.offset_min_m = 0.1;
    spec.offset_max_m = 0.3;
    spec.clearance_m = 0.2;
    return spec;
  }
  [[nodiscard]] LightingGoal goal_of(const std::vector<LightInScene>& lights) const {
    LightingGoal goal{Eigen::VectorXd::Zero(static_cast<Eigen::Index>(receivers.size()))};
    for (std::size_t i = 0; i < receivers.size(); ++i)
      for (const LightInScene& light : lights) {
        const Vec3 to_m = light.position_world_m - receivers[i].position_world_m;
        goal.lux[static_cast<Eigen::Index>(i)] +=
            light.level / (4 * kPi) * to_m.z() / (to_m.squaredNorm() * to_m.norm());
      }
    return goal;
  }
  [[nodiscard]] Result<PlacedInScene> place(const LightingGoal& goal, const PlaceInSceneOptions& options) const {
    return place_in_scene(scene, rays, mounting, bulb, receivers, goal, options);
  }
};

inline PlaceInSceneOptions direct_light() {
  PlaceInSceneOptions options;
  options.max_level = 1e6;  // in lumens: the bulb has 1 lm
  options.indirect = false;
  return options;
}

inline const std::vector<LightInScene> kThree = {
    {{0.8, 0.7, 2.3}, {}, 900}, {{3.1, 2.2, 2.25}, {}, 600}, {{2.2, 1.1, 2.35}, {}, 300}};

}  // namespace luxrig::place_in_scene_fixture
