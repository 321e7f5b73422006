/// Literal bytes of the USB/IP protocol, as laid out in Linux' Documentation/usb/usbip_protocol.rst.

#include "sim/wire/usb/usbip_session.h"

#include <gtest/gtest.h>

#include "sim/devices/usb/udmx_widget.h"
#include "tests/drivers/hex.h"

namespace luxrig::sim {
namespace {

using UsbipBytes = std::vector<std::uint8_t>;

Time usbip_at(double ms) { return Time{} + from_seconds(ms / 1000); }

struct UsbipServer {
  explicit UsbipServer(UsbipSession::FaultOf fault = {})
      : session(widget, UsbipSession::Beginning::handshake, std::move(fault)) {
    widget.power_on(usbip_at(0));
  }
  UsbipBytes say(double ms, const std::string& hex) {
    session.receive(usbip_at(ms), from_hex(hex));
    return session.take_output();
  }
  void import() {
    UsbipBytes request = from_hex("0111 8003 00000000 312d31");
    request.resize(40);
    session.receive(usbip_at(0), request);
    (void)session.take_output();
  }
  UdmxWidget widget;
  UsbipSession session;
};

// Submit, sequence 7, endpoint 0 out, 2 bytes: uDMX request 2, 2 channels from 4: aa bb.
const std::string kSetRange =
    "00000001 00000007 00010002 00000000 00000000 00000000 00000002 00000000 ffffffff 00000000 40 02 0200 0400 0200 "
    "aabb";
const std::string kUsbipZeros = "00000000 00000000 00000000 ";

TEST(UsbipSession, ListsAndExportsItsDevice) {
  UsbipServer server;
  const UsbipBytes list = server.say(0, "0111 8005 00000000");
  ASSERT_EQ(list.size(), 12u + 312u + 4u);
  EXPECT_EQ(UsbipBytes(list.begin(), list.begin() + 12), from_hex("0111 0005 00000000 00000001"));
  EXPECT_EQ(std::string(list.begin() + 12 + 256, list.begin() + 12 + 256 + 3), "1-1");
  // bus 1, device 2, low speed, 16c0:05dc
  EXPECT_EQ(UsbipBytes(list.begin() + 12 + 288, list.begin() + 12 + 304),
            from_hex("00000001 00000002 00000001 16c0 05dc"));

  UsbipBytes request = from_hex("0111 8003 00000000 312d31");
  request.resize(40);
  server.session.receive(usbip_at(0), request);
  const UsbipBytes reply = server.session.take_output();
  ASSERT_EQ(reply.size(), 320u);
  EXPECT_EQ(UsbipBytes(reply.begin(), reply.begin() + 8), from_hex("0111 0003 00000000"));
}

TEST(UsbipSession, RefusesAnUnknownDevice) {
  UsbipServer server;
  UsbipBytes request = from_hex("0111 8003 00000000 392d39");
  request.resize(40);
  server.session.receive(usbip_at(0), request);
  EXPECT_EQ(server.session.take_output(), from_hex("0111 0003 00000001"));
}

TEST(UsbipSession, AnswersATransferWhenTheDeviceIsDone) {
  UsbipServer server;
  server.import();
  EXPECT_TRUE(server.say(10, kSetRange).empty());  // low speed needs 1.5 ms
  server.session.serve(usbip_at(11.4));
  EXPECT_TRUE(server.session.take_output().empty());
  server.session.serve(usbip_at(11.6));
  EXPECT_EQ(server.session.take_output(), from_hex("00000003 00000007 " + kUsbipZeros +
                                                   "00000000 00000002 00000000 ffffffff "
                                                   "00000000 0000000000000000"));
  const auto look = server.widget.line(usbip_at(12));
  ASSERT_TRUE(look);
  EXPECT_EQ(look->at(4), 0xaa);
  EXPECT_EQ(look->at(5), 0xbb);
}

TEST(UsbipSession, TruncatesDescriptorsToTheRequestedLength) {
  UsbipServer server;
  server.import();
  const UsbipBytes reply =
      server.say(1,
                 "00000001 00000001 00010002 00000001 00000000 00000000 00000008 00000000 ffffffff "
                 "00000000 80 06 0001 0000 0800");
  EXPECT_EQ(reply, from_hex("00000003 00000001 " + kUsbipZeros +
                            "00000000 00000008 00000000 ffffffff 00000000 "
                            "0000000000000000 12 01 1001 ff 00 00 08"));
}

TEST(UsbipSession, StallsUnknownRequests) {
  UsbipServer server;
  server.import();
  (void)server.say(1,
                   "00000001 00000009 00010002 00000000 00000000 00000000 00000000 00000000 ffffffff 00000000 "
                   "40 77 0000 0000 0000");
  server.session.serve(usbip_at(5));
  const UsbipBytes reply = server.session.take_output();
  EXPECT_EQ(reply, from_hex("00000003 00000009 " + kUsbipZeros +
                            "ffffffe0 00000000 00000000 ffffffff 00000000 "
                            "0000000000000000"));  // -32: EPIPE
}

TEST(UsbipSession, AHangingTransferEndsWhenUnlinked) {
  UsbipServer server([] {
    Disturbance disturbance;
    disturbance.silent = true;
    return disturbance;
  });
  server.import();
  EXPECT_TRUE(server.say(1, kSetRange).empty());
  server.session.serve(usbip_at(10000));
  EXPECT_TRUE(server.session.take_output().empty());
  EXPECT_FALSE(server.widget.line(usbip_at(10000)));
  const std::string unlink = "00000002 00000008 00010002 00000000 00000000 00000007";
  UsbipBytes request = from_hex(unlink);
  request.resize(48);
  server.session.receive(usbip_at(10001), request);
  UsbipBytes wanted = from_hex("00000004 00000008 " + kUsbipZeros + "ffffff98");  // -104: ECONNRESET
  wanted.resize(48);
  EXPECT_EQ(server.session.take_output(), wanted);
  server.session.receive(usbip_at(10002), request);
  wanted = from_hex("00000004 00000008 " + kUsbipZeros + "00000000");  // it is already gone
  wanted.resize(48);
  EXPECT_EQ(server.session.take_output(), wanted);
}

TEST(UsbipSession, AcceptsCommandsByteByByte) {
  UsbipServer server;
  server.import();
  for (const std::uint8_t byte : from_hex(kSetRange)) server.session.receive(usbip_at(1), {&byte, 1});
  EXPECT_EQ(server.session.begun(), 1u);
}

TEST(UsbipSession, DisconnectsOnInvalidProtocol) {
  for (const char* nonsense : {"0110 8003 00000000", "0111 9999 00000000", "474554202f20485454502f31"}) {
    UsbipServer server;
    (void)server.say(0, nonsense);
    EXPECT_TRUE(server.session.is_broken()) << nonsense;
  }
  UsbipServer server;
  server.import();
  (void)server.say(1,
                   "00000001 00000007 00010002 00000000 00000000 00000000 7fffffff 00000000 ffffffff 00000000 "
                   "40 02 0200 0400 0200");
  EXPECT_TRUE(server.session.is_broken());  // two gigabytes
}

}  // namespace
}  // namespace luxrig::sim
