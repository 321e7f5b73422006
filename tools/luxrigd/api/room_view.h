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
  std::shared_ptr<const KeptAnswer> rig;  ///< answer to GET /api/rig
};

/// Takes a second.
[[nodiscard]] RoomView draw_room(const Session& session);

}  // namespace luxrig
