#pragma once
/// Transfers with one claimed USB device, without blocking. libusb_channel.h has the real channel, usbip_channel.h
/// reaches a stand-in, and tests use tests/conformance/model_channel.h.
///
/// Starting a transfer gives a ticket. take() returns ended transfers in the order in which they ended. Transfers of
/// one endpoint are done in the order of their start; those of different endpoints are not ordered. No transfer has its
/// own timeout: the caller decides when it has taken too long, and cancels it.

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"

namespace luxrig {

/// USB 2.0 table 9-2; the length follows from the data.
struct UsbSetup {
  std::uint8_t request_type = 0, request = 0;
  std::uint16_t value = 0, index = 0;
  friend bool operator==(const UsbSetup&, const UsbSetup&) = default;
};
inline constexpr std::uint8_t kUsbVendorOut = 0x40, kUsbVendorIn = 0xC0;  ///< request_type: vendor's, to the device

enum class UsbStatus {
  done,
  stalled,    ///< the device refused it (libusb: PIPE)
  cancelled,  ///< by cancel() or close()
  gone,       ///< the device is unplugged
  failed,     ///< anything else: no answer to a packet, or garbled on the cable
};
[[nodiscard]] const char* name_of(UsbStatus status);

using UsbTicket = std::uint32_t;

struct UsbCompletion {
  UsbTicket ticket = 0;
  UsbStatus status = UsbStatus::done;
  std::size_t transferred = 0;     ///< bytes of data, out or in
  std::vector<std::uint8_t> data;  ///< of IN transfers
};

class UsbChannel {
 public:
  virtual ~UsbChannel() = default;

  /// Finds the device and claims its interface; idempotent. Takes kUsbOpenBound at most. A Fault states the problem and
  /// its remedy.
  virtual Result<void> open() = 0;
  /// Cancels pending transfers, releases the interface and returns it to the kernel's driver.
  virtual void close() = 0;
  [[nodiscard]] virtual bool is_open() const = 0;
  /// "0403:6001 EN012345 at 1-1.4"; empty while closed.
  [[nodiscard]] virtual std::string where() const = 0;

  // requires is_open(). Any error shows in the transfer's completion.
  virtual UsbTicket control_out(const UsbSetup& setup, std::span<const std::uint8_t> data) = 0;
  virtual UsbTicket control_in(const UsbSetup& setup, std::size_t length) = 0;
  virtual UsbTicket bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> data) = 0;
  virtual UsbTicket bulk_in(std::uint8_t endpoint, std::size_t length) = 0;

  /// Its completion follows: cancelled, unless it has ended before.
  virtual void cancel(UsbTicket ticket) = 0;
  /// The next ended transfer; waits for at most `wait`.
  virtual std::optional<UsbCompletion> take(std::chrono::milliseconds wait) = 0;
};

inline constexpr std::chrono::milliseconds kUsbOpenBound(150);

}  // namespace luxrig
