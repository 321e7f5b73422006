#pragma once
/// Finds devices that could be driven, without a rig file. Each way to look is a Scan, one line in scans.cpp's table.
/// Looking moves no light: it polls nodes for their identity, listens to sources and reads the system's lists.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "core/time.h"

namespace luxrig {

struct FoundDevice {
  std::string driver;   ///< registry name of the driver that would use it
  std::string address;  ///< as written in the rig file's option: "10.0.0.7", "/dev/ttyUSB0", "can0"
  std::string name;     ///< the device's own name; may be empty
  std::string detail;   ///< for a person: universes, serial number, state
};

class Scan {
 public:
  virtual ~Scan() = default;
  /// Begins or continues; never blocks. A fault if this way to look is unavailable here; others may still work.
  virtual Result<void> step(Time now) = 0;
  /// Devices found so far, in the order of addresses.
  [[nodiscard]] virtual std::vector<FoundDevice> found() const = 0;
};

struct ScanOptions {
  std::string broadcast = "255.255.255.255";  ///< address for Art-Net polls
  std::string interface;                      ///< to listen for sACN sources; empty = the system chooses
  std::string root = "/";                     ///< folder that contains dev and sys
};

struct NamedScan {
  std::string what;  ///< "Art-Net nodes"
  std::unique_ptr<Scan> scan;
  /// Time until it has seen everything; 0 = the first step is enough.
  Duration complete_after{};
};

[[nodiscard]] std::vector<NamedScan> all_scans(const ScanOptions& options);

// The ways to look.
[[nodiscard]] std::unique_ptr<Scan> make_artnet_scan(const ScanOptions& options);
[[nodiscard]] std::unique_ptr<Scan> make_sacn_scan(const ScanOptions& options);
/// Serial ports of a USB or on-board adapter, by their persistent names if they have one.
[[nodiscard]] std::unique_ptr<Scan> make_serial_scan(const ScanOptions& options);
/// DMX widgets by their ids. Any maker may use FTDI's ids, so there the driver is a guess until the widget answers.
[[nodiscard]] std::unique_ptr<Scan> make_usb_scan(const ScanOptions& options);
[[nodiscard]] std::unique_ptr<Scan> make_can_scan(const ScanOptions& options);
/// Video4Linux devices that give pictures; devices of the same name by their buses.
[[nodiscard]] std::unique_ptr<Scan> make_camera_scan(const ScanOptions& options);

}  // namespace luxrig
