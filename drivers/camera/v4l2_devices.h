#pragma once
/// Video4Linux capture devices of this machine.

#include <filesystem>
#include <string>
#include <vector>

#include "core/result.h"

namespace luxrig {

struct V4l2Device {
  std::string path;    ///< "/dev/video0"
  std::string name;    ///< "HD Webcam"; what the device calls itself
  std::string bus;     ///< "usb-0000:00:14.0-2"
  std::string serial;  ///< of the USB device behind; may be empty
  bool busy = false;   ///< it could not be asked: in use, or no permission; its name is the system's
};

/// By path. Devices that only give metadata, radio or video out are left out.
[[nodiscard]] std::vector<V4l2Device> v4l2_devices(const std::filesystem::path& root = "/");

/// The one that `wanted` names, by path, bus, serial number or name (the only one when empty); else a reason that names
/// what there is.
[[nodiscard]] Result<V4l2Device> choose_device(const std::vector<V4l2Device>& devices, const std::string& wanted);

}  // namespace luxrig
