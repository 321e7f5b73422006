#pragma once
/// The simulated USB widgets, by the name of the driver that they are for.

#include <memory>
#include <string_view>

#include "sim/devices/usb/usb_device.h"

namespace luxrig::sim {

/// A device together with what hangs on it. Nothing for a driver without one. Named: enttec_pro, open_dmx, udmx.
[[nodiscard]] std::unique_ptr<UsbDevice> make_usb_widget(std::string_view driver);

}  // namespace luxrig::sim
