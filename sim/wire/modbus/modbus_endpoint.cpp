#include "sim/wire/modbus/modbus_server.h"
#include "sim/wire/modbus/rig_units.h"

namespace luxrig::sim {
namespace {

class ModbusEndpoint final : public BusEndpoint {
 public:
  explicit ModbusEndpoint(const EndpointParts& parts) : parts_(parts), units_(parts) {}

  Result<void> open(const EndpointPlace& place) {
    auto server = ModbusServer::open(place.port, place.address, units_);
    if (!server) return tl::unexpected(server.error());
    server_ = std::move(*server);
    return {};
  }

  [[nodiscard]] int port() const override { return server_->port(); }
  void serve(Time now) override {
    units_.advance(now);
    server_->set_open(!parts_.faults.find(parts_.rig.buses[parts_.bus].name, FaultKind::dead));
    server_->serve(now);
  }
  void descriptors(std::vector<int>& into) const override { server_->descriptors(into); }

 private:
  EndpointParts parts_;
  RigUnits units_;
  std::unique_ptr<ModbusServer> server_;
};

}  // namespace

Result<std::unique_ptr<BusEndpoint>> open_modbus_endpoint(const EndpointParts& parts, const EndpointPlace& place) {
  auto endpoint = std::make_unique<ModbusEndpoint>(parts);
  if (auto opened = endpoint->open(place); !opened) return tl::unexpected(opened.error());
  return endpoint;
}

}  // namespace luxrig::sim
