#include "sim/wire/modbus/modbus_server.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>

namespace luxrig::sim {
namespace {

constexpr std::size_t kMaxConnections = 16;
constexpr std::size_t kMaxWaiting = 64;  // answers not read by a peer, or requested in advance
constexpr std::size_t kMaxUnsentBytes = 65536;

}  // namespace

Result<std::unique_ptr<ModbusServer>> ModbusServer::open(int port, std::uint32_t address, ModbusUnits& units) {
  auto listener = listen_tcp(port, address);
  if (!listener) return tl::unexpected(listener.error());
  std::unique_ptr<ModbusServer> server(new ModbusServer(units));
  server->port_ = listener->port;
  server->address_ = address;
  server->listener_ = std::move(*listener);
  return server;
}

void ModbusServer::set_open(bool open) {
  if (open == listener_.descriptor.open()) return;
  if (open) {
    // The port was taken in the meantime: it stays closed until the next call tries again.
    if (auto listener = listen_tcp(port_, address_)) listener_ = std::move(*listener);
    return;
  }
  listener_.descriptor.reset();
  connections_.clear();
}

void ModbusServer::serve(Time now) {
  while (listener_.descriptor.open()) {
    Descriptor socket(::accept4(listener_.descriptor.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!socket.open()) break;
    if (connections_.size() >= kMaxConnections) continue;
    const int at_once = 1;  // a second answer must not wait for the acknowledgement of the first
    ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once);
    connections_.emplace_back().socket = std::move(socket);
  }
  connections_.remove_if([&](Connection& connection) { return !serve(connection, now); });
}

bool ModbusServer::serve(Connection& connection, Time now) {
  std::array<std::uint8_t, 4096> buffer;
  while (!connection.session.broken()) {
    const auto received = ::recv(connection.socket.get(), buffer.data(), buffer.size(), 0);
    if (received == 0) return false;
    if (received < 0) {
      if (errno == EINTR) continue;
      if (errno == EAGAIN || errno == EWOULDBLOCK) break;
      return false;
    }
    for (ModbusReply& reply : connection.session.receive({buffer.data(), static_cast<std::size_t>(received)}, units_)) {
      // One connection, one order: an answer never overtakes an earlier one.
      Time due = now + reply.delay;
      if (!connection.waiting.empty()) due = std::max(due, connection.waiting.back().due);
      connection.waiting.push_back({due, std::move(reply.bytes)});
    }
    if (connection.waiting.size() > kMaxWaiting) return false;
  }
  while (!connection.waiting.empty() && connection.waiting.front().due <= now) {
    const auto& bytes = connection.waiting.front().bytes;
    connection.unsent.insert(connection.unsent.end(), bytes.begin(), bytes.end());
    connection.waiting.pop_front();
  }
  while (!connection.unsent.empty()) {
    const auto sent = ::send(connection.socket.get(), connection.unsent.data(), connection.unsent.size(), MSG_NOSIGNAL);
    if (sent < 0) {
      if (errno == EINTR) continue;
      if (errno == EAGAIN || errno == EWOULDBLOCK) break;
      return false;
    }
    connection.unsent.erase(connection.unsent.begin(), connection.unsent.begin() + sent);
  }
  if (connection.unsent.size() > kMaxUnsentBytes) return false;
  return !connection.session.broken() || !connection.unsent.empty();
}

void ModbusServer::descriptors(std::vector<int>& into) const {
  if (listener_.descriptor.open()) into.push_back(listener_.descriptor.get());
  for (const Connection& connection : connections_) into.push_back(connection.socket.get());
}

}  // namespace luxrig::sim
