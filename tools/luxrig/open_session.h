#pragma once
/// From a rig file to something that can be computed with; what every command starts from.

#include <filesystem>

#include "core/tasks/session.h"

namespace luxrig {

/// Reads and checks everything: rig, photometry, buses, meshes, where lights may hang. All problems, or a Session.
[[nodiscard]] Checked<Session> open_session(const std::filesystem::path& rig_path);

}  // namespace luxrig
