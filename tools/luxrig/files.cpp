#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "tools/luxrig/commands.h"

namespace luxrig {

Result<void> write_file(const std::filesystem::path& path, const std::string& text) {
  const auto failed = [&](const char* step) {
    return tl::unexpected(Fault{
        Cause::system, {}, "cannot " + std::string(step) + " " + path.string() + ": " + std::strerror(errno), {}});
  };
  // On disk under another name first, then renamed: a power cut leaves the old file or the new one.
  const std::string temporary = path.string() + ".new";
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) return failed("write");
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t n = ::write(file, text.data() + written, text.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const auto fault = failed("write");
      ::close(file);
      return fault;
    }
    written += static_cast<std::size_t>(n);
  }
  const bool synced = ::fsync(file) == 0;
  ::close(file);
  if (!synced) return failed("sync");
  if (::rename(temporary.c_str(), path.c_str()) != 0) return failed("replace");
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  if (const int directory = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); directory >= 0) {
    ::fsync(directory);
    ::close(directory);
  }
  return {};
}

Checked<std::string> read_file(const std::filesystem::path& path) {
  const auto refuse = [&](std::string what, std::string mend) {
    return tl::unexpected(std::vector<Problem>{{path.string(), 0, 0, std::move(what), std::move(mend)}});
  };
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (error) return refuse("cannot be read: " + error.message(), "give the path of a file that exists");
  if (size > (64u << 20)) return refuse("is larger than 64 MiB", "give the right file");
  std::ifstream in(path, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(in)), {});
  if (!in && !in.eof()) return refuse("cannot be read", "check its permissions");
  return text;
}

}  // namespace luxrig
