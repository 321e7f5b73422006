#pragma once
/// A folder in memory for a daemon's state, as long as this lives.

#include <stdlib.h>

#include <filesystem>
#include <string>
#include <system_error>

namespace luxrig::scenario {

class StateFolder {
 public:
  StateFolder() {
    std::error_code error;
    std::string name =
        (std::filesystem::exists("/dev/shm", error) ? "/dev/shm" : "/tmp") + std::string("/luxrig-test-XXXXXX");
    if (::mkdtemp(name.data()) != nullptr) path_ = name;
  }
  StateFolder(const StateFolder&) = delete;
  StateFolder& operator=(const StateFolder&) = delete;
  ~StateFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace luxrig::scenario
