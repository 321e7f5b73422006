#pragma once
/// A folder that goes with its owner; in memory if this machine has /dev/shm.

#include <stdlib.h>

#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

namespace luxrig {

class TemporaryFolder {
 public:
  /// An empty path() if none can be made; errno says why.
  TemporaryFolder() {
    std::error_code error;
    std::string name =
        (std::filesystem::exists("/dev/shm", error) ? "/dev/shm" : "/tmp") + std::string("/luxrig-XXXXXX");
    if (::mkdtemp(name.data()) != nullptr) path_ = name;
  }
  TemporaryFolder(TemporaryFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace luxrig
