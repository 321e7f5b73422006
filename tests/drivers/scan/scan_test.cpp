/// Finding devices: made-up system folders, and Art-Net and sACN over loopback.
#include "drivers/scan/scan.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "drivers/dmx/artnet/artnet_codec.h"
#include "drivers/dmx/sacn/sacn_codec.h"
#include "drivers/io/udp.h"

namespace luxrig {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

/// A folder that stands for the root of a system.
class MadeUpSystem {
 public:
  MadeUpSystem() {
    std::string name = (fs::temp_directory_path() / "luxrig-scan-XXXXXX").string();
    root_ = ::mkdtemp(name.data());
  }
  ~MadeUpSystem() { fs::remove_all(root_); }
  MadeUpSystem(const MadeUpSystem&) = delete;
  MadeUpSystem& operator=(const MadeUpSystem&) = delete;

  void file(const std::string& path, const std::string& text) const {
    fs::create_directories((root_ / path).parent_path());
    std::ofstream(root_ / path) << text << "\n";
  }
  void link(const std::string& path, const std::string& to) const {
    fs::create_directories((root_ / path).parent_path());
    fs::create_symlink(to, root_ / path);
  }
  [[nodiscard]] ScanOptions options() const {
    ScanOptions options;
    options.root = root_.string() + "/";
    return options;
  }

 private:
  fs::path root_;
};

TEST(SystemScan, FindsSerialPortsWithTheirStableNamesAndKinds) {
  const MadeUpSystem system;
  const std::string usb = "sys/devices/pci0/usb1/1-2/";
  system.file(usb + "product", "FT232R USB UART");
  system.file(usb + "manufacturer", "FTDI");
  system.file(usb + "serial", "A50285BI");
  system.file(usb + "1-2:1.0/ttyUSB0/tty/ttyUSB0/dev", "188:0");
  system.link("sys/class/tty/ttyUSB0", "../../../" + usb + "1-2:1.0/ttyUSB0/tty/ttyUSB0");
  system.link(usb + "1-2:1.0/ttyUSB0/tty/ttyUSB0/device", "../../../ttyUSB0");
  system.file("dev/ttyUSB0", "");
  system.link("dev/serial/by-id/usb-FTDI_FT232R_USB_UART_A50285BI-if00-port0", "../../ttyUSB0");
  system.file("sys/class/tty/tty1/dev", "4:1");               // a console
  system.file("sys/devices/platform/serial8250/uevent", "");  // an on-board port without a chip
  system.file("sys/class/tty/ttyS3/type", "0");
  system.link("sys/class/tty/ttyS3/device", "../../../devices/platform/serial8250");
  system.file("sys/class/tty/ttyS0/type", "4");  // one with a chip
  system.link("sys/class/tty/ttyS0/device", "../../../devices/platform/serial8250");

  const auto scan = make_serial_scan(system.options());
  EXPECT_TRUE(scan->found().empty());
  ASSERT_TRUE(scan->step({}));
  const auto found = scan->found();
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].address, "/dev/ttyS0");
  EXPECT_EQ(found[1].address, "/dev/serial/by-id/usb-FTDI_FT232R_USB_UART_A50285BI-if00-port0");
  EXPECT_EQ(found[1].name, "FTDI FT232R USB UART");
  EXPECT_EQ(found[1].detail, "ttyUSB0, serial number A50285BI");
}

TEST(SystemScan, FindsCanInterfacesAndReportsWhichAreDown) {
  const MadeUpSystem system;
  system.file("sys/class/net/lo/type", "772");
  system.file("sys/class/net/can1/type", "280");
  system.file("sys/class/net/can1/operstate", "up");
  system.file("sys/class/net/can0/type", "280");
  system.file("sys/class/net/can0/operstate", "down");
  const auto scan = make_can_scan(system.options());
  ASSERT_TRUE(scan->step({}));
  const auto found = scan->found();
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].address, "can0");
  EXPECT_EQ(found[0].detail, "down: ip link set can0 up");
  EXPECT_EQ(found[1].detail, "up");
}

