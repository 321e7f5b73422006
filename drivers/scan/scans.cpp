#include "drivers/scan/scan.h"

namespace luxrig {

std::vector<NamedScan> all_scans(const ScanOptions& options) {
  // One line per way to look. Art-Net nodes answer within a second; sACN sources announce themselves every ten seconds.
  std::vector<NamedScan> scans;
  scans.push_back({"Art-Net nodes", make_artnet_scan(options), std::chrono::milliseconds(1500)});
  scans.push_back({"sACN sources", make_sacn_scan(options), std::chrono::milliseconds(10500)});
  scans.push_back({"USB widgets", make_usb_scan(options), {}});
  scans.push_back({"serial ports", make_serial_scan(options), {}});
  scans.push_back({"CAN interfaces", make_can_scan(options), {}});
  scans.push_back({"cameras", make_camera_scan(options), {}});
  return scans;
}

}  // namespace luxrig
