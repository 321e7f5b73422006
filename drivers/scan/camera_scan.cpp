#include "drivers/camera/v4l2_devices.h"
#include "drivers/scan/scan.h"

namespace luxrig {
namespace {

class CameraScan final : public Scan {
 public:
  explicit CameraScan(std::string root) : root_(std::move(root)) {}

  Result<void> step(Time) override {
    if (looked_) return {};  // a query opens each device, so query once only
    looked_ = true;
    for (const V4l2Device& device : v4l2_devices(root_)) {
      std::string detail = device.bus;
      if (!device.serial.empty()) detail += (detail.empty() ? "" : ", ") + ("serial number " + device.serial);
      if (device.busy) detail += std::string(detail.empty() ? "" : ", ") + "cannot be asked: in use, or no permission";
      found_.push_back({"v4l2", device.path, device.name, detail});
    }
    return {};
  }
  std::vector<FoundDevice> found() const override { return found_; }

 private:
  std::string root_;
  std::vector<FoundDevice> found_;
  bool looked_ = false;
};

}  // namespace

std::unique_ptr<Scan> make_camera_scan(const ScanOptions& options) {
  return std::make_unique<CameraScan>(options.root);
}

}  // namespace luxrig
