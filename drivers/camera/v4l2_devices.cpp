#include "drivers/camera/v4l2_devices.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>

namespace luxrig {
namespace {

namespace fs = std::filesystem;

std::string line_of(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

/// Serial number of the device or of the device it is plugged into.
std::string serial_above(fs::path folder, const fs::path& root) {
  for (int level = 0; level < 6 && folder != root && folder.has_relative_path(); ++level, folder = folder.parent_path())
    if (std::string serial = line_of(folder / "serial"); !serial.empty()) return serial;
  return {};
}

/// A C string that may lack its terminator.
template <std::size_t N>
std::string text_in(const unsigned char (&bytes)[N]) {
  return {reinterpret_cast<const char*>(bytes), ::strnlen(reinterpret_cast<const char*>(bytes), N)};
}

/// False for a device that gives no pictures.
bool ask_device(const fs::path& path, V4l2Device& device) {
  const int fd = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) {
    device.busy = true;
    return errno != ENOENT && errno != ENODEV && errno != ENXIO;
  }
  v4l2_capability capability{};
  const bool answers = ::ioctl(fd, VIDIOC_QUERYCAP, &capability) == 0;
  ::close(fd);
  if (!answers) return false;
  const auto can =
      (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? capability.device_caps : capability.capabilities;
  device.name = text_in(capability.card);
  device.bus = text_in(capability.bus_info);
  return (can & V4L2_CAP_VIDEO_CAPTURE) != 0 && (can & V4L2_CAP_STREAMING) != 0;
}

std::string names_of(const std::vector<V4l2Device>& devices) {
  std::string names;
  for (const V4l2Device& device : devices)
    names += fmt::format("{}{} ({} at {})", names.empty() ? "" : ", ", device.path, device.name, device.bus);
  return names;
}

/// Numeric order: video10 after video9.
bool before(const std::string& a, const std::string& b) { return a.size() != b.size() ? a.size() < b.size() : a < b; }

}  // namespace

std::vector<V4l2Device> v4l2_devices(const fs::path& root) {
  std::vector<V4l2Device> devices;
  std::error_code error;
  for (fs::directory_iterator it(root / "sys/class/video4linux", error), end; !error && it != end;
       it.increment(error)) {
    const std::string node = it->path().filename().string();
    if (!node.starts_with("video")) continue;
    V4l2Device device;
    device.path = "/dev/" + node;
    device.name = line_of(it->path() / "name");
    std::error_code no_device;
    const fs::path behind = fs::weakly_canonical(it->path() / "device", no_device);
    if (!no_device) device.serial = serial_above(behind, root / "sys");
    if (ask_device(root / "dev" / node, device)) devices.push_back(std::move(device));
  }
  std::sort(devices.begin(), devices.end(),
            [](const V4l2Device& a, const V4l2Device& b) { return before(a.path, b.path); });
  return devices;
}

Result<V4l2Device> choose_device(const std::vector<V4l2Device>& devices, const std::string& wanted) {
  const auto none = [&](std::string what) { return tl::unexpected(Fault{Cause::network, {}, std::move(what), {}}); };
  if (devices.empty()) return none("no camera is there: plug it in (luxrig devices lists cameras)");
  std::vector<V4l2Device> fit;
  for (const V4l2Device& device : devices)
    if (wanted.empty() || wanted == device.path || wanted == device.bus || wanted == device.serial ||
        wanted == device.name)
      fit.push_back(device);
  if (fit.size() == 1) return fit.front();
  if (fit.empty())
    return none(fmt::format("no camera \"{}\" is there but {}: plug it in, or write device by one of these", wanted,
                            names_of(devices)));
  return none(
      fmt::format("{} cameras fit, {}: write device by a path, a bus or a serial number", fit.size(), names_of(fit)));
}

}  // namespace luxrig
