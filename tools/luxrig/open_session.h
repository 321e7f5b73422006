#pragma once
/// From a rig file to something that can be computed with. Every command starts here.

#include <filesystem>

#include "core/tasks/session.h"

namespace luxrig {

/// Reads and checks everything: rig, photometry, buses, meshes, mounting. All problems, or a Session.
[[nodiscard]] Checked<Session> open_session(const std::filesystem::path& rig_path);

}  // namespace luxrig
