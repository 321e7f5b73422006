#pragma once
/// The real USB channel: libusb-1.0 over usbfs.

#include <memory>

#include "drivers/usb/usb_channel.h"
#include "drivers/usb/usb_search.h"

namespace luxrig {

/// Each attempt to open scans the bus with a fresh libusb context: without udevd (containers, small images) an old one
/// never hears of a device that was plugged in later, and registering for hot-plug succeeds all the same.
[[nodiscard]] std::unique_ptr<UsbChannel> make_libusb_channel(UsbSearch search);

}  // namespace luxrig
