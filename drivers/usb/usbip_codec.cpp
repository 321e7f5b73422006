#include "drivers/usb/usbip_codec.h"

#include <algorithm>
#include <cerrno>

namespace luxrig::usbip {
namespace {

constexpr std::uint16_t kUsbipVersion = 0x0111, kImport = 0x8003, kImported = 0x0003;
constexpr std::uint32_t kSubmit = 1, kUnlink = 2, kSubmitted = 3, kUnlinked = 4;
constexpr std::uint32_t kNotIsochronous = 0xffffffff;
constexpr std::size_t kBusIdBytes = 32, kBusNumberAt = 8 + 256 + 32;  // header, path, bus id

void put(std::vector<std::uint8_t>& bytes, std::uint32_t value, int size = 4) {
  for (int i = size - 1; i >= 0; --i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

std::uint32_t get(std::span<const std::uint8_t> bytes, std::size_t at, int size = 4) {
  std::uint32_t value = 0;
  for (int i = 0; i < size; ++i) value = value << 8 | bytes[at + static_cast<std::size_t>(i)];
  return value;
}

}  // namespace

std::vector<std::uint8_t> import_request(std::string_view bus_id) {
  std::vector<std::uint8_t> bytes;
  put(bytes, kUsbipVersion, 2);
  put(bytes, kImport, 2);
  put(bytes, 0);
  bytes.insert(bytes.end(), bus_id.begin(),
               bus_id.begin() + static_cast<std::ptrdiff_t>(std::min(bus_id.size(), kBusIdBytes - 1)));
  bytes.resize(8 + kBusIdBytes);
  return bytes;
}

std::optional<std::uint32_t> imported(std::span<const std::uint8_t> reply) {
  if (reply.size() < kImportReplyBytes || get(reply, 2, 2) != kImported || get(reply, 4) != 0) return std::nullopt;
  return get(reply, kBusNumberAt) << 16 | (get(reply, kBusNumberAt + 4) & 0xffff);
}

std::vector<std::uint8_t> submit_header(const Submit& submit) {
  std::vector<std::uint8_t> bytes;
  put(bytes, kSubmit);
  put(bytes, submit.sequence);
  put(bytes, submit.device);
  put(bytes, submit.in ? 1 : 0);
  put(bytes, submit.endpoint);
  put(bytes, 0);  // flags
  put(bytes, submit.length);
  put(bytes, 0);  // start frame
  put(bytes, kNotIsochronous);
  put(bytes, 0);  // interval
  if (submit.endpoint == 0) {
    bytes.push_back(submit.setup.request_type);
    bytes.push_back(submit.setup.request);
    for (const std::uint32_t word :
         {std::uint32_t{submit.setup.value}, std::uint32_t{submit.setup.index}, submit.length}) {
      bytes.push_back(static_cast<std::uint8_t>(word));
      bytes.push_back(static_cast<std::uint8_t>(word >> 8));
    }
  }
  bytes.resize(kHeaderBytes);
  return bytes;
}

std::vector<std::uint8_t> unlink_header(std::uint32_t sequence, std::uint32_t device, std::uint32_t unlinked) {
  std::vector<std::uint8_t> bytes;
  put(bytes, kUnlink);
  put(bytes, sequence);
  put(bytes, device);
  put(bytes, 0);
  put(bytes, 0);
  put(bytes, unlinked);
  bytes.resize(kHeaderBytes);
  return bytes;
}

std::optional<Answer> decode_answer(std::span<const std::uint8_t, kHeaderBytes> header) {
  const std::uint32_t command = get(header, 0);
  if (command != kSubmitted && command != kUnlinked) return std::nullopt;
  Answer answer;
  answer.unlink = command == kUnlinked;
  answer.sequence = get(header, 4);
  answer.status = static_cast<std::int32_t>(get(header, 20));
  if (answer.unlink) return answer;
  answer.length = get(header, 24);
  if (answer.length > kMaxBytes) return std::nullopt;
  return answer;
}

UsbStatus status_of(std::int32_t negative_errno) {
  switch (negative_errno) {
    case 0:
      return UsbStatus::done;
    case -EPIPE:
      return UsbStatus::stalled;
    case -ENODEV:
    case -ESHUTDOWN:
      return UsbStatus::gone;
    case -ECONNRESET:
    case -ENOENT:
      return UsbStatus::cancelled;
    default:
      return UsbStatus::failed;
  }
}

}  // namespace luxrig::usbip
