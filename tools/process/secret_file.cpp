#include "tools/process/secret_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "tools/process/files.h"

namespace luxrig {

Result<void> write_secret(const std::filesystem::path& file, const std::string& text) {
  const std::string aside = file.string() + ".new";
  ::unlink(aside.c_str());
  const int to = ::open(aside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  const bool written =
      to >= 0 && ::write(to, text.data(), text.size()) == static_cast<ssize_t>(text.size()) && ::fsync(to) == 0;
  if (to >= 0) ::close(to);
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  if (written && ::rename(aside.c_str(), file.c_str()) == 0 && sync_folder(folder)) return {};
  const std::string why = std::strerror(errno);
  ::unlink(aside.c_str());
  return tl::unexpected(Fault{Cause::system, {}, fmt::format("{} cannot be written: {}", file.string(), why), {}});
}

Checked<std::string> read_secret(const std::filesystem::path& file, std::size_t most_bytes, unsigned others_may_not) {
  const auto refused = [&](std::string what, std::string mend) {
    return tl::unexpected(std::vector<Problem>{{file.string(), 0, 0, std::move(what), std::move(mend)}});
  };
  // O_NONBLOCK: a pipe of that name must not hold us up.
  const int from = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (from < 0) return refused(std::string("cannot be read: ") + std::strerror(errno), "look at its path and its mode");
  struct stat about {};
  const bool known = ::fstat(from, &about) == 0;
  const bool plain = known && S_ISREG(about.st_mode) && static_cast<std::size_t>(about.st_size) <= most_bytes;
  const bool ours = known && (about.st_uid == ::geteuid() || about.st_uid == 0);
  const unsigned others = about.st_mode & others_may_not;
  std::string text(plain && ours && others == 0 ? static_cast<std::size_t>(about.st_size) : 0, '\0');
  std::size_t got = 0;
  for (ssize_t n = 1; n > 0 && got < text.size(); got += static_cast<std::size_t>(std::max<ssize_t>(n, 0)))
    n = ::read(from, text.data() + got, text.size() - got);
  ::close(from);
  if (!plain) return refused(fmt::format("is no file of at most {} KiB", most_bytes >> 10), "name another");
  if (!ours) return refused("belongs to another user", fmt::format("chown it to user {}", ::geteuid()));
  if (others != 0)
    return refused(fmt::format("has mode {:o}: others may read or change it", about.st_mode & 0777u),
                   fmt::format("chmod {:o} it", 0600u | (0044u & ~others_may_not)));
  text.resize(got);
  return text;
}

}  // namespace luxrig
