#pragma once
/// FTDI FT232R: vendor requests, two bulk endpoints, and the device on its serial side.
/// Source: requests as in Linux' ftdi_sio and FTDI's notes. A control transfer takes a USB frame (1 ms). Bulk OUT data
/// waits while the transmit buffer of 256 bytes is full. Bulk IN data comes when there is some or the latency timer has
/// expired, always after two status bytes.

#include <deque>

#include "sim/devices/usb/usb_device.h"

namespace luxrig::sim {

/// The serial side.
class SerialPeer {
 public:
  virtual ~SerialPeer() = default;
  virtual void power_on(Time) {}
  /// The chip begins to send the bytes at `start` and needs `slot` for each. `settings`: FTDI data format and divisor.
  struct LineSettings {
    std::uint16_t format = 0, divisor = 0;
    bool rts_low = false;
  };
  virtual void receive(Time start, Duration slot, const LineSettings& settings,
                       std::span<const std::uint8_t> bytes) = 0;
  virtual void set_break(Time, bool) {}
  /// Takes its output bytes, at most that many.
  virtual std::vector<std::uint8_t> take(Time, std::size_t) { return {}; }
  [[nodiscard]] virtual std::optional<UsbDmxLook> line(Time now) = 0;
};

class FtdiChip final : public UsbDevice {
 public:
  /// The peer outlives it. `paced`: bytes leave at the line's rate; false if the chip's other side is a parallel bus
  /// (FT245, as in the ENTTEC Pro).
  FtdiChip(SerialPeer& peer, std::string product, std::string serial, bool paced);

  [[nodiscard]] const UsbDescriptors& descriptors() const override { return descriptors_; }
  UsbReply bulk_out(Time now, int endpoint, std::span<const std::uint8_t> data) override;
  UsbReply bulk_in(Time now, int endpoint, std::size_t length) override;
  void power_on(Time now) override;
  [[nodiscard]] std::optional<UsbDmxLook> line(Time now) override { return peer_.line(now); }

  [[nodiscard]] bool is_sending(Time now) const { return now < busy_until_; }
  [[nodiscard]] const SerialPeer::LineSettings& settings() const { return settings_; }
  [[nodiscard]] Duration latency() const { return latency_; }

 private:
  UsbReply vendor(Time now, const UsbControl& setup, std::span<const std::uint8_t> out) override;
  [[nodiscard]] Duration slot_time() const;
  [[nodiscard]] std::array<std::uint8_t, 2> status(Time now) const;

  SerialPeer& peer_;
  bool paced_;
  UsbDescriptors descriptors_;
  SerialPeer::LineSettings settings_;
  Duration latency_{};
  Time busy_until_{}, last_in_{};
};

}  // namespace luxrig::sim
