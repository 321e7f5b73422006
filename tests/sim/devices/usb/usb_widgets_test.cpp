/// The simulated widgets against published bytes, and their faults.

#include "sim/devices/usb/usb_widgets.h"

#include <gtest/gtest.h>

#include "sim/devices/usb/dmx_line.h"
#include "sim/devices/usb/enttec_widget.h"
#include "sim/devices/usb/udmx_widget.h"
#include "tests/drivers/hex.h"

namespace luxrig::sim {
namespace {

using WidgetBytes = std::vector<std::uint8_t>;

Time usb_at(double ms) { return Time{} + from_seconds(1 + ms / 1000); }

WidgetBytes widget_said(EnttecWidget& widget, const std::string& hex) {
  widget.receive(usb_at(0), {}, {}, from_hex(hex));
  return widget.take(usb_at(0), 4096);
}

TEST(EnttecWidget, AnswersAsSpecified) {
  EnttecWidget widget;
  EXPECT_EQ(widget_said(widget, "7e 03 02 00 00 00 e7"), from_hex("7e 03 05 00 44 01 09 01 28 e7"));
  EXPECT_EQ(widget_said(widget, "7e 0a 00 00 e7"), from_hex("7e 0a 04 00 12 34 56 02 e7"));
  EXPECT_EQ(widget_said(widget, "7e 04 05 00 00 00 11 02 1e e7"), WidgetBytes{});
  EXPECT_EQ(widget_said(widget, "7e 03 02 00 00 00 e7"), from_hex("7e 03 05 00 44 01 11 02 1e e7"));
  EXPECT_EQ(widget_said(widget, "7e 04 05 00 00 00 08 02 1e e7 7e 03 02 00 00 00 e7"),
            from_hex("7e 03 05 00 44 01 11 02 1e e7"));  // a break of 8 units is refused
  EXPECT_FALSE(widget_said(widget, "7e 4d 00 00 e7").empty());
  widget.set_character({.says_names = false});
  EXPECT_TRUE(widget_said(widget, "7e 4d 00 00 e7 7e 4e 00 00 e7").empty());
}

TEST(EnttecWidget, RepeatsItsLastPacketUntilARequestOtherThanThreeOrSix) {
  EnttecWidget widget;
  widget.power_on(usb_at(0));
  EXPECT_FALSE(widget.line(usb_at(0)));
  WidgetBytes output = from_hex("7e 06 19 00 00 0a 14 1e");
  output.resize(4 + 25);
  output.push_back(0xe7);
  widget.receive(usb_at(0), {}, {}, output);
  ASSERT_TRUE(widget.line(usb_at(1e6)));
  EXPECT_EQ(widget.line(usb_at(1e6))->at(2), 0x1e);
  (void)widget_said(widget, "7e 03 02 00 00 00 e7");
  EXPECT_TRUE(widget.line(usb_at(1e6)));
  (void)widget_said(widget, "7e 0a 00 00 e7");
  EXPECT_FALSE(widget.line(usb_at(1e6)));
  EXPECT_EQ(widget.stops(), 1u);
}

TEST(EnttecWidget, ForwardsRdmWhenItsFirmwareSupportsIt) {
  EnttecWidget widget;
  EXPECT_TRUE(widget_said(widget, "7e 07 02 00 cc 01 e7").empty()) << "firmware 1 has no RDM";
  WidgetBytes asked;
  widget.connect([&](Time, std::span<const std::uint8_t> packet) {
    asked.assign(packet.begin(), packet.end());
    return asked.size() == 2 ? from_hex("cc 02 03") : WidgetBytes{};
  });
  EXPECT_EQ(widget_said(widget, "7e 03 02 00 00 00 e7"), from_hex("7e 03 05 00 04 02 09 01 28 e7"));
  // A status byte, then the bytes from the line; silence gives label 12.
  EXPECT_EQ(widget_said(widget, "7e 07 02 00 cc 01 e7"), from_hex("7e 05 04 00 00 cc 02 03 e7"));
  EXPECT_EQ(asked, from_hex("cc 01"));
  EXPECT_EQ(widget_said(widget, "7e 0b 03 00 cc 01 18 e7"), from_hex("7e 0c 00 00 e7"));
}

TEST(EnttecWidget, IgnoresShortPacketsAndOtherStartCodes) {
  EnttecWidget widget;
  (void)widget_said(widget, "7e 06 04 00 00 0a 14 1e e7");
  EXPECT_EQ(widget.frames(), 0u);
  WidgetBytes rdm = from_hex("7e 06 19 00 cc");
  rdm.resize(4 + 25);
  rdm.push_back(0xe7);
  widget.receive(usb_at(0), {}, {}, rdm);
  EXPECT_EQ(widget.frames(), 0u);
}

TEST(EnttecWidget, FindsTheNextMessageAfterNoise) {
  EnttecWidget widget;
  EXPECT_EQ(widget_said(widget, "00 7e ff ff ff 7e 03 02 00 00 00 e6 7e 0a 00 00 e7"),
            from_hex("7e 0a 04 00 12 34 56 02 e7"));
  EXPECT_EQ(widget.dropped(), 12u);
}

TEST(FtdiChip, PrefixesStatusBytesAndDelaysEmptyAnswersByItsLatency) {
  EnttecWidget widget;
  FtdiChip chip(widget, "x", "y", false);
  chip.power_on(usb_at(0));
  EXPECT_EQ(chip.bulk_in(usb_at(1), 0x81, 64).kind, UsbReply::Kind::wait);
  EXPECT_EQ(chip.bulk_in(usb_at(16), 0x81, 64).data, from_hex("01 60"));
  EXPECT_EQ(chip.control(usb_at(16), {0x40, 9, 2, 0, 0}, {}).kind, UsbReply::Kind::done);
  EXPECT_EQ(chip.bulk_in(usb_at(18), 0x81, 64).data, from_hex("01 60"));
  (void)chip.bulk_out(usb_at(18), 0x02, from_hex("7e 0a 00 00 e7"));
  EXPECT_EQ(chip.bulk_in(usb_at(18.1), 0x81, 64).data, from_hex("01 60 7e 0a 04 00 12 34 56 02 e7"));
  EXPECT_EQ(chip.bulk_out(usb_at(19), 0x04, {}).kind, UsbReply::Kind::stall);
  EXPECT_EQ(chip.control(usb_at(19), {0x40, 0x33, 0, 0, 0}, {}).kind, UsbReply::Kind::stall);
}

struct FtdiCable {
  FtdiCable() {
    chip.power_on(usb_at(0));
    for (const auto& [request, value] : {std::pair(3, 12), std::pair(4, 0x1008), std::pair(1, 0x0200)}) {
      (void)ask(0, request, value);
    }
  }
  UsbReply ask(double ms, int request, int value) {
    return chip.control(usb_at(ms), {0x40, static_cast<std::uint8_t>(request), static_cast<std::uint16_t>(value), 0, 0},
                        {});
  }
  void packet(double ms) {
    (void)ask(ms, 4, 0x5008);
    (void)ask(ms + 1, 4, 0x1008);
    (void)chip.bulk_out(usb_at(ms + 3), 0x02, slots);
  }
  DmxLine line;
  FtdiChip chip{line, "x", "y", true};
  WidgetBytes slots = WidgetBytes(513, 0);
};

TEST(DmxLine, AWholePacketTakes22Point6Milliseconds) {
  FtdiCable cable;
  cable.slots[1] = 99;
  cable.packet(10);
  EXPECT_EQ(cable.line.packets(), 1u);
  EXPECT_EQ(cable.line.line(usb_at(20))->at(0), 99);
  EXPECT_TRUE(cable.chip.is_sending(usb_at(13 + 22.5)));
  EXPECT_FALSE(cable.chip.is_sending(usb_at(13 + 22.63)));
  const UsbReply status = cable.chip.control(usb_at(20), {0xc0, 5, 0, 0, 2}, {});
  EXPECT_EQ(status.data[1] & 0x40, 0);
}

TEST(DmxLine, DataWithoutABreakWithinABreakOrAtAnotherRateIsNoPacket) {
  FtdiCable none;
  (void)none.chip.bulk_out(usb_at(5), 0x02, none.slots);
  EXPECT_EQ(none.line.packets(), 0u);
  EXPECT_EQ(none.line.spoiled(), 513u);
  FtdiCable in_break;
  (void)in_break.ask(10, 4, 0x5008);
  (void)in_break.chip.bulk_out(usb_at(12), 0x02, in_break.slots);
  EXPECT_EQ(in_break.line.packets(), 0u);
  FtdiCable slow;
  (void)slow.ask(1, 3, 26);
  slow.packet(10);
  EXPECT_EQ(slow.line.packets(), 0u);
  FtdiCable driver_off;
  (void)driver_off.ask(1, 1, 0x0202);
  driver_off.packet(10);
  EXPECT_EQ(driver_off.line.packets(), 0u);
}

TEST(DmxLine, ABreakBeforeTheEndCutsThePacketShort) {
  FtdiCable cable;
  cable.packet(10);
  cable.packet(25);
  EXPECT_EQ(cable.line.short_ones(), 1u);
}

TEST(DmxLine, FallsSilentOneSecondAfterItsLastPacket) {
  FtdiCable cable;
  cable.packet(10);
  EXPECT_TRUE(cable.line.line(usb_at(1000)));
  EXPECT_FALSE(cable.line.line(usb_at(1100)));
}

TEST(UdmxWidget, AcceptsRangesAndSingleChannelsButNotPastTheEnd) {
  UdmxWidget widget;
  widget.power_on(usb_at(0));
  EXPECT_FALSE(widget.line(usb_at(0)));
  const WidgetBytes two = {7, 8};
  EXPECT_EQ(widget.control(usb_at(0), {0x40, 2, 2, 510, 2}, two).kind, UsbReply::Kind::done);
  EXPECT_EQ(widget.control(usb_at(0), {0x40, 2, 2, 511, 2}, two).kind, UsbReply::Kind::stall);
  EXPECT_EQ(widget.control(usb_at(0), {0x40, 2, 3, 0, 2}, two).kind, UsbReply::Kind::stall);
  EXPECT_EQ(widget.control(usb_at(0), {0x40, 1, 200, 3, 0}, {}).kind, UsbReply::Kind::done);
  EXPECT_EQ(widget.control(usb_at(0), {0x40, 1, 256, 3, 0}, {}).kind, UsbReply::Kind::stall);
  EXPECT_EQ(widget.line(usb_at(0))->at(3), 200);
  EXPECT_EQ(widget.line(usb_at(0))->at(511), 8);
  EXPECT_EQ(widget.slots_put_out(), 512u);
}

TEST(UdmxWidget, AUniverseTakes33Milliseconds) {
  UdmxWidget widget;
  const WidgetBytes all(512, 1);
  EXPECT_EQ(widget.control(usb_at(0), {0x40, 2, 512, 0, 512}, all).takes, std::chrono::milliseconds(33));
}

TEST(UsbWidgets, DescribeThemselvesAsTheRealOnesDo) {
  for (const auto& [name, id, strings] : {std::tuple("enttec_pro", "0304 0160", 3),
                                          std::tuple("open_dmx", "0304 0160", 3), std::tuple("udmx", "c016 dc05", 2)}) {
    const auto device = make_usb_widget(name);
    ASSERT_TRUE(device) << name;
    const auto reply = device->control(usb_at(0), {0x80, 6, 0x0100, 0, 64}, {});
    ASSERT_EQ(reply.data.size(), 18u);
    EXPECT_EQ(WidgetBytes(reply.data.begin() + 8, reply.data.begin() + 12), from_hex(id)) << name;
    const auto configuration = device->control(usb_at(0), {0x80, 6, 0x0200, 0, 255}, {});
    EXPECT_EQ(configuration.data.size(), configuration.data.at(2)) << name;
    for (int i = 0; i <= strings; ++i) {
      EXPECT_EQ(device->control(usb_at(0), {0x80, 6, static_cast<std::uint16_t>(0x0300 | i), 0, 255}, {}).kind,
                UsbReply::Kind::done);
    }
    EXPECT_EQ(device->control(usb_at(0), {0x80, 6, static_cast<std::uint16_t>(0x0301 + strings), 0, 255}, {}).kind,
              UsbReply::Kind::stall);
  }
  EXPECT_FALSE(make_usb_widget("sacn"));
}

}  // namespace
}  // namespace luxrig::sim
