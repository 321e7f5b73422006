#pragma once
/// Transfers with one claimed USB device, without blocking. libusb_channel.h is the real one, usbip_channel.h reaches a
/// stand-in; tests put tests/drivers/usb/scripted_usb.h in their place.
///
/// A transfer is started and gets a ticket; take() hands out what has ended, in the order in which it ended. Transfers
/// of one endpoint are done in the order in which they were started; those of different endpoints are not ordered. No
/// transfer has a timeout of its own: whoever started it decides when it has taken too long, and cancels.

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
  gone,       ///< the device has been unplugged
  failed,     ///< anything else: no answer to a packet, garbled on the cable
};
[[nodiscard]] const char* name_of(UsbStatus status);

using UsbTicket = std::uint32_t;

struct UsbCompletion {
  UsbTicket ticket = 0;
  UsbStatus status = UsbStatus::done;
  std::size_t transferred = 0;     ///< bytes of data, out or in
  std::vector<std::uint8_t> data;  ///< of transfers in
};

class UsbChannel {
 public:
  virtual ~UsbChannel() = default;

  /// Finds the device and claims its interface; idempotent. Takes kUsbOpenBound at most. A Fault says what is wrong and
  /// what would mend it.
  virtual Result<void> open() = 0;
  /// Cancels what is under way, releases the interface and gives it back to the kernel's driver.
  virtual void close() = 0;
  [[nodiscard]] virtual bool is_open() const = 0;
  /// "0403:6001 EN012345 at 1-1.4"; empty while closed.
  [[nodiscard]] virtual std::string where() const = 0;

  // requires is_open(). Whatever goes wrong shows in the transfer's completion.
  virtual UsbTicket control_out(const UsbSetup& setup, std::span<const std::uint8_t> data) = 0;
  virtual UsbTicket control_in(const UsbSetup& setup, std::size_t length) = 0;
  virtual UsbTicket bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> data) = 0;
  virtual UsbTicket bulk_in(std::uint8_t endpoint, std::size_t length) = 0;

  /// Its completion follows, as cancelled unless it has ended before.
  virtual void cancel(UsbTicket ticket) = 0;
  /// What has ended; waits for at most that long.
  virtual std::optional<UsbCompletion> take(std::chrono::milliseconds wait) = 0;
};

inline constexpr std::chrono::milliseconds kUsbOpenBound(150);

}  // namespace luxrig
