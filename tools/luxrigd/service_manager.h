#pragma once
/// Tells systemd that we are ready and alive: sd_notify(3), which is one datagram. Silent where nobody asked for it.

#include <string>
#include <string_view>

#include "core/time.h"

namespace luxrig {

class ServiceManager {
 public:
  /// Takes NOTIFY_SOCKET and WATCHDOG_USEC out of the environment: what we start must not speak for us.
  ServiceManager();
  ~ServiceManager();
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  void ready() const { tell("READY=1"); }
  void ending() const { tell("STOPPING=1"); }
  /// Call as often as you like: half as late as it may be at most, it is told.
  void alive(Time now);

 private:
  void tell(std::string_view text) const;
  int fd_ = -1;
  std::string address_;
  Duration every_{};
  Time told_{};
};

}  // namespace luxrig
