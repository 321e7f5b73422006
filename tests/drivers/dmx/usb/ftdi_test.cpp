/// Values as in FTDI's application notes and Linux' ftdi_sio.

#include "drivers/dmx/usb/ftdi.h"

#include <gtest/gtest.h>

#include "tests/drivers/hex.h"

namespace luxrig::ftdi {
namespace {

TEST(Ftdi, RequestsAreAsPublished) {
  const Port only;
  EXPECT_EQ(set_baud(only, 250000), (UsbSetup{0x40, 3, 0x000c, 0}));
  EXPECT_EQ(set_baud(only, 115200), (UsbSetup{0x40, 3, 0x001a, 0}));
  EXPECT_EQ(set_baud(only, 57600), (UsbSetup{0x40, 3, 0x0034, 0}));
  EXPECT_EQ(set_format(only, Format::eight_n_two), (UsbSetup{0x40, 4, 0x1008, 0}));
  EXPECT_EQ(set_format(only, Format::eight_n_two, true), (UsbSetup{0x40, 4, 0x5008, 0}));
  EXPECT_EQ(set_rts(only, false), (UsbSetup{0x40, 1, 0x0200, 0}));
  EXPECT_EQ(set_rts(only, true), (UsbSetup{0x40, 1, 0x0202, 0}));
  EXPECT_EQ(reset(only, Purge::transmit), (UsbSetup{0x40, 0, 2, 0}));
  EXPECT_EQ(get_modem_status(only), (UsbSetup{0xc0, 5, 0, 0}));
}

TEST(Ftdi, PortsOfAMultiPortChipHaveTheirOwnEndpoints) {
  EXPECT_EQ(Port{}.bulk_out(), 0x02);
  EXPECT_EQ(Port{}.bulk_in(), 0x81);
  EXPECT_EQ(Port{1}.bulk_out(), 0x02);
  EXPECT_EQ(Port{2}.bulk_out(), 0x04);
  EXPECT_EQ(Port{2}.bulk_in(), 0x83);
  EXPECT_EQ(Port{2}.interface(), 1);
}

TEST(Ftdi, StripsTheTwoStatusBytesOfEveryPacket) {
  EXPECT_TRUE(received_bytes({}).empty());
  EXPECT_TRUE(received_bytes(from_hex("01")).empty());
  EXPECT_TRUE(received_bytes(from_hex("01 60")).empty());
  EXPECT_EQ(received_bytes(from_hex("01 60 7e 03")), from_hex("7e 03"));
  std::vector<std::uint8_t> two(64 + 5, 0xaa);
  two[0] = two[1] = two[64] = two[65] = 0x01;
  EXPECT_EQ(received_bytes(two), std::vector<std::uint8_t>(62 + 3, 0xaa));
}

TEST(Ftdi, TransmitterIsEmptyWhenTheLineStatusReportsIt) {
  EXPECT_TRUE(transmitter_is_empty(from_hex("01 60")));
  EXPECT_FALSE(transmitter_is_empty(from_hex("01 20")));  // only the holding register
  EXPECT_FALSE(transmitter_is_empty(from_hex("01")));
}

}  // namespace
}  // namespace luxrig::ftdi
