#include "drivers/usb/tty_lock.h"

#include <fmt/format.h>
#include <signal.h>

#include <cerrno>
#include <fstream>

namespace luxrig {

std::optional<TtyUser> tty_user(const std::string& port, int interface, const std::filesystem::path& devices,
                                const std::filesystem::path& locks) {
  std::error_code error;
  // "1-1.4:1.0": configuration 1, the only one that these devices have.
  const auto folder = devices / fmt::format("{}:1.{}", port, interface);
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string tty = entry->path().filename().string();
    if (!tty.starts_with("tty") || tty == "tty") continue;
    std::ifstream lock(locks / ("LCK.." + tty));
    int pid = 0;
    if (!(lock >> pid) || pid <= 0) continue;
    if (::kill(pid, 0) == 0 || errno == EPERM) return TtyUser{tty, pid};
  }
  return std::nullopt;
}

}  // namespace luxrig
