#pragma once
/// Whether another program uses a widget through the kernel's serial port.

#include <filesystem>
#include <optional>
#include <string>

namespace luxrig {

struct TtyUser {
  std::string tty;  ///< "ttyUSB0"
  int pid = 0;
};

/// The living process that holds the UUCP lock (/var/lock/LCK..ttyUSB0) of an interface's serial port; olad and others
/// take such locks. Locks of ended processes are ignored.
[[nodiscard]] std::optional<TtyUser> tty_user(const std::string& port, int interface,
                                              const std::filesystem::path& devices = "/sys/bus/usb/devices",
                                              const std::filesystem::path& locks = "/var/lock");

}  // namespace luxrig
