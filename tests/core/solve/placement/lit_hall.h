#pragma once
/// A room to place lights in: candidates on a lattice, lux without reflections.

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "core/solve/placement/scene/lattice.h"
#include "core/solve/placement/scene/scene_light.h"
#include "core/solve/placement/search/complement_search.h"
#include "tools/bench/rooms/lit_room.h"

namespace luxrig {

struct LitHall {
  LitRoom room;
  RayScene rays;
  std::unique_ptr<IncrementalTransport> transport;
  std::unique_ptr<SceneLight> light;
  CandidateSet set;
  std::vector<LightPose> poses;
  CandidateColumns columns;

  LitHall(LitRoom room_in, double lattice_m, Emitter luminaire = {make_isotropic(1), {}})
      : room(std::move(room_in)), rays(room.scene) {
    IncrementalOptions direct_only;
    direct_only.indirect = false;
    transport = std::move(*IncrementalTransport::make(room.scene, rays, room.receivers, direct_only));
    light = std::make_unique<SceneLight>(*transport, room.receivers, luminaire);
    set.luminaires = {luminaire};
    set.positions_world_m = lattice_in(rays.bounds_world_m(), lattice_m);
    for (const Vec3& position_m : set.positions_world_m) poses.push_back({position_m});
    CandidateOptions options;
    options.indirect = false;
    columns = std::move(candidate_transport(room.scene, rays, room.receivers, set, options)->matrix);
  }

  [[nodiscard]] ColumnsView view() const {
    return ColumnsView(light->points(), columns.begin, columns.receiver, columns.total_lux);
  }
  [[nodiscard]] LightingGoal goal_of(const std::vector<Vec3>& places_m, const std::vector<double>& levels) const {
    LightingGoal goal;
    goal.lux = Eigen::VectorXd::Zero(light->points());
    Eigen::VectorXd lux;
    for (std::size_t k = 0; k < places_m.size(); ++k) {
      EXPECT_TRUE(light->column({places_m[k]}, lux, nullptr));
      goal.lux += levels[k] * lux;
    }
    return goal;
  }
};

}  // namespace luxrig
