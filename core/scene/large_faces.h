#pragma once
/// Cuts faces that extend far beyond a venue, into smaller parts the nearer they are. A ground plane of 20 km would
/// cost its surroundings the precision of float (ray_scene.h: the error grows with the longest edge). Internal to
/// core/scene.

#include "core/scene/placed_mesh.h"

namespace luxrig {

inline constexpr double kLongEdge_m = 50;        ///< shorter edges are not cut
inline constexpr double kEdgePerDistance = 0.5;  ///< nor edges within this share of their distance to the origin

/// Halves edges until each is shorter than one of the two limits above. Edges shared by triangles are cut at the same
/// points, so no gap opens. The parts of a triangle take its place in the order. Returns false if the mesh would exceed
/// kMaxTriangles; it is then unusable.
[[nodiscard]] bool cut_large_faces(const Vec3& origin_world_m, PlacedMesh& mesh);

}  // namespace luxrig
