#include "tools/process/runtime_folder.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <string>

namespace luxrig {
namespace {

std::vector<std::filesystem::path> candidates() {
  std::vector<std::filesystem::path> folders;
  const std::string user = std::to_string(::geteuid());
  if (const char* given = std::getenv("XDG_RUNTIME_DIR"); given != nullptr && *given == '/')
    folders.emplace_back(std::filesystem::path(given) / "luxrig");
  if (::geteuid() == 0) folders.emplace_back("/run/luxrig");
  folders.emplace_back("/run/user/" + user + "/luxrig");
  folders.emplace_back("/tmp/luxrig-" + user);
  return folders;
}

/// Symbolic links are refused: in /tmp anyone may have made one.
bool is_private_folder(const std::filesystem::path& folder) {
  struct stat is {};
  return ::lstat(folder.c_str(), &is) == 0 && S_ISDIR(is.st_mode) && is.st_uid == ::geteuid() &&
         (is.st_mode & (S_IRWXG | S_IRWXO)) == 0;
}

}  // namespace

std::vector<std::filesystem::path> runtime_folders() {
  std::vector<std::filesystem::path> folders;
  for (auto& folder : candidates())
    if (is_private_folder(folder)) folders.push_back(std::move(folder));
  return folders;
}

std::optional<std::filesystem::path> runtime_folder() {
  for (auto& folder : candidates())
    if ((::mkdir(folder.c_str(), S_IRWXU) == 0 || errno == EEXIST) && is_private_folder(folder)) return folder;
  return std::nullopt;
}

}  // namespace luxrig
