#include "sim/wire/usb/usbip_session.h"

#include <algorithm>
#include <string_view>

#include "sim/wire/bytes.h"

namespace luxrig::sim {
namespace {

constexpr int kVersion = 0x0111;
constexpr int kOpListRequest = 0x8005, kOpListReply = 0x0005, kOpImportRequest = 0x8003, kOpImportReply = 0x0003;
constexpr std::size_t kOpHeader = 8, kBusIdField = 32, kPathField = 256, kUrbHeader = 48;
constexpr std::uint32_t kCmdSubmit = 1, kCmdUnlink = 2, kRetSubmit = 3, kRetUnlink = 4;
constexpr std::string_view kBusId = "1-1", kPath = "/sys/devices/luxrig-sim/usb1/1-1";
constexpr std::uint32_t kBusNumber = 1, kDeviceNumber = 2, kLowSpeed = 1, kFullSpeed = 2;
// As in errno on Linux, where the protocol comes from.
constexpr std::int32_t kBrokenPipe = -32, kConnectionReset = -104;
constexpr std::size_t kMaxUrbBytes = 4096, kMaxUrbs = 64, kMaxSaidBytes = 1 << 20;

void append_32(std::vector<std::uint8_t>& bytes, std::uint32_t value) {
  append_big_endian_16(bytes, static_cast<int>(value >> 16));
  append_big_endian_16(bytes, static_cast<int>(value & 0xffff));
}

void append_text(std::vector<std::uint8_t>& bytes, std::string_view text, std::size_t field) {
  const std::size_t end = bytes.size() + field;
  bytes.insert(bytes.end(), text.begin(), text.end());
  bytes.resize(end);
}

}  // namespace

UsbipSession::UsbipSession(UsbDevice& device, Beginning beginning, FaultOf fault)
    : device_(device), fault_(std::move(fault)), attached_(beginning == Beginning::attached) {}

void UsbipSession::receive(Time now, std::span<const std::uint8_t> bytes) {
  if (broken_) return;
  heard_.insert(heard_.end(), bytes.begin(), bytes.end());
  while (!broken_ && (attached_ ? take_command() : take_operation())) {
  }
  serve(now);
}

std::vector<std::uint8_t> UsbipSession::take_output() { return std::exchange(said_, {}); }

void UsbipSession::put_device(std::vector<std::uint8_t>& into) const {
  const UsbDescriptors& all = device_.descriptors();
  append_text(into, kPath, kPathField);
  append_text(into, kBusId, kBusIdField);
  append_32(into, kBusNumber);
  append_32(into, kDeviceNumber);
  append_32(into, all.low_speed ? kLowSpeed : kFullSpeed);
  for (const std::size_t at : {8, 10, 12}) append_big_endian_16(into, little_endian_16(all.device, at));
  into.insert(into.end(), {all.device[4], all.device[5], all.device[6], 1, all.device[17], all.configuration[4]});
}

bool UsbipSession::take_operation() {
  if (heard_.size() < kOpHeader) return false;
  const int code = big_endian_16(heard_, 2);
  if (big_endian_16(heard_, 0) != kVersion || (code != kOpListRequest && code != kOpImportRequest)) {
    broken_ = true;
    return false;
  }
  const std::size_t size = kOpHeader + (code == kOpImportRequest ? kBusIdField : 0);
  if (heard_.size() < size) return false;
  append_big_endian_16(said_, kVersion);
  if (code == kOpListRequest) {
    append_big_endian_16(said_, kOpListReply);
    append_32(said_, 0);
    append_32(said_, 1);  // devices
    put_device(said_);
    said_.insert(said_.end(), {0xff, 0xff, 0xff, 0});  // its interface: vendor class
  } else {
    std::string wanted(heard_.begin() + kOpHeader, heard_.begin() + kOpHeader + kBusIdField);
    wanted.resize(std::min(wanted.find('\0'), wanted.size()));
    attached_ = wanted == kBusId;
    append_big_endian_16(said_, kOpImportReply);
    append_32(said_, attached_ ? 0 : 1);
    if (attached_) put_device(said_);
  }
  heard_.erase(heard_.begin(), heard_.begin() + static_cast<std::ptrdiff_t>(size));
  return true;
}

bool UsbipSession::take_command() {
  if (heard_.size() < kUrbHeader) return false;
  const std::uint32_t command = big_endian_32(heard_, 0);
  Urb urb;
  urb.sequence = big_endian_32(heard_, 4);
  std::size_t size = kUrbHeader;
  if (command == kCmdUnlink) {
    unlink(urb.sequence, big_endian_32(heard_, 20));
  } else if (command == kCmdSubmit) {
    urb.in = big_endian_32(heard_, 12) != 0;
    const std::uint32_t endpoint = big_endian_32(heard_, 16);
    urb.length = big_endian_32(heard_, 24);
    std::size_t waiting = 0;
    for (const auto& [address, queue] : queues_) waiting += queue.size();
    if (endpoint > 15 || urb.length > kMaxUrbBytes || waiting >= kMaxUrbs) {
      broken_ = true;
      return false;
    }
    urb.endpoint = static_cast<int>(endpoint) | (urb.in && endpoint != 0 ? 0x80 : 0);
    if (!urb.in) size += urb.length;
    if (heard_.size() < size) return false;
    urb.setup = usb_control(std::span<const std::uint8_t, 8>(heard_.data() + 40, 8));
    urb.out.assign(heard_.begin() + kUrbHeader, heard_.begin() + static_cast<std::ptrdiff_t>(size));
    queues_[urb.endpoint].push_back(std::move(urb));
  } else {
    broken_ = true;
    return false;
  }
  heard_.erase(heard_.begin(), heard_.begin() + static_cast<std::ptrdiff_t>(size));
  return true;
}

void UsbipSession::serve(Time now) {
  for (auto& [address, queue] : queues_) {
    while (!queue.empty() && !broken_) {
      Urb& urb = queue.front();
      if (!urb.reply) begin(now, urb);
      if (!urb.reply || urb.due > now) break;
      answer(urb);
      queue.pop_front();
    }
  }
}

void UsbipSession::begin(Time now, Urb& urb) {
  if (!urb.disturbance) urb.disturbance = fault_ ? fault_() : Disturbance{};
  const Disturbance& wrong = *urb.disturbance;
  if (wrong.silent) return;
  UsbReply reply;
  const bool is_control = urb.endpoint == 0;
  if (wrong.exception || (wrong.garbled && is_control)) {
    reply.kind = UsbReply::Kind::stall;
  } else if (is_control) {
    reply = device_.control(now, urb.setup, urb.out);
  } else if (urb.in) {
    reply = device_.bulk_in(now, urb.endpoint, urb.length);
  } else {
    reply = device_.bulk_out(now, urb.endpoint, urb.out);
  }
  if (reply.kind == UsbReply::Kind::wait) return;
  reply.data.resize(std::min(reply.data.size(), urb.length));
  // The first two bytes of these devices' data are the chip's own status.
  if (wrong.garbled && reply.data.size() > 2) reply.data[2 + wrong.random % (reply.data.size() - 2)] ^= 0xff;
  ++begun_;
  urb.due = now + reply.takes + wrong.delay;
  urb.reply = std::move(reply);
}

void UsbipSession::answer(const Urb& urb) {
  const UsbReply& reply = *urb.reply;
  const bool good = reply.kind == UsbReply::Kind::done;
  const std::size_t start = said_.size();
  const std::size_t actual = !good ? 0 : urb.in ? reply.data.size() : std::min(reply.taken, urb.length);
  append_32(said_, kRetSubmit);
  append_32(said_, urb.sequence);
  for (int i = 0; i < 3; ++i) append_32(said_, 0);  // device, direction, endpoint: zero in an answer
  append_32(said_, static_cast<std::uint32_t>(good ? 0 : kBrokenPipe));
  append_32(said_, static_cast<std::uint32_t>(actual));
  append_32(said_, 0);
  append_32(said_, 0xffffffff);  // not isochronous
  said_.resize(start + kUrbHeader);
  if (urb.in && good) said_.insert(said_.end(), reply.data.begin(), reply.data.end());
  if (said_.size() > kMaxSaidBytes) broken_ = true;
}

void UsbipSession::unlink(std::uint32_t sequence, std::uint32_t unlinked) {
  bool found = false;
  for (auto& [address, queue] : queues_) {
    found = std::erase_if(queue, [&](const Urb& urb) { return urb.sequence == unlinked; }) > 0 || found;
  }
  const std::size_t start = said_.size();
  append_32(said_, kRetUnlink);
  append_32(said_, sequence);
  for (int i = 0; i < 3; ++i) append_32(said_, 0);
  append_32(said_, static_cast<std::uint32_t>(found ? kConnectionReset : 0));
  said_.resize(start + kUrbHeader);
  if (said_.size() > kMaxSaidBytes) broken_ = true;
}

}  // namespace luxrig::sim
