#pragma once
/// Notices when a rig's files have changed since they were read. It polls on its own thread, so that a slow disk delays
/// nothing else.

#include <filesystem>
#include <memory>
#include <vector>

#include "core/rig/rig.h"
#include "core/time.h"

namespace luxrig {

/// The rig file, its meshes, photometry, makers' fixture files and strokes of painted goals.
[[nodiscard]] std::vector<std::filesystem::path> files_of(const Rig& rig);

class RigFileWatch {
 public:
  /// Looks at once, then every `period`, on its own thread.
  explicit RigFileWatch(std::vector<std::filesystem::path> files, Duration period = std::chrono::seconds(2));
  ~RigFileWatch();

  /// Files that are gone, or whose content differs from the first look.
  [[nodiscard]] std::vector<std::filesystem::path> changed() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace luxrig
