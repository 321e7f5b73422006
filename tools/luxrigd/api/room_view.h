#pragma once
/// The room seen from above, for the page.

#include <string>

#include "core/tasks/session.h"

namespace luxrig {

struct RoomView {
  std::string json;  ///< answer to GET /api/room
  std::string png;   ///< empty if the scene is
};

[[nodiscard]] RoomView draw_room(const Session& session);

}  // namespace luxrig
