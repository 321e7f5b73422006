#pragma once
/// Which USB device is wanted, and which of those that are there it is.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace luxrig {

/// A kind of device. Where makers share an id, the strings of the device tell them apart; empty: any.
struct UsbKind {
  std::uint16_t vendor = 0, product = 0;
  std::string_view manufacturer = {}, product_name = {};
};

struct UsbSearch {
  std::string what;  ///< "ENTTEC DMX USB Pro", for messages
  std::vector<UsbKind> kinds;
  std::string serial;  ///< empty: any
  std::string port;    ///< "1-1.4" as in /sys/bus/usb/devices; empty: any
  int interface = 0;   ///< to claim
};

/// What is known of a device that is plugged in.
struct UsbCandidate {
  std::uint16_t vendor = 0, product = 0;
  std::string port, serial, manufacturer, product_name;
};

/// By its id and port alone, before the device is opened.
[[nodiscard]] bool may_match(const UsbSearch& search, const UsbCandidate& candidate);
/// Whether its strings must be read to tell.
[[nodiscard]] bool needs_strings(const UsbSearch& search, const UsbCandidate& candidate);
[[nodiscard]] bool matches(const UsbSearch& search, const UsbCandidate& candidate);

/// The one of the matching candidates to open: none and several are faults. Several are refused, as the wrong one of
/// two widgets would light the wrong lamps.
[[nodiscard]] Result<std::size_t> choose(const UsbSearch& search, std::span<const UsbCandidate> matching);

/// "1-1.4": bus, then the ports on the way.
[[nodiscard]] std::string port_path(int bus, std::span<const std::uint8_t> ports);
[[nodiscard]] bool is_port_path(std::string_view text);
/// "0403:6001 EN012345 at 1-1.4"
[[nodiscard]] std::string text_of(const UsbCandidate& candidate);

}  // namespace luxrig
