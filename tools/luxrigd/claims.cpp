#include "tools/luxrigd/claims.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <functional>
#include <set>
#include <thread>

#include "drivers/io/os_fault.h"
#include "tools/process/clock.h"

namespace luxrig {
namespace {

constexpr std::string_view kClaimPrefix = "luxrig ";
constexpr auto kClaimLook = std::chrono::milliseconds(20);

struct ClaimName {
  sockaddr_un address{};
  socklen_t size = 0;
};

/// An abstract name begins with a zero byte. A name that is too long ends in its hash.
ClaimName name_of_claim(const std::string& what) {
  std::string name = std::string(kClaimPrefix) + what;
  ClaimName made;
  made.address.sun_family = AF_UNIX;
  constexpr std::size_t most = sizeof(made.address.sun_path) - 1;
  if (name.size() > most) {
    const std::string number = fmt::format("{:016x}", std::hash<std::string>{}(name));
    name = name.substr(0, most - number.size()) + number;
  }
  std::memcpy(made.address.sun_path + 1, name.data(), name.size());
  made.size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  return made;
}

/// The process that made the claim; a child of it may hold it now.
std::string holder_of(const ClaimName& name) {
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  ucred peer{};
  socklen_t size = sizeof peer;
  const bool known = fd >= 0 && ::connect(fd, reinterpret_cast<const sockaddr*>(&name.address), name.size) == 0 &&
                     ::getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0;
  if (fd >= 0) ::close(fd);
  if (!known) return "by another process";
  return fmt::format("by process {} of user {}, or the guardian that it left behind", peer.pid, peer.uid);
}

std::string text_of(const Bus& bus, std::string_view key) {
  const auto found = bus.options.find(std::string(key));
  if (found == bus.options.end()) return {};
  if (const auto* text = std::get_if<std::string>(&found->second.value)) return *text;
  if (const auto* number = std::get_if<std::int64_t>(&found->second.value)) return std::to_string(*number);
  return {};
}

std::string where_of(const Bus& bus, const std::map<std::string, Redirect>& redirects) {
  if (const auto it = redirects.find(bus.name); it != redirects.end()) {
    return it->second.path.empty() ? fmt::format("{}:{}", it->second.host, it->second.port) : it->second.path;
  }
  std::string where;
  for (const std::string_view key : {"device", "host", "destination"}) {
    if (where.empty()) where = text_of(bus, key);
  }
  if (const std::string port = text_of(bus, "port"); !port.empty()) where += ":" + port;
  if (bus.driver == "canopen") where = text_of(bus, "interface");
  return where;
}

}  // namespace

Result<void> Claims::take(const std::string& what, Duration wait) {
  const ClaimName name = name_of_claim(what);
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return tl::unexpected(os_fault("claiming " + what, errno));
  const Time until = now() + wait;
  while (::bind(fd, reinterpret_cast<const sockaddr*>(&name.address), name.size) != 0) {
    const int why = errno;
    if (why == EADDRINUSE && now() < until) {
      std::this_thread::sleep_for(kClaimLook);
      continue;
    }
    ::close(fd);
    if (why != EADDRINUSE) return tl::unexpected(os_fault("claiming " + what, why));
    return tl::unexpected(Fault{Cause::refused, {}, fmt::format("{} is held {}", what, holder_of(name)), {}});
  }
  (void)::listen(fd, 1);  // so that another process can ask who we are
  descriptors_.push_back(fd);
  return {};
}

void Claims::release() {
  for (const int fd : descriptors_) ::close(fd);
  descriptors_.clear();
}

std::vector<std::string> outputs_of(const Rig& rig, const std::map<std::string, Redirect>& redirects) {
  std::set<std::string> outputs;
  for (const Fixture& fixture : rig.fixtures) {
    const Bus& bus = rig.buses[fixture.bus];
    const std::string where = where_of(bus, redirects);
    const std::string place = fmt::format("{}{}{}", bus.driver, where.empty() ? "" : " ", where);
    if (const auto* dmx = std::get_if<DmxPatch>(&fixture.patch))
      outputs.insert(fmt::format("{} universe {}", place, dmx->universe));
    if (const auto* modbus = std::get_if<ModbusPatch>(&fixture.patch))
      outputs.insert(fmt::format("{} unit {}", place, modbus->unit));
    if (fixture.moves && fixture.motion_bus() != fixture.bus) {
      const Bus& axes = rig.buses[fixture.motion_bus()];
      outputs.insert(fmt::format("{} {}", axes.driver, where_of(axes, redirects)));
    }
  }
  return {outputs.begin(), outputs.end()};
}

}  // namespace luxrig
