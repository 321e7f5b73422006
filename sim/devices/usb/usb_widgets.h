#pragma once
/// The simulated USB widgets, by the name of their driver.

#include <memory>
#include <string_view>

#include "sim/devices/usb/usb_device.h"

namespace luxrig::sim {

/// A device with everything behind it; null for a driver without one. Drivers: enttec_pro, open_dmx, udmx.
[[nodiscard]] std::unique_ptr<UsbDevice> make_usb_widget(std::string_view driver);

}  // namespace luxrig::sim
