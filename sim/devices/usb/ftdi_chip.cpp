#include "sim/devices/usb/ftdi_chip.h"

#include <algorithm>

namespace luxrig::sim {
namespace {

constexpr std::uint8_t kRequestReset = 0, kRequestModem = 1, kRequestFlow = 2, kRequestBaud = 3, kRequestFormat = 4,
                       kRequestModemStatus = 5, kRequestLatency = 9, kRequestGetLatency = 10;
constexpr std::uint16_t kBreak = 0x4000;
constexpr int kInEndpoint = 0x81, kOutEndpoint = 0x02;
constexpr std::size_t kPacket = 64, kStatus = 2, kTransmitBuffer = 256;
constexpr Duration kUsbFrame = std::chrono::milliseconds(1);
constexpr Duration kUsbPacket = std::chrono::microseconds(50);  // 64 bytes at 12 Mbit/s, before the chip receives them
constexpr Duration kDefaultLatency = std::chrono::milliseconds(16);
constexpr double kClock_hz = 3e6;

UsbReply stall() { return {UsbReply::Kind::stall, {}, 0, kUsbFrame}; }

}  // namespace

FtdiChip::FtdiChip(SerialPeer& peer, std::string product, std::string serial, bool paced)
    : peer_(peer), paced_(paced), latency_(kDefaultLatency) {
  constexpr UsbEndpointSize kEndpoints[] = {{kInEndpoint, kPacket}, {kOutEndpoint, kPacket}};
  descriptors_.device = usb_device_descriptor(0x0403, 0x6001, false, true);
  descriptors_.configuration = usb_configuration_descriptor(kEndpoints);
  descriptors_.strings = {"FTDI", std::move(product), std::move(serial)};
}

void FtdiChip::power_on(Time now) {
  settings_ = {};
  latency_ = kDefaultLatency;
  busy_until_ = last_in_ = now;
  peer_.power_on(now);
}

UsbReply FtdiChip::vendor(Time now, const UsbControl& setup, std::span<const std::uint8_t>) {
  UsbReply reply;
  reply.takes = kUsbFrame;
  if ((setup.request_type & 0x80) != 0) {
    if (setup.request == kRequestModemStatus) {
      const auto bytes = status(now);
      reply.data.assign(bytes.begin(), bytes.end());
    } else if (setup.request == kRequestGetLatency) {
      reply.data = {static_cast<std::uint8_t>(latency_ / std::chrono::milliseconds(1))};
    } else {
      return stall();
    }
    reply.data.resize(std::min<std::size_t>(reply.data.size(), setup.length));
    return reply;
  }
  switch (setup.request) {
    case kRequestReset:
      if (setup.value > 2) return stall();
      if (setup.value == 0) {
        settings_.format = 0;
        latency_ = kDefaultLatency;
      }
      if (setup.value != 1) busy_until_ = std::min(busy_until_, now);
      if (setup.value != 2) (void)peer_.take(now, kTransmitBuffer);
      return reply;
    case kRequestModem:
      if ((setup.value & 0x0200) != 0) settings_.rts_low = (setup.value & 0x0002) == 0;
      return reply;
    case kRequestFlow:
      return reply;
    case kRequestBaud:
      settings_.divisor = setup.value;
      return reply;
    case kRequestFormat: {
      const bool was = (settings_.format & kBreak) != 0, is = (setup.value & kBreak) != 0;
      settings_.format = setup.value;
      // A request takes effect at the end of the frame, so a break is never shorter than a frame.
      if (was != is) peer_.set_break(now + kUsbFrame, is);
      return reply;
    }
    case kRequestLatency:
      if (setup.value < 1 || setup.value > 255) return stall();
      latency_ = std::chrono::milliseconds(setup.value);
      return reply;
    default:
      return stall();
  }
}

Duration FtdiChip::slot_time() const {
  if (!paced_ || settings_.divisor == 0) return {};
  // Start bit, data, stop bits.
  const int bits = 1 + (settings_.format & 0xff) + ((settings_.format & 0x1000) != 0 ? 2 : 1);
  return from_seconds(bits * (settings_.divisor & 0x3fff) / kClock_hz);
}

std::array<std::uint8_t, 2> FtdiChip::status(Time now) const {
  const std::uint8_t transmitter = now >= busy_until_ ? 0x60 : 0;  // holding register and shift register empty
  return {0x01, transmitter};
}

UsbReply FtdiChip::bulk_out(Time now, int endpoint, std::span<const std::uint8_t> data) {
  if (endpoint != kOutEndpoint) return stall();
  const Duration slot = slot_time();
  const Time start = std::max(now + kUsbPacket, busy_until_);
  peer_.receive(start, slot, settings_, data);
  busy_until_ = start + slot * static_cast<std::int64_t>(data.size());
  UsbReply reply;
  reply.taken = data.size();
  // The host's last byte is accepted once there is room for it.
  reply.takes = std::max(Duration{}, busy_until_ - slot * static_cast<std::int64_t>(kTransmitBuffer) - now);
  return reply;
}

UsbReply FtdiChip::bulk_in(Time now, int endpoint, std::size_t length) {
  if (endpoint != kInEndpoint || length < kPacket) return stall();
  UsbReply reply;
  const std::size_t room = length / kPacket * (kPacket - kStatus);
  const std::vector<std::uint8_t> bytes = peer_.take(now, room);
  if (bytes.empty() && now - last_in_ < latency_) return {UsbReply::Kind::wait, {}, 0, {}};
  last_in_ = now;
  const auto two = status(now);
  std::size_t at = 0;
  do {
    const std::size_t part = std::min(kPacket - kStatus, bytes.size() - at);
    reply.data.insert(reply.data.end(), two.begin(), two.end());
    reply.data.insert(reply.data.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at),
                      bytes.begin() + static_cast<std::ptrdiff_t>(at + part));
    at += part;
  } while (at < bytes.size());
  return reply;
}

}  // namespace luxrig::sim
