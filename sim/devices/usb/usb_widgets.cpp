#include "sim/devices/usb/usb_widgets.h"

#include "sim/devices/usb/dmx_line.h"
#include "sim/devices/usb/enttec_widget.h"
#include "sim/devices/usb/udmx_widget.h"

namespace luxrig::sim {
namespace {

/// An FTDI chip that owns the device on its serial side.
template <class Peer>
class ChipWithPeer final : public UsbDevice {
 public:
  ChipWithPeer(const char* product, const char* serial, bool paced) : chip_(peer_, product, serial, paced) {}
  [[nodiscard]] const UsbDescriptors& descriptors() const override { return chip_.descriptors(); }
  UsbReply bulk_out(Time now, int endpoint, std::span<const std::uint8_t> data) override {
    return chip_.bulk_out(now, endpoint, data);
  }
  UsbReply bulk_in(Time now, int endpoint, std::size_t length) override { return chip_.bulk_in(now, endpoint, length); }
  void power_on(Time now) override { chip_.power_on(now); }
  void connect(LineAnswer answer) override {
    if constexpr (requires { peer_.connect(answer); }) peer_.connect(std::move(answer));
  }
  [[nodiscard]] std::optional<UsbDmxLook> line(Time now) override { return chip_.line(now); }

 private:
  UsbReply vendor(Time now, const UsbControl& setup, std::span<const std::uint8_t> out) override {
    return chip_.control(now, setup, out);
  }

  Peer peer_;
  FtdiChip chip_;
};

}  // namespace

std::unique_ptr<UsbDevice> make_usb_widget(std::string_view driver) {
  if (driver == "enttec_pro") return std::make_unique<ChipWithPeer<EnttecWidget>>("DMX USB PRO", "EN012345", false);
  if (driver == "open_dmx") return std::make_unique<ChipWithPeer<DmxLine>>("FT232R USB UART", "A6008isP", true);
  if (driver == "udmx") return std::make_unique<UdmxWidget>();
  return nullptr;
}

}  // namespace luxrig::sim
