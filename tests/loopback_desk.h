#pragma once
/// A lighting desk on loopback. It builds its packets from the standards, byte by byte.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace luxrig::test {

using DeskPacket = std::vector<std::uint8_t>;
using DeskSlots = std::vector<std::uint8_t>;  ///< 512, address 1 first

inline void put_be16(DeskPacket& packet, std::size_t at, std::size_t value) {
  packet[at] = static_cast<std::uint8_t>(value >> 8);
  packet[at + 1] = static_cast<std::uint8_t>(value);
}

/// ANSI E1.31-2018, table 4-1, 512 slots.
inline DeskPacket sacn_packet(int universe, std::uint8_t sequence, const DeskSlots& slots, int priority = 100) {
  DeskPacket packet(638, 0);
  put_be16(packet, 0, 0x0010);
  const std::string id = "ASC-E1.17";
  std::copy(id.begin(), id.end(), packet.begin() + 4);
  put_be16(packet, 16, 0x726e);
  packet[21] = 4;
  packet[22] = 0xAB;  // CID
  put_be16(packet, 38, 0x7258);
  packet[43] = 2;
  packet[44] = 'X';  // source name
  packet[108] = static_cast<std::uint8_t>(priority);
  packet[111] = sequence;
  put_be16(packet, 113, static_cast<std::size_t>(universe));
  put_be16(packet, 115, 0x720b);
  packet[117] = 2;
  packet[118] = 0xa1;
  packet[122] = 1;
  put_be16(packet, 123, 513);
  std::copy_n(slots.begin(), std::min<std::size_t>(slots.size(), 512), packet.begin() + 126);
  return packet;
}

/// Art-Net 4, ArtDmx. sequence: 1…255; 0 = not counted.
inline DeskPacket artdmx_packet(int universe, std::uint8_t sequence, const DeskSlots& slots) {
  DeskPacket packet(530, 0);
  const std::string id = "Art-Net";
  std::copy(id.begin(), id.end(), packet.begin());
  packet[9] = 0x50;
  packet[11] = 14;
  packet[12] = sequence;
  packet[14] = static_cast<std::uint8_t>(universe);
  put_be16(packet, 16, 512);
  std::copy_n(slots.begin(), std::min<std::size_t>(slots.size(), 512), packet.begin() + 18);
  return packet;
}

class LoopbackDesk {
 public:
  /// from: the loopback address it sends from. Art-Net tells senders apart by address.
  explicit LoopbackDesk(const char* from = "127.0.0.1") : fd_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in own = loopback(0);
    EXPECT_EQ(::inet_pton(AF_INET, from, &own.sin_addr), 1);
    EXPECT_EQ(::bind(fd_, reinterpret_cast<const sockaddr*>(&own), sizeof(own)), 0);
    // A free port: taken from a socket bound just now.
    const int probe = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_in address = loopback(0);
    socklen_t size = sizeof(address);
    EXPECT_EQ(::bind(probe, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(::getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size), 0);
    port_ = ntohs(address.sin_port);
    ::close(probe);
  }
  ~LoopbackDesk() { ::close(fd_); }
  LoopbackDesk(const LoopbackDesk&) = delete;
  LoopbackDesk& operator=(const LoopbackDesk&) = delete;

  /// The port where Luxrig listens for it.
  [[nodiscard]] int port() const { return port_; }
  void send(const DeskPacket& packet) const { send_to(port_, packet); }
  void send_to(int port, const DeskPacket& packet) const {
    const sockaddr_in to = loopback(port);
    ::sendto(fd_, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof(to));
  }

 private:
  static sockaddr_in loopback(int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    return address;
  }

  int fd_;
  int port_ = 0;
};

}  // namespace luxrig::test
