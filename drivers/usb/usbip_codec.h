#pragma once
/// The part of USB/IP (Linux, Documentation/usb/usbip_protocol.rst, version 1.1.1) that a client needs: import one
/// device, submit and unlink transfers. All fields are big-endian except the setup packet.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "drivers/usb/usb_channel.h"

namespace luxrig::usbip {

inline constexpr std::size_t kImportReplyBytes = 320, kHeaderBytes = 48;
/// Luxrig makes no longer transfers, so a larger length is garbage.
inline constexpr std::uint32_t kMaxBytes = 4096;

[[nodiscard]] std::vector<std::uint8_t> import_request(std::string_view bus_id);
/// The imported device's number, bus << 16 | device. Empty if the server refused or the reply is malformed.
/// requires kImportReplyBytes, or the first 8 of them of a refusal.
[[nodiscard]] std::optional<std::uint32_t> imported(std::span<const std::uint8_t> reply);

struct Submit {
  std::uint32_t sequence = 0, device = 0;
  bool in = false;
  std::uint8_t endpoint = 0;  ///< without its direction bit
  UsbSetup setup;             ///< of endpoint 0
  std::uint32_t length = 0;   ///< of the buffer
};
[[nodiscard]] std::vector<std::uint8_t> submit_header(const Submit& submit);
[[nodiscard]] std::vector<std::uint8_t> unlink_header(std::uint32_t sequence, std::uint32_t device,
                                                      std::uint32_t unlinked);

struct Answer {
  bool unlink = false;
  std::uint32_t sequence = 0;
  std::int32_t status = 0;   ///< 0, or a negative errno
  std::uint32_t length = 0;  ///< of a submitted transfer: bytes done; for an IN transfer the bytes follow
};
/// Empty for an invalid header: the stream is lost then.
[[nodiscard]] std::optional<Answer> decode_answer(std::span<const std::uint8_t, kHeaderBytes> header);

/// -EPIPE -> stalled, -ENODEV and -ESHUTDOWN -> gone, -ECONNRESET and -ENOENT -> cancelled.
[[nodiscard]] UsbStatus status_of(std::int32_t negative_errno);

}  // namespace luxrig::usbip
