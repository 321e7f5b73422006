#include "drivers/dmx/usb/ftdi.h"

#include <algorithm>

namespace luxrig::ftdi {
namespace {

constexpr std::uint16_t kBreakBit = 0x4000;
constexpr int kBaseClock_hz = 3'000'000;
constexpr std::uint8_t kTransmitterEmpty = 0x40;
constexpr std::size_t kStatusBytes = 2;

UsbSetup vendor(std::uint8_t request, std::uint16_t value, Port port) {
  return {kUsbVendorOut, request, value, port.index};
}

}  // namespace

UsbSetup reset(Port port, Purge what) { return vendor(0, static_cast<std::uint16_t>(what), port); }
UsbSetup set_rts(Port port, bool high) { return vendor(1, high ? 0x0202 : 0x0200, port); }
UsbSetup no_flow_control(Port port) { return vendor(2, 0, port); }
UsbSetup set_baud(Port port, int baud) { return vendor(3, static_cast<std::uint16_t>(kBaseClock_hz / baud), port); }
UsbSetup set_format(Port port, Format format, bool asserts_break) {
  const auto bits = static_cast<std::uint16_t>(format);
  return vendor(4, static_cast<std::uint16_t>(bits | (asserts_break ? kBreakBit : 0)), port);
}
UsbSetup set_latency(Port port, int latency_ms) { return vendor(9, static_cast<std::uint16_t>(latency_ms), port); }
UsbSetup get_modem_status(Port port) { return {kUsbVendorIn, 5, 0, port.index}; }

bool transmitter_is_empty(std::span<const std::uint8_t> modem_status) {
  return modem_status.size() >= kModemStatusBytes && (modem_status[1] & kTransmitterEmpty) != 0;
}

std::vector<std::uint8_t> received_bytes(std::span<const std::uint8_t> transfer, std::size_t packet_bytes) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t at = 0; at < transfer.size(); at += packet_bytes) {
    const auto packet = transfer.subspan(at, std::min(packet_bytes, transfer.size() - at));
    if (packet.size() > kStatusBytes) bytes.insert(bytes.end(), packet.begin() + kStatusBytes, packet.end());
  }
  return bytes;
}

}  // namespace luxrig::ftdi
