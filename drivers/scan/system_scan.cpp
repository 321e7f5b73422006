/// Devices that the operating system lists: USB widgets, serial ports and CAN interfaces.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>

#include "drivers/scan/scan.h"

namespace luxrig {
namespace {

namespace fs = std::filesystem;

constexpr int kCanLink = 280;  ///< ARPHRD_CAN of linux/if_arp.h

/// The first line of a small sysfs file; empty if there is none.
std::string first_line(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    entries.push_back(it->path());
  std::sort(entries.begin(), entries.end());
  return entries;
}

/// The value in a sysfs folder or its nearest parent that has it. For a USB interface that is the device's value.
std::string value_above(fs::path folder, const fs::path& root, const char* name) {
  for (int level = 0; level < 8 && folder != root && folder.has_relative_path(); ++level, folder = folder.parent_path())
    if (std::string value = first_line(folder / name); !value.empty()) return value;
  return {};
}

class SerialScan final : public Scan {
 public:
  explicit SerialScan(std::string root) : root_(std::move(root)) {}

  Result<void> step(Time) override {
    std::error_code error;
    std::map<fs::path, fs::path> lasting;  // by the link's target
    for (const fs::path& link : entries_of(root_ / "dev/serial/by-id")) {
      const fs::path target = fs::weakly_canonical(link, error);
      if (!error) lasting[target.filename()] = fs::path("/dev/serial/by-id") / link.filename();
    }
    found_.clear();
    for (const fs::path& tty : entries_of(root_ / "sys/class/tty")) {
      // Consoles have no device. Unwired ports of the board have one, but no chip (type 0).
      const fs::path device = fs::weakly_canonical(tty / "device", error);
      if (error || !fs::exists(tty / "device", error) || first_line(tty / "type") == "0") continue;
      const std::string product = value_above(device, root_ / "sys", "product");
      const std::string maker = value_above(device, root_ / "sys", "manufacturer");
      const std::string serial = value_above(device, root_ / "sys", "serial");
      FoundDevice found;
      found.driver = "modbus_rtu";
      const auto by_id = lasting.find(tty.filename());
      found.address = by_id != lasting.end() ? by_id->second.string() : "/dev/" + tty.filename().string();
      found.name = maker.empty() || product.empty() ? maker + product : maker + " " + product;
      found.detail = tty.filename().string();
      if (!serial.empty()) found.detail += ", serial number " + serial;
      found_.push_back(std::move(found));
    }
    return {};
  }
  std::vector<FoundDevice> found() const override { return found_; }

 private:
  fs::path root_;
  std::vector<FoundDevice> found_;
};

struct KnownWidget {
  const char *vendor, *product, *driver;
};
// Sources: drivers/dmx/enttec_pro, open_dmx and udmx.
constexpr KnownWidget kWidgets[] = {
    {"0403", "6001", "enttec_pro or open_dmx"},
    {"0403", "6010", "open_dmx"},
    {"0403", "6011", "open_dmx"},
    {"16c0", "05dc", "udmx"},
    {"03eb", "8888", "udmx"},
};

class UsbScan final : public Scan {
 public:
  explicit UsbScan(std::string root) : root_(std::move(root)) {}

  Result<void> step(Time) override {
    found_.clear();
    for (const fs::path& device : entries_of(root_ / "sys/bus/usb/devices")) {
      const std::string vendor = first_line(device / "idVendor"), product = first_line(device / "idProduct");
      for (const KnownWidget& known : kWidgets) {
        if (vendor != known.vendor || product != known.product) continue;
        const std::string maker = first_line(device / "manufacturer"), name = first_line(device / "product");
        const std::string serial = first_line(device / "serial");
        found_.push_back({known.driver, device.filename().string(),
                          maker.empty() || name.empty() ? maker + name : maker + " " + name,
                          vendor + ":" + product + (serial.empty() ? "" : ", serial number " + serial)});
      }
    }
    return {};
  }
  std::vector<FoundDevice> found() const override { return found_; }

 private:
  fs::path root_;
  std::vector<FoundDevice> found_;
};

class CanScan final : public Scan {
 public:
  explicit CanScan(std::string root) : root_(std::move(root)) {}

  Result<void> step(Time) override {
    found_.clear();
    for (const fs::path& link : entries_of(root_ / "sys/class/net")) {
      if (first_line(link / "type") != std::to_string(kCanLink)) continue;
      const std::string state = first_line(link / "operstate");
      found_.push_back({"canopen", link.filename().string(), first_line(link / "ifalias"),
                        state == "down" ? "down: ip link set " + link.filename().string() + " up" : state});
    }
    return {};
  }
  std::vector<FoundDevice> found() const override { return found_; }

 private:
  fs::path root_;
  std::vector<FoundDevice> found_;
};

}  // namespace

std::unique_ptr<Scan> make_serial_scan(const ScanOptions& options) {
  return std::make_unique<SerialScan>(options.root);
}
std::unique_ptr<Scan> make_usb_scan(const ScanOptions& options) { return std::make_unique<UsbScan>(options.root); }
std::unique_ptr<Scan> make_can_scan(const ScanOptions& options) { return std::make_unique<CanScan>(options.root); }

}  // namespace luxrig
