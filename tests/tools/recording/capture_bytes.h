#pragma once
/// Capture files and packets, byte by byte.

#include <gtest/gtest.h>

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "tools/recording/recording.h"

namespace luxrig::recording {

using CaptureBytes = std::vector<std::uint8_t>;

inline CaptureBytes joined(std::initializer_list<CaptureBytes> parts) {
  CaptureBytes all;
  for (const CaptureBytes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

inline CaptureBytes big16(std::size_t value) {
  return {static_cast<std::uint8_t>(value >> 8), static_cast<std::uint8_t>(value)};
}
inline CaptureBytes big32(std::size_t value) { return joined({big16(value >> 16), big16(value & 0xFFFF)}); }
inline CaptureBytes little32(std::size_t value) {
  const CaptureBytes big = big32(value);
  return {big[3], big[2], big[1], big[0]};
}

/// An IPv4 packet without options.
inline CaptureBytes ipv4_packet(std::uint8_t protocol, const CaptureBytes& from, const CaptureBytes& to,
                                const CaptureBytes& inside) {
  return joined({{0x45, 0}, big16(20 + inside.size()), {0, 1, 0x40, 0, 64, protocol, 0, 0}, from, to, inside});
}
inline CaptureBytes udp_packet(const CaptureBytes& from, int from_port, const CaptureBytes& to, int to_port,
                               const CaptureBytes& payload) {
  return ipv4_packet(17, from, to,
                     joined({big16(static_cast<std::size_t>(from_port)),
                             big16(static_cast<std::size_t>(to_port)),
                             big16(8 + payload.size()),
                             {0, 0},
                             payload}));
}
inline CaptureBytes tcp_packet(const CaptureBytes& from, int from_port, const CaptureBytes& to, int to_port,
                               std::uint32_t sequence, std::uint8_t flags, const CaptureBytes& payload) {
  return ipv4_packet(6, from, to,
                     joined({big16(static_cast<std::size_t>(from_port)),
                             big16(static_cast<std::size_t>(to_port)),
                             big32(sequence),
                             big32(0),
                             {0x50, flags},
                             big16(1000),
                             {0, 0, 0, 0},
                             payload}));
}

/// A pcap file (little-endian, microseconds) of raw IP packets, or of another link type.
class PcapBytes {
 public:
  explicit PcapBytes(std::uint32_t link_type = 101)
      : bytes_(joined(
            {{0xD4, 0xC3, 0xB2, 0xA1, 2, 0, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0}, little32(65535), little32(link_type)})) {}
  void add(double at_s, const CaptureBytes& packet, std::size_t of = 0) {
    const auto us = static_cast<std::uint64_t>(at_s * 1e6 + 0.5);
    bytes_ = joined({bytes_, little32(1'700'000'000 + us / 1'000'000), little32(us % 1'000'000),
                     little32(packet.size()), little32(of == 0 ? packet.size() : of), packet});
  }
  [[nodiscard]] CaptureBytes& bytes() { return bytes_; }

  [[nodiscard]] Checked<Recording> checked(const std::set<std::uint16_t>& modbus_ports = {}) {
    std::FILE* stream = ::fmemopen(bytes_.data(), bytes_.size(), "rb");
    return read_pcap(stream, "a.pcap", modbus_ports);
  }
  [[nodiscard]] Recording read(const std::set<std::uint16_t>& modbus_ports = {}) {
    auto read = checked(modbus_ports);
    EXPECT_TRUE(read.has_value()) << (read ? "" : read.error().front().text());
    return read ? std::move(*read) : Recording{};
  }

 private:
  CaptureBytes bytes_;
};

/// What is said of a bad file; "read" if nothing is.
inline std::string said_of(const Checked<Recording>& read) { return read ? "read" : read.error().front().text(); }

inline const CaptureBytes kDeskAddress = {10, 0, 0, 5}, kOwnAddress = {10, 0, 0, 1}, kServerAddress = {192, 0, 2, 10};

}  // namespace luxrig::recording
