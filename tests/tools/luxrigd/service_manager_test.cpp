#include "tools/luxrigd/service_manager.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

namespace luxrig {
namespace {

using namespace std::chrono_literals;

/// systemd's end of the socket.
class NotifySocket {
 public:
  NotifySocket() {
    name_ = "luxrig-test-" + std::to_string(::getpid());
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path + 1, name_.data(), name_.size());
    fd_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    EXPECT_EQ(::bind(fd_, reinterpret_cast<const sockaddr*>(&address),
                     static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name_.size())),
              0);
  }
  ~NotifySocket() { ::close(fd_); }
  [[nodiscard]] std::string address() const { return "@" + name_; }
  [[nodiscard]] std::string heard() const {
    char text[256];
    const ssize_t got = ::recv(fd_, text, sizeof text, 0);
    return got > 0 ? std::string(text, static_cast<std::size_t>(got)) : "";
  }

 private:
  std::string name_;
  int fd_ = -1;
};

/// Clears a service manager's variables at the end, as later tests are not started by one.
struct Said {
  ~Said() {
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) ::unsetenv(name);
  }
};

TEST(ServiceManager, IsNotifiedOfReadinessAndTwicePerWatchdogPeriod) {
  const Said said;
  const NotifySocket systemd;
  ::setenv("NOTIFY_SOCKET", systemd.address().c_str(), 1);
  ::setenv("WATCHDOG_USEC", "1000000", 1);
  ::setenv("WATCHDOG_PID", std::to_string(::getpid()).c_str(), 1);
  ServiceManager service;
  EXPECT_EQ(std::getenv("NOTIFY_SOCKET"), nullptr) << "what we start must not speak for us";
  service.ready();
  EXPECT_EQ(systemd.heard(), "READY=1");
  int told = 0;
  for (Time at = Time{} + 100s; at < Time{} + 110s; at += 20ms) {
    service.alive(at);
    while (systemd.heard() == "WATCHDOG=1") ++told;
  }
  EXPECT_EQ(told, 20);
  service.ending();
  EXPECT_EQ(systemd.heard(), "STOPPING=1");
}

TEST(ServiceManager, IsNotNotifiedUnlessRequested) {
  const Said said;
  ::unsetenv("NOTIFY_SOCKET");
  ServiceManager none;
  none.ready();
  none.alive(Time{} + 1s);
  ::setenv("NOTIFY_SOCKET", "nonsense", 1);
  ServiceManager nonsense;
  nonsense.ready();
  const NotifySocket systemd;
  ::setenv("NOTIFY_SOCKET", systemd.address().c_str(), 1);
  ::setenv("WATCHDOG_USEC", "1000000", 1);
  ::setenv("WATCHDOG_PID", "1", 1);
  ServiceManager of_another;
  of_another.alive(Time{} + 100s);
  EXPECT_EQ(systemd.heard(), "");
}

}  // namespace
}  // namespace luxrig
