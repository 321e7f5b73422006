#include "tools/process/files.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string_view>

namespace luxrig {

namespace {

/// Repeats a call while signals interrupt it.
template <class Call>
auto uninterrupted(Call call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

/// A descriptor that closes with its scope. A failing close() loses nothing: the data was synced before.
class OpenFile {
 public:
  OpenFile(const std::filesystem::path& path, int flags)
      : fd_(uninterrupted([&] { return ::open(path.c_str(), flags | O_CLOEXEC, 0644); })) {}
  ~OpenFile() {
    if (fd_ < 0) return;
    const int before = errno;
    ::close(fd_);
    errno = before;
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  [[nodiscard]] bool good() const { return fd_ >= 0; }
  /// EINVAL: this file system has nothing to sync.
  [[nodiscard]] bool sync() const {
    return uninterrupted([&] { return ::fsync(fd_); }) == 0 || errno == EINVAL;
  }
  [[nodiscard]] bool write(std::string_view text) const {
    while (!text.empty()) {
      const ssize_t n = uninterrupted([&] { return ::write(fd_, text.data(), text.size()); });
      if (n < 0) return false;
      text.remove_prefix(static_cast<std::size_t>(n));
    }
    return true;
  }
  /// Appends the rest of the file.
  [[nodiscard]] bool read(std::string& text) const {
    char block[1 << 16];
    while (true) {
      const ssize_t n = uninterrupted([&] { return ::read(fd_, block, sizeof block); });
      if (n <= 0) return n == 0;
      text.append(block, static_cast<std::size_t>(n));
    }
  }

 private:
  const int fd_;
};

}  // namespace

bool sync_folder(const std::filesystem::path& folder) {
  const OpenFile opened(folder, O_RDONLY | O_DIRECTORY);
  return opened.good() && opened.sync();
}

Result<void> write_file(const std::filesystem::path& path, const std::string& text) {
  const auto failed = [&](const char* step) {
    return tl::unexpected(Fault{
        Cause::system, {}, "cannot " + std::string(step) + " " + path.string() + ": " + std::strerror(errno), {}});
  };
  // Written to disk under another name first, then renamed: a power cut leaves the old file or the new one.
  const std::string temporary = path.string() + ".new";
  const char* failing = nullptr;
  {
    const OpenFile file(temporary, O_WRONLY | O_CREAT | O_TRUNC);
    if (!file.good()) return failed("write");
    if (!file.write(text))
      failing = "write";
    else if (!file.sync())
      failing = "sync";
  }
  if (failing == nullptr && ::rename(temporary.c_str(), path.c_str()) != 0) failing = "replace";
  if (failing != nullptr) {
    const auto fault = failed(failing);
    ::unlink(temporary.c_str());  // it would keep a full disk full
    return fault;
  }
  if (!sync_folder(path.has_parent_path() ? path.parent_path() : ".")) return failed("sync the folder of");
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
  const OpenFile file(path, O_RDONLY);
  std::string text;
  text.reserve(size);
  if (!file.good() || !file.read(text))
    return refuse("cannot be read: " + std::string(std::strerror(errno)), "check its permissions and its disk");
  return text;
}

}  // namespace luxrig
