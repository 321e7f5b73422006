#pragma once
/// Which USB device is wanted, and the choice among those present.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace luxrig {

/// A kind of device. If makers share an id, the strings of the device tell them apart; empty = any.
struct UsbKind {
  std::uint16_t vendor = 0, product = 0;
  std::string_view manufacturer = {}, product_name = {};
};

struct UsbSearch {
  std::string what;  ///< "ENTTEC DMX USB Pro", for messages
  std::vector<UsbKind> kinds;
  std::string serial;  ///< empty = any
  std::string port;    ///< "1-1.4" as in /sys/bus/usb/devices; empty = any
  int interface = 0;   ///< to claim
};

/// Facts about a plugged-in device.
struct UsbCandidate {
  std::uint16_t vendor = 0, product = 0;
  std::string port, serial, manufacturer, product_name;
};

/// By id and port only, before the device is opened.
[[nodiscard]] bool may_match(const UsbSearch& search, const UsbCandidate& candidate);
/// Whether its strings must be read to decide.
[[nodiscard]] bool needs_strings(const UsbSearch& search, const UsbCandidate& candidate);
[[nodiscard]] bool matches(const UsbSearch& search, const UsbCandidate& candidate);

/// Chooses the matching candidate to open. None is a fault. Several are a fault too, as the wrong one of two widgets
/// would light the wrong lamps.
[[nodiscard]] Result<std::size_t> choose(const UsbSearch& search, std::span<const UsbCandidate> matching);

/// "1-1.4": the bus, then the port at each hub.
[[nodiscard]] std::string port_path(int bus, std::span<const std::uint8_t> ports);
[[nodiscard]] bool is_port_path(std::string_view text);
/// "0403:6001 EN012345 at 1-1.4"
[[nodiscard]] std::string text_of(const UsbCandidate& candidate);

}  // namespace luxrig
