#pragma once
/// The real USB channel: libusb-1.0 over usbfs.

#include <memory>

#include "drivers/usb/usb_channel.h"
#include "drivers/usb/usb_search.h"

namespace luxrig {

/// Each attempt to open scans the bus with a fresh libusb context. Without udevd (containers, small images) an old
/// context never hears of a device plugged in later, although registering for hot-plug succeeds.
[[nodiscard]] std::unique_ptr<UsbChannel> make_libusb_channel(UsbSearch search);

}  // namespace luxrig
