#pragma once
/// What is there to be driven, without a rig file: each way to look is a Scan, a line in the table of scans.cpp.
/// Looking moves no light: nodes are asked who they are, sources are listened to, the system's lists are read.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "core/time.h"

namespace luxrig {

struct FoundDevice {
  std::string driver;   ///< of the registry, that would use it
  std::string address;  ///< as its option in the rig file has it: "10.0.0.7", "/dev/ttyUSB0", "can0"
  std::string name;     ///< what it calls itself; may be empty
  std::string detail;   ///< what a person would want to know: universes, serial number, state
};

class Scan {
 public:
  virtual ~Scan() = default;
  /// Begins, or goes on; never blocks. A fault when this way of looking is not to be had here: others may be.
  virtual Result<void> step(Time now) = 0;
  /// Until now, in the order of addresses.
  [[nodiscard]] virtual std::vector<FoundDevice> found() const = 0;
};

struct ScanOptions {
  std::string broadcast = "255.255.255.255";  ///< where Art-Net nodes are asked
  std::string interface;                      ///< by which sACN sources are heard; empty: the system's choice
  std::string root = "/";                     ///< where dev and sys are
};

struct NamedScan {
  std::string what;  ///< "Art-Net nodes"
  std::unique_ptr<Scan> scan;
  /// How long it needs to see everything; 0: the first step does.
  Duration complete_after{};
};

[[nodiscard]] std::vector<NamedScan> all_scans(const ScanOptions& options);

// The ways to look.
[[nodiscard]] std::unique_ptr<Scan> make_artnet_scan(const ScanOptions& options);
[[nodiscard]] std::unique_ptr<Scan> make_sacn_scan(const ScanOptions& options);
/// Serial ports that a USB or on-board adapter stands behind, by their lasting names where they have one.
[[nodiscard]] std::unique_ptr<Scan> make_serial_scan(const ScanOptions& options);
/// DMX widgets by their ids; those of FTDI are any maker's, so the driver is a guess until the widget answers.
[[nodiscard]] std::unique_ptr<Scan> make_usb_scan(const ScanOptions& options);
[[nodiscard]] std::unique_ptr<Scan> make_can_scan(const ScanOptions& options);
/// Video4Linux devices that give pictures; those of one name by their buses.
[[nodiscard]] std::unique_ptr<Scan> make_camera_scan(const ScanOptions& options);

}  // namespace luxrig
