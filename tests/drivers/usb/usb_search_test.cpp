#include "drivers/usb/usb_search.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "drivers/usb/tty_lock.h"
#include "drivers/usb/usb_strings.h"
#include "tests/drivers/hex.h"

namespace luxrig {
namespace {

UsbCandidate at(std::string port, std::string serial = "") {
  UsbCandidate candidate;
  candidate.vendor = 0x0403;
  candidate.product = 0x6001;
  candidate.port = std::move(port);
  candidate.serial = std::move(serial);
  return candidate;
}

UsbSearch search() {
  UsbSearch search;
  search.what = "widget";
  search.kinds = {{0x0403, 0x6001}};
  return search;
}

TEST(UsbSearch, MatchesIdSerialAndPort) {
  UsbSearch wanted = search();
  EXPECT_TRUE(matches(wanted, at("1-1", "A")));
  wanted.serial = "A";
  EXPECT_TRUE(matches(wanted, at("1-1", "A")));
  EXPECT_FALSE(matches(wanted, at("1-1", "B")));
  wanted.port = "1-1.4";
  EXPECT_FALSE(may_match(wanted, at("1-1", "A")));
  EXPECT_TRUE(matches(wanted, at("1-1.4", "A")));
  UsbCandidate other = at("1-1.4", "A");
  other.product = 0x6010;
  EXPECT_FALSE(may_match(wanted, other));
}

TEST(UsbSearch, ASharedIdRequiresMatchingNames) {
  UsbSearch wanted = search();
  wanted.kinds = {{0x16c0, 0x05dc, "www.anyma.ch", "uDMX"}, {0x03eb, 0x8888}};
  UsbCandidate candidate = at("2-1");
  candidate.vendor = 0x16c0, candidate.product = 0x05dc;
  EXPECT_TRUE(needs_strings(wanted, candidate));
  EXPECT_FALSE(matches(wanted, candidate));
  candidate.manufacturer = "www.anyma.ch", candidate.product_name = "uDMX";
  EXPECT_TRUE(matches(wanted, candidate));
  candidate.product_name = "USBasp";
  EXPECT_FALSE(matches(wanted, candidate));
  candidate.vendor = 0x03eb, candidate.product = 0x8888;
  EXPECT_FALSE(needs_strings(wanted, candidate));
  EXPECT_TRUE(matches(wanted, candidate));
}

TEST(UsbSearch, RefusesAnAmbiguousMatchWithARemedy) {
  const UsbCandidate one[] = {at("1-1", "A")}, two[] = {at("1-1", "A"), at("1-2", "B")};
  EXPECT_EQ(choose(search(), one).value(), 0u);
  EXPECT_EQ(choose(search(), two).error().detail,
            "2 devices may be the widget (0403:6001 A at 1-1, 0403:6001 B at 1-2): give the bus serial or usb_port");
  EXPECT_EQ(choose(search(), {}).error().detail, "no widget is plugged in: check the cable, `lsusb` lists it");
}

TEST(UsbSearch, PortPathsFollowTheKernelsNotation) {
  const std::uint8_t ports[] = {1, 4};
  EXPECT_EQ(port_path(3, ports), "3-1.4");
  for (const char* good : {"1-1", "1-1.4", "10-2.3.4"}) EXPECT_TRUE(is_port_path(good)) << good;
  for (const char* bad : {"", "1", "1-", "-1", "1-1.", "1-1..2", "usb1", "1-1:1.0", "1-1111"}) {
    EXPECT_FALSE(is_port_path(bad)) << bad;
  }
}

TEST(UsbStrings, ReadUtf16WithinTheirLength) {
  EXPECT_EQ(text_of_string_descriptor(from_hex("0a 03 75 00 44 00 4d 00 58 00")), "uDMX");
  EXPECT_EQ(text_of_string_descriptor(from_hex("06 03 b5 00 ac 20")), "µ€");
  EXPECT_EQ(text_of_string_descriptor(from_hex("06 03 3d d8 a1 dc")), "\xf0\x9f\x92\xa1");
  EXPECT_EQ(text_of_string_descriptor(from_hex("06 03 00 d8 0a 00")), "??");  // half a pair, a line feed
  EXPECT_EQ(text_of_string_descriptor(from_hex("ff 03 41 00 42")), "A");      // cut short
  EXPECT_EQ(text_of_string_descriptor(from_hex("04 01 41 00")), "");
  EXPECT_EQ(text_of_string_descriptor({}), "");
}

TEST(TtyLock, NamesTheLivingProcessThatHoldsTheSerialPort) {
  const auto root = std::filesystem::temp_directory_path() / ("luxrig-tty-" + std::to_string(::getpid()));
  const auto devices = root / "devices", locks = root / "lock";
  std::filesystem::create_directories(devices / "1-1.4:1.0" / "ttyUSB3");
  std::filesystem::create_directories(locks);
  EXPECT_FALSE(tty_user("1-1.4", 0, devices, locks));
  std::ofstream(locks / "LCK..ttyUSB3") << "       " << ::getpid() << "\n";
  const auto user = tty_user("1-1.4", 0, devices, locks);
  ASSERT_TRUE(user);
  EXPECT_EQ(user->tty, "ttyUSB3");
  EXPECT_EQ(user->pid, ::getpid());
  EXPECT_FALSE(tty_user("1-1.4", 1, devices, locks));
  std::ofstream(locks / "LCK..ttyUSB3") << "4194305\n";  // above the highest process number
  EXPECT_FALSE(tty_user("1-1.4", 0, devices, locks));
  std::ofstream(locks / "LCK..ttyUSB3") << "garbage\n";
  EXPECT_FALSE(tty_user("1-1.4", 0, devices, locks));
  std::filesystem::remove_all(root);
}

}  // namespace
}  // namespace luxrig
