#pragma once
/// Vendor requests of FTDI's USB serial chips, and the format of their bulk packets. Pure.
/// Source: Linux' ftdi_sio and FTDI's application notes, where they agree.

#include <cstdint>
#include <span>
#include <vector>

#include "drivers/usb/usb_channel.h"

namespace luxrig::ftdi {

inline constexpr std::uint16_t kVendor = 0x0403;
inline constexpr std::uint16_t kFt232 = 0x6001, kFt2232 = 0x6010, kFt4232 = 0x6011;

/// One port of a chip. Single-port chip: index 0, interface 0. Port n of a multi-port chip: index n, interface n − 1.
struct Port {
  std::uint16_t index = 0;
  [[nodiscard]] int interface() const { return index == 0 ? 0 : index - 1; }
  [[nodiscard]] std::uint8_t bulk_in() const { return static_cast<std::uint8_t>(0x81 + 2 * interface()); }
  [[nodiscard]] std::uint8_t bulk_out() const { return static_cast<std::uint8_t>(0x02 + 2 * interface()); }
};

enum class Purge : std::uint16_t { reset = 0, receive = 1, transmit = 2 };
enum class Format : std::uint16_t { eight_n_one = 0x0008, eight_n_two = 0x1008 };

[[nodiscard]] UsbSetup reset(Port port, Purge what);
[[nodiscard]] UsbSetup set_rts(Port port, bool high);
[[nodiscard]] UsbSetup no_flow_control(Port port);
/// 3 MHz / baud, which must be whole: 250000 -> 0x000C, 57600 -> 0x0034 (0.16 % fast).
[[nodiscard]] UsbSetup set_baud(Port port, int baud);
[[nodiscard]] UsbSetup set_format(Port port, Format format, bool asserts_break = false);
[[nodiscard]] UsbSetup set_latency(Port port, int latency_ms);
inline constexpr std::size_t kModemStatusBytes = 2;
[[nodiscard]] UsbSetup get_modem_status(Port port);
/// Whether the last bit has left the chip, from the two bytes of get_modem_status(); false if truncated.
[[nodiscard]] bool transmitter_is_empty(std::span<const std::uint8_t> modem_status);

/// The received bytes of one bulk IN transfer: each USB packet starts with two status bytes.
[[nodiscard]] std::vector<std::uint8_t> received_bytes(std::span<const std::uint8_t> transfer,
                                                       std::size_t packet_bytes = 64);

}  // namespace luxrig::ftdi
