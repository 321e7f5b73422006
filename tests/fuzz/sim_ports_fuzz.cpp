// Any bytes as the ports file of a simulated rig: refused with a remedy, or each bus with a target.
#include <cstdint>
#include <string>

#include "core/check.h"
#include "core/text/plain_text.h"
#include "tools/process/sim_ports.h"

namespace {

void check_endpoint(const luxrig::Redirect& to) {
  LUXRIG_CHECK(to.port >= 1 && to.port <= 65535, "port {}", to.port);
  LUXRIG_CHECK(to.desk_port >= 0 && to.desk_port <= 65535, "desk port {}", to.desk_port);
  LUXRIG_CHECK(!to.host.empty() && luxrig::is_plain_text(to.host), "host {}", to.host);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto ports = luxrig::sim_ports_of(std::string(reinterpret_cast<const char*>(data), size), "ports.json");
  if (!ports) {
    LUXRIG_CHECK(!ports.error().empty(), "refused without a problem");
    for (const luxrig::Problem& problem : ports.error())
      LUXRIG_CHECK(!problem.what.empty() && !problem.mend.empty(), "a problem without text");
    return 0;
  }
  check_endpoint(ports->control);
  for (const auto& [bus, to] : ports->buses) {
    if (to.path.empty())
      check_endpoint(to);
    else
      LUXRIG_CHECK(to.port == 0 && to.path.front() == '/' && luxrig::is_plain_text(to.path), "path {}", to.path);
  }
  return 0;
}
