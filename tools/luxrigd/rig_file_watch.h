#pragma once
/// Notices that files of a rig are no longer what they were when it was read. A thread of its own looks now and then,
/// so that a slow disk holds up nobody.

#include <filesystem>
#include <memory>
#include <vector>

#include "core/rig/rig.h"
#include "core/time.h"

namespace luxrig {

/// The rig file, its meshes, photometry and makers' files.
[[nodiscard]] std::vector<std::filesystem::path> files_of(const Rig& rig);

class RigFileWatch {
 public:
  /// Looks at once, then every `period`, from a thread of its own.
  explicit RigFileWatch(std::vector<std::filesystem::path> files, Duration period = std::chrono::seconds(2));
  ~RigFileWatch();

  /// Files whose content is another than it was at first, or that are gone.
  [[nodiscard]] std::vector<std::filesystem::path> changed() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace luxrig
