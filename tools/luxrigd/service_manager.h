#pragma once
/// Reports ready and alive to systemd: sd_notify(3), which is one datagram. Silent without NOTIFY_SOCKET.

#include <string>
#include <string_view>

#include "core/time.h"

namespace luxrig {

class ServiceManager {
 public:
  /// Removes NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID from the environment: child processes must not report for
  /// us.
  ServiceManager();
  ~ServiceManager();
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  void ready() const { tell("READY=1"); }
  void ending() const { tell("STOPPING=1"); }
  /// Call as often as you like. It sends a heartbeat at half the watchdog's timeout.
  void alive(Time now);

 private:
  void tell(std::string_view text) const;
  int fd_ = -1;
  std::string address_;
  Duration every_{};
  Time told_{};
};

}  // namespace luxrig
