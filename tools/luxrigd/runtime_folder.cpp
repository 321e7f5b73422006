#include "tools/luxrigd/runtime_folder.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <string>

namespace luxrig {

std::optional<std::filesystem::path> runtime_folder() {
  const char* given = std::getenv("XDG_RUNTIME_DIR");
  std::filesystem::path folder = "/run/luxrig";
  if (given != nullptr && *given == '/') {
    folder = std::filesystem::path(given) / "luxrig";
  } else if (::geteuid() != 0) {
    folder = "/tmp/luxrig-" + std::to_string(::geteuid());
  }
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) return std::nullopt;
  struct stat is {};
  // Not through a link: in /tmp anybody may have made one.
  if (::lstat(folder.c_str(), &is) != 0 || !S_ISDIR(is.st_mode) || is.st_uid != ::geteuid() || (is.st_mode & 077) != 0)
    return std::nullopt;
  return folder;
}

}  // namespace luxrig
