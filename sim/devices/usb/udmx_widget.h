#pragma once
/// A uDMX of anyma: a microcontroller with low-speed USB in software, and DMX.
/// Source: anyma's uDMX_cmds.h and the known behaviour of its firmware. It sends nothing before the first data, then
/// for ever packets that end with the highest slot ever set. It refuses a range out of bounds.

#include "sim/devices/usb/usb_device.h"

namespace luxrig::sim {

class UdmxWidget final : public UsbDevice {
 public:
  explicit UdmxWidget(std::string manufacturer = "www.anyma.ch", std::string product = "uDMX");

  [[nodiscard]] const UsbDescriptors& descriptors() const override { return descriptors_; }
  void power_on(Time now) override;
  [[nodiscard]] std::optional<UsbDmxLook> line(Time) override {
    return slots_ > 0 ? std::optional(look_) : std::nullopt;
  }

  [[nodiscard]] std::size_t slots_put_out() const { return slots_; }
  [[nodiscard]] std::uint64_t transfers() const { return transfers_; }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

 private:
  UsbReply vendor(Time now, const UsbControl& setup, std::span<const std::uint8_t> out) override;

  UsbDescriptors descriptors_;
  UsbDmxLook look_{};
  std::size_t slots_ = 0;
  std::uint64_t transfers_ = 0, bytes_ = 0;
};

}  // namespace luxrig::sim