TEST(SystemScan, FindsUsbWidgetsByTheirIds) {
  const MadeUpSystem system;
  system.file("sys/bus/usb/devices/1-1.4/idVendor", "0403");
  system.file("sys/bus/usb/devices/1-1.4/idProduct", "6001");
  system.file("sys/bus/usb/devices/1-1.4/manufacturer", "ENTTEC");
  system.file("sys/bus/usb/devices/1-1.4/product", "DMX USB PRO");
  system.file("sys/bus/usb/devices/1-1.4/serial", "EN012345");
  system.file("sys/bus/usb/devices/1-2/idVendor", "16c0");
  system.file("sys/bus/usb/devices/1-2/idProduct", "05dc");
  system.file("sys/bus/usb/devices/1-3/idVendor", "046d");  // a mouse
  system.file("sys/bus/usb/devices/1-3/idProduct", "c077");
  const auto scan = make_usb_scan(system.options());
  ASSERT_TRUE(scan->step({}));
  const auto found = scan->found();
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].driver, "enttec_pro or open_dmx");
  EXPECT_EQ(found[0].address, "1-1.4");
  EXPECT_EQ(found[0].name, "ENTTEC DMX USB PRO");
  EXPECT_EQ(found[0].detail, "0403:6001, serial number EN012345");
  EXPECT_EQ(found[1].driver, "udmx");
}

TEST(SystemScan, OfAnEmptySystemFindsNothing) {
  const MadeUpSystem system;
  const auto serial = make_serial_scan(system.options()), can = make_can_scan(system.options());
  EXPECT_TRUE(serial->step({}) && can->step({}));
  EXPECT_TRUE(serial->found().empty() && can->found().empty());
}

TEST(NetworkScan, FindsAnArtNetNodeByItsAnswer) {
  ScanOptions options;
  options.broadcast = "127.0.0.1";
  const auto scan = make_artnet_scan(options);
  const Time start{};
  const auto begun = scan->step(start);
  if (!begun) GTEST_SKIP() << "no port of Art-Net's here: " << begun.error().detail;
  artnet::PollReply reply;
  reply.short_name = "Stage left";
  reply.bind_index = 1;
  reply.outputs = {{18, true, true, false}, {19, true, false, false}};
  UdpSettings settings;
  const auto node = make_udp(settings);
  ASSERT_TRUE(node->open());
  std::vector<FoundDevice> found;
  for (int i = 0; i < 200 && found.empty(); ++i) {
    ASSERT_TRUE(node->send({0x7F000001, artnet::kPort}, artnet::encode(reply, 0x7F000001)));
    std::this_thread::sleep_for(milliseconds(5));
    ASSERT_TRUE(scan->step(start + milliseconds(5) * i));
    found = scan->found();
  }
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].driver, "artnet");
  EXPECT_EQ(found[0].address, "127.0.0.1");
  EXPECT_EQ(found[0].name, "Stage left");
  EXPECT_EQ(found[0].detail, "puts out universe 18 (0:1:2), merging two senders, 19 (0:1:3)");
}

TEST(NetworkScan, FindsAnSacnSourceByItsUniverseDiscovery) {
  ScanOptions options;
  options.interface = "127.0.0.1";
  const auto scan = make_sacn_scan(options);
  const auto begun = scan->step({});
  if (!begun) GTEST_SKIP() << "no multicast here: " << begun.error().detail;
  sacn::DiscoveryPacket packet;
  packet.cid[3] = 7;
  packet.source_name = "Desk";
  packet.universes = {1, 2, 3, 9, 20, 21};
  UdpSettings settings;
  settings.multicast_interface = "127.0.0.1";
  const auto source = make_udp(settings);
  ASSERT_TRUE(source->open());
  std::vector<FoundDevice> found;
  for (int i = 0; i < 200 && found.empty(); ++i) {
    ASSERT_TRUE(source->send({sacn::multicast_group(sacn::kDiscoveryUniverse), sacn::kPort}, sacn::encode(packet)));
    ASSERT_TRUE(source->send({sacn::multicast_group(sacn::kDiscoveryUniverse), sacn::kPort},
                             std::vector<std::uint8_t>{1, 2, 3}));
    std::this_thread::sleep_for(milliseconds(5));
    ASSERT_TRUE(scan->step({}));
    found = scan->found();
  }
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].name, "Desk");
  EXPECT_EQ(found[0].detail, "sends universes 1 to 3, 9, 20 to 21");
}

}  // namespace
}  // namespace luxrig
