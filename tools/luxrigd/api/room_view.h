#pragma once
/// What a rig is, for clients: all that only a reload changes.

#include <memory>
#include <string>

#include "core/tasks/session.h"
#include "tools/http/kept_answer.h"

namespace luxrig {

struct RoomView {
  std::string json;  ///< answer to GET /api/room
  std::string png;   ///< the room from above; empty if the scene is
  std::shared_ptr<const KeptAnswer> rig;   ///< answer to GET /api/rig
  std::shared_ptr<const KeptAnswer> mesh;  ///< to GET /api/rig/mesh; null if the scene is empty, or too large for it
};

/// Takes a second.
[[nodiscard]] RoomView draw_room(const Session& session);

/// Triangles up to which a mesh is served: 10 MB per million.
inline constexpr std::size_t kMostTriangles = 2'000'000;

/// The scene as clients draw it: three little-endian 32-bit words, 0x314d584c ("LXM1"), number of vertices and of
/// triangles; x, y, z of each vertex as 32-bit floats, in metres from `mesh.origin` of GET /api/rig; three vertices of
/// each triangle; the material of each triangle.
[[nodiscard]] std::string mesh_bytes(const Scene& scene);

}  // namespace luxrig
