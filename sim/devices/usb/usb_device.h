#pragma once
/// A USB device as the host's controller sees it: control and bulk transfers. One model serves the simulated rig
/// (wire/usb/), a device emulated by umockdev, and one behind vhci_hcd in a guest's kernel.
///
/// Pure: the time comes in. A transfer begins once; the model returns its result and duration.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/time.h"
#include "sim/devices/dmx_fixture.h"

namespace luxrig::sim {

struct UsbControl {  ///< USB 2.0 table 9-2
  std::uint8_t request_type = 0, request = 0;
  std::uint16_t value = 0, index = 0, length = 0;
};
[[nodiscard]] UsbControl usb_control(std::span<const std::uint8_t, 8> setup);

struct UsbReply {
  enum class Kind {
    done,
    stall,
    wait,  ///< the device has no data yet (NAK): ask again
  };
  Kind kind = Kind::done;
  std::vector<std::uint8_t> data;  ///< to the host
  std::size_t taken = 0;           ///< bytes from the host
  Duration takes{};
};

struct UsbDescriptors {
  std::vector<std::uint8_t> device, configuration;
  std::vector<std::string> strings;  ///< [0] is string 1
  bool low_speed = false;
};

using UsbDmxLook = std::array<std::uint8_t, kDmxSlots>;  ///< address 1 first

class UsbDevice {
 public:
  virtual ~UsbDevice() = default;
  [[nodiscard]] virtual const UsbDescriptors& descriptors() const = 0;

  /// Answers standard requests here; the model answers the others. `out`: data from the host.
  UsbReply control(Time now, const UsbControl& setup, std::span<const std::uint8_t> out);
  /// `endpoint` with its direction bit.
  virtual UsbReply bulk_out(Time, int, std::span<const std::uint8_t>) { return {UsbReply::Kind::stall, {}, 0, {}}; }
  virtual UsbReply bulk_in(Time, int, std::size_t) { return {UsbReply::Kind::stall, {}, 0, {}}; }

  /// Connects devices that answer on its DMX line. A packet leaves at `now`, from its start code on; the function
  /// returns the answer, empty = silence. Has no effect on a device that cannot listen to its line.
  using LineAnswer = std::function<std::vector<std::uint8_t>(Time now, std::span<const std::uint8_t> packet)>;
  virtual void connect(LineAnswer) {}

  /// Plugged in: everything in volatile memory is lost.
  virtual void power_on(Time now) = 0;
  /// Present output on its DMX line; empty while it sends no packets.
  [[nodiscard]] virtual std::optional<UsbDmxLook> line(Time now) = 0;

 protected:
  virtual UsbReply vendor(Time now, const UsbControl& setup, std::span<const std::uint8_t> out) = 0;
};

/// USB 2.0 tables 9-8, 9-10, 9-12, 9-13. Endpoints: address and packet size of bulk endpoints.
struct UsbEndpointSize {
  std::uint8_t address = 0;
  std::uint16_t packet_bytes = 64;
};
[[nodiscard]] std::vector<std::uint8_t> usb_device_descriptor(std::uint16_t vendor, std::uint16_t product,
                                                              bool low_speed, bool has_serial);
[[nodiscard]] std::vector<std::uint8_t> usb_configuration_descriptor(std::span<const UsbEndpointSize> endpoints);

}  // namespace luxrig::sim
