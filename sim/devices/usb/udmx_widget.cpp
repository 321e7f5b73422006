#include "sim/devices/usb/udmx_widget.h"

#include <algorithm>

namespace luxrig::sim {
namespace {

constexpr std::uint8_t kSingleChannel = 1, kChannelRange = 2;
/// Low speed carries 8 bytes a packet, and the firmware delays the host: a universe takes 33 ms.
constexpr std::size_t kLowSpeedPacket = 8;
constexpr Duration kSetupTakes = std::chrono::milliseconds(1), kPacketTakes = std::chrono::microseconds(500);

}  // namespace

UdmxWidget::UdmxWidget(std::string manufacturer, std::string product) {
  descriptors_.device = usb_device_descriptor(0x16c0, 0x05dc, true, false);
  descriptors_.configuration = usb_configuration_descriptor({});
  descriptors_.strings = {std::move(manufacturer), std::move(product)};
  descriptors_.low_speed = true;
}

void UdmxWidget::power_on(Time) {
  look_.fill(0);
  slots_ = 0;
}

UsbReply UdmxWidget::vendor(Time, const UsbControl& setup, std::span<const std::uint8_t> out) {
  UsbReply reply;
  reply.takes = kSetupTakes;
  if (setup.request == kSingleChannel && setup.index < kDmxSlots && setup.value <= 255) {
    look_[setup.index] = static_cast<std::uint8_t>(setup.value);
    slots_ = std::max<std::size_t>(slots_, setup.index + 1u);
  } else if (setup.request == kChannelRange && setup.value >= 1 && setup.index + setup.value <= kDmxSlots &&
             out.size() >= setup.value) {
    std::copy_n(out.begin(), setup.value, look_.begin() + setup.index);
    slots_ = std::max<std::size_t>(slots_, static_cast<std::size_t>(setup.index + setup.value));
    reply.taken = out.size();
    reply.takes += kPacketTakes * static_cast<std::int64_t>((out.size() + kLowSpeedPacket - 1) / kLowSpeedPacket);
  } else {
    reply.kind = UsbReply::Kind::stall;
    return reply;
  }
  ++transfers_;
  bytes_ += out.size();
  return reply;
}

}  // namespace luxrig::sim
