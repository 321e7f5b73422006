#pragma once
/// Modbus TCP on a port of this machine: connections, and answers sent when they are due. Never blocks.

#include <deque>
#include <list>
#include <memory>
#include <vector>

#include "sim/wire/modbus/modbus_session.h"
#include "sim/wire/sockets.h"

namespace luxrig::sim {

class ModbusServer {
 public:
  /// `port` 0 = any free one. `units` must outlive the server.
  static Result<std::unique_ptr<ModbusServer>> open(int port, std::uint32_t address, ModbusUnits& units);

  [[nodiscard]] int port() const { return port_; }
  /// Closed: drops connections and refuses new ones. Reopens on the same port.
  void set_open(bool open);
  /// Accepts, reads, answers.
  void serve(Time now);
  void descriptors(std::vector<int>& into) const;
  [[nodiscard]] std::size_t connections() const { return connections_.size(); }

 private:
  struct Waiting {
    Time due;
    std::vector<std::uint8_t> bytes;
  };
  struct Connection {
    Descriptor socket;
    ModbusSession session;
    std::deque<Waiting> waiting;
    std::vector<std::uint8_t> unsent;
  };

  explicit ModbusServer(ModbusUnits& units) : units_(units) {}
  bool serve(Connection& connection, Time now);  ///< false: hang up

  ModbusUnits& units_;
  BoundSocket listener_;
  int port_ = 0;
  std::uint32_t address_ = kLoopback;
  std::list<Connection> connections_;
};

}  // namespace luxrig::sim
