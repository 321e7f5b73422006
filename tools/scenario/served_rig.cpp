#include "tools/scenario/served_rig.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tools/luxrig-sim/real_time.h"
#include "tools/process/clock.h"
#include "tools/process/files.h"

namespace luxrig::scenario {
namespace {

constexpr const char* kLoopback = "127.0.0.1";

}  // namespace

Result<std::unique_ptr<ServedRig>> ServedRig::open(const Rig& rig, std::unique_ptr<sim::World> world,
                                                   std::uint64_t fault_seed) {
  std::unique_ptr<ServedRig> made(new ServedRig(std::move(world), fault_seed));
  auto server = sim::RigServer::open(rig, *made->world_, made->faults_);
  if (!server) return tl::unexpected(server.error());
  made->server_ = std::move(*server);
  // Truth and faults are at hand here: whoever asks the control port is refused at once.
  made->no_control_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  if (made->no_control_ < 0 || ::bind(made->no_control_, reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
      ::getsockname(made->no_control_, reinterpret_cast<sockaddr*>(&address), &size) != 0)
    return refusal("no port for the simulated rig");
  made->control_port_ = ntohs(address.sin_port);
  made->last_turn_ = now();
  made->thread_ = std::jthread([rig_is = made.get()](const std::stop_token& stop) {
    sim::serve_in_real_time(*rig_is->world_, *rig_is->server_, rig_is->mutex_,
                            [rig_is, &stop] { return rig_is->goes_on(stop); });
  });
  return made;
}

ServedRig::~ServedRig() {
  thread_ = {};
  if (no_control_ >= 0) ::close(no_control_);
}

bool ServedRig::goes_on(const std::stop_token& stop) {
  const Time at = now();
  const Duration::rep gap_ns = (at - last_turn_).count();
  if (gap_ns > longest_gap_ns_) longest_gap_ns_ = gap_ns;
  last_turn_ = at;
  return !stop.stop_requested();
}

Result<void> ServedRig::write_ports(const std::filesystem::path& file,
                                    const std::map<std::string, int>& desk_ports) const {
  nlohmann::json json = {{"buses", nlohmann::json::object()},
                         {"control", {{"host", kLoopback}, {"port", control_port_}}}};
  for (const auto& [bus, port] : server_->ports()) {
    json["buses"][bus] = {{"host", kLoopback}, {"port", port}};
    if (const auto desk = desk_ports.find(bus); desk != desk_ports.end())
      json["buses"][bus]["desk_port"] = desk->second;
  }
  for (const auto& [bus, path] : server_->paths()) json["buses"][bus] = {{"path", path}};
  return write_file(file, json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

}  // namespace luxrig::scenario
