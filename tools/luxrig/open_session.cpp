#include "tools/luxrig/open_session.h"

#include "core/rig/rig_file.h"
#include "drivers/camera/camera_source.h"
#include "drivers/registry.h"

namespace luxrig {

Checked<Session> open_session(const std::filesystem::path& rig_path) {
  auto rig = load_rig(rig_path);
  if (!rig) return tl::unexpected(std::move(rig.error()));
  if (auto problems = check_buses(*rig); !problems.empty()) return tl::unexpected(std::move(problems));
  if (auto problems = check_cameras(*rig); !problems.empty()) return tl::unexpected(std::move(problems));
  return session_of(std::move(*rig));
}

}  // namespace luxrig
