#pragma once
/// Video4Linux capture devices of this machine.

#include <filesystem>
#include <string>
#include <vector>

#include "core/result.h"

namespace luxrig {

struct V4l2Device {
  std::string path;    ///< "/dev/video0"
  std::string name;    ///< "HD Webcam"; the device's own name
  std::string bus;     ///< "usb-0000:00:14.0-2"
  std::string serial;  ///< of the USB device; may be empty
  bool busy = false;   ///< it could not be queried (in use, or no permission); its name is the system's
};

/// Sorted by path. Devices that give only metadata, radio or video output are left out.
[[nodiscard]] std::vector<V4l2Device> v4l2_devices(const std::filesystem::path& root = "/");

/// The device that `wanted` identifies by path, bus, serial number or name (if empty, the only device). Otherwise a
/// fault that lists the devices present.
[[nodiscard]] Result<V4l2Device> choose_device(const std::vector<V4l2Device>& devices, const std::string& wanted);

}  // namespace luxrig
