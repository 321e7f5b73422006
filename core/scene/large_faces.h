#pragma once
/// Faces that reach far beyond a venue: a ground plane of 20 km would cost its surroundings the digits that float has
/// (ray_scene.h: the error grows with the longest edge). So they are cut, the finer the nearer. Internal to core/scene.

#include "core/scene/placed_mesh.h"

namespace luxrig {

inline constexpr double kLongEdge_m = 50;        ///< shorter edges stay whole
inline constexpr double kEdgePerDistance = 0.5;  ///< and so do edges of so much of their distance from the origin

/// Cuts edges at their middle until each is shorter than one of the two above. Edges that triangles share are cut at
/// the same places: no gap opens. Each triangle is replaced by its parts where it stood in the order. False, and a mesh
/// that is to be thrown away, if it would have more than kMaxTriangles.
[[nodiscard]] bool cut_large_faces(const Vec3& origin_world_m, PlacedMesh& mesh);

}  // namespace luxrig
