#pragma once
/// Edges of a scene as a camera shows them: outlines of what stands before something else, corners, joints of materials.

#include <Eigen/Core>
#include <vector>

#include "core/picture/picture.h"
#include "core/scene/ray_scene.h"

namespace luxrig {

/// A place on an edge.
struct SceneEdge {
  Vec3 position_world_m = Vec3::Zero();                  ///< on the nearer of the two surfaces
  Eigen::Vector2d normal_px = Eigen::Vector2d::UnitX();  ///< unit, across the edge in the picture
};

/// Every few pixels, located to a small part of a pixel. Edges of which no straight piece is seen are left out.
[[nodiscard]] std::vector<SceneEdge> scene_edges(const RayScene& rays, const Camera& camera);

}  // namespace luxrig
