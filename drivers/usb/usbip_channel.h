#pragma once
/// The USB channel to a stand-in: a device behind a USB/IP server on a TCP port; luxrig-sim has one for each USB bus.
/// The connection acts as the cable: closed = unplugged.

#include <memory>

#include "drivers/registry.h"
#include "drivers/usb/usb_channel.h"

namespace luxrig {

[[nodiscard]] std::unique_ptr<UsbChannel> make_usbip_channel(Redirect server);

}  // namespace luxrig
