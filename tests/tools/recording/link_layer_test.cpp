// Each kind of packet, as tcpdump and tshark wrote it, and as Wireshark reads it.
#include "tools/recording/link_layer.h"

#include <gtest/gtest.h>

#include "tests/tools/recording/capture_bytes.h"

namespace luxrig::recording {
namespace {

/// From 127.0.0.2 to 127.0.0.1, port 6454 to 6454: ArtDmx, four slots. Captured on Linux.
const CaptureBytes kIpv4 = {0x45, 0x00, 0x00, 0x32, 0x6b, 0x61, 0x40, 0x00, 0x40, 0x11, 0xd1, 0x56, 0x7f,
                            0x00, 0x00, 0x02, 0x7f, 0x00, 0x00, 0x01, 0x19, 0x36, 0x19, 0x36, 0x00, 0x1e,
                            0xfe, 0x32, 0x41, 0x72, 0x74, 0x2d, 0x4e, 0x65, 0x74, 0x00, 0x00, 0x50, 0x00,
                            0x0e, 0x07, 0x00, 0x21, 0x01, 0x00, 0x04, 0x0a, 0x14, 0x1e, 0x28};
const CaptureBytes kEthernet = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x08, 0x00};
const CaptureBytes kSll = {0x00, 0x00, 0x03, 0x04, 0x00, 0x06, 0, 0, 0, 0, 0, 0, 0x00, 0x00, 0x08, 0x00};
const CaptureBytes kSll2 = {0x08, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01, 0x03, 0x04,
                            0x00, 0x06, 0,    0,    0,    0,    0,    0,    0x00, 0x00};

void expect_artdmx(LinkType link, const CaptureBytes& packet) {
  const Seen seen = look_into(link, packet);
  const auto* datagram = std::get_if<UdpDatagram>(&seen.what);
  ASSERT_NE(datagram, nullptr) << static_cast<int>(link);
  EXPECT_EQ(text_of(datagram->from), "127.0.0.2:6454");
  EXPECT_EQ(text_of(datagram->to), "127.0.0.1:6454");
  EXPECT_FALSE(seen.cut);
  EXPECT_FALSE(seen.sent_here);
  EXPECT_EQ(CaptureBytes(datagram->payload.begin(), datagram->payload.end()),
            CaptureBytes(kIpv4.begin() + 28, kIpv4.end()));
}

TEST(LinkLayer, ADatagramIsFoundBehindEveryKindOfHeader) {
  expect_artdmx(LinkType::raw_ip, kIpv4);
  expect_artdmx(LinkType::ethernet, joined({kEthernet, kIpv4}));
  expect_artdmx(LinkType::linux_sll, joined({kSll, kIpv4}));
  expect_artdmx(LinkType::linux_sll2, joined({kSll2, kIpv4}));
  expect_artdmx(LinkType::null_host_order, joined({{2, 0, 0, 0}, kIpv4}));
  expect_artdmx(LinkType::loop, joined({{0, 0, 0, 2}, kIpv4}));
  const CaptureBytes addresses(12, 0);
  expect_artdmx(LinkType::ethernet, joined({addresses, {0x81, 0x00, 0x00, 0x07, 0x08, 0x00}, kIpv4}));
  expect_artdmx(LinkType::ethernet,
                joined({addresses, {0x88, 0xA8, 0x00, 0x07, 0x81, 0x00, 0x00, 0x08, 0x08, 0x00}, kIpv4}));
  expect_artdmx(LinkType::ethernet, joined({kEthernet, kIpv4, CaptureBytes(10, 0)}));  // padded
}

TEST(LinkLayer, TellsWhatTheRecordingComputerSent) {
  CaptureBytes sll = kSll, sll2 = kSll2;
  sll[1] = sll2[10] = 4;
  EXPECT_TRUE(look_into(LinkType::linux_sll, joined({sll, kIpv4})).sent_here);
  EXPECT_TRUE(look_into(LinkType::linux_sll2, joined({sll2, kIpv4})).sent_here);
}

/// tshark reads all three as identifier 0x185, seven bytes.
TEST(LinkLayer, ACanFrameHasItsIdentifierInTheOrderOfItsHeader) {
  const CaptureBytes rest = {7, 0, 0, 0, 0x37, 0x02, 0x10, 0x27, 0, 0, 1};
  const CaptureBytes can_on_sll = {0, 1, 1, 0x18, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x0C};
  const CaptureBytes can_on_sll2 = {0, 0x0C, 0, 0, 0, 0, 0, 3, 1, 0x18, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  for (const auto& [link, packet] :
       {std::pair(LinkType::can, joined({{0, 0, 0x01, 0x85}, rest})),
        std::pair(LinkType::linux_sll, joined({can_on_sll, {0x85, 0x01, 0, 0}, rest})),
        std::pair(LinkType::linux_sll2, joined({can_on_sll2, {0x85, 0x01, 0, 0}, rest}))}) {
    const Seen seen = look_into(link, packet);
    const auto* frame = std::get_if<can::CanFrame>(&seen.what);
    ASSERT_NE(frame, nullptr);
    EXPECT_EQ(frame->id, 0x185u);
    EXPECT_FALSE(frame->extended);
    EXPECT_EQ(CaptureBytes(frame->payload().begin(), frame->payload().end()),
              CaptureBytes(rest.begin() + 4, rest.end()));
  }
  EXPECT_TRUE(std::holds_alternative<std::monostate>(
      look_into(LinkType::can, joined({{0, 0, 1, 0x85}, {9, 0, 0, 0}, CaptureBytes(9, 0)})).what));
}

TEST(LinkLayer, ASegmentsPayloadBeginsBehindItsOptions) {
  CaptureBytes packet = tcp_packet(kDeskAddress, 40000, kServerAddress, 502, 0xFFFFFFFE, 0x18, {1, 1, 1, 1, 7, 8});
  packet[20 + 12] = 0x60;  // six words of header
  const Seen seen = look_into(LinkType::raw_ip, packet);
  const auto* segment = std::get_if<TcpSegment>(&seen.what);
  ASSERT_NE(segment, nullptr);
  EXPECT_EQ(text_of(segment->from), "10.0.0.5:40000");
  EXPECT_EQ(text_of(segment->to), "192.0.2.10:502");
  EXPECT_EQ(segment->sequence, 0xFFFFFFFE);
  EXPECT_FALSE(segment->begins);
  EXPECT_EQ(CaptureBytes(segment->payload.begin(), segment->payload.end()), (CaptureBytes{7, 8}));
  packet[20 + 13] = 0x02;
  const Seen first = look_into(LinkType::raw_ip, packet);
  EXPECT_TRUE(std::get<TcpSegment>(first.what).begins);
  EXPECT_EQ(std::get<TcpSegment>(first.what).sequence, 0xFFFFFFFF) << "SYN counts";
}

TEST(LinkLayer, WhatTheCaptureCutIsSaid) {
  for (std::size_t size = 0; size < kIpv4.size(); ++size) {
    const Seen seen = look_into(LinkType::raw_ip, {kIpv4.data(), size});
    const auto* datagram = std::get_if<UdpDatagram>(&seen.what);
    EXPECT_EQ(datagram != nullptr, size >= 28) << size;
    EXPECT_EQ(seen.cut, size >= 28) << size;
  }
}

TEST(LinkLayer, LengthsThatContradictAreNothing) {
  const auto nothing = [](std::size_t at, std::uint8_t value) {
    CaptureBytes packet = kIpv4;
    packet[at] = value;
    return std::holds_alternative<std::monostate>(look_into(LinkType::raw_ip, packet).what);
  };
  EXPECT_TRUE(nothing(0, 0x65)) << "version 6";
  EXPECT_TRUE(nothing(0, 0x44)) << "a header of 16 bytes";
  EXPECT_TRUE(nothing(0, 0x4F)) << "a header longer than the packet";
  EXPECT_TRUE(nothing(3, 19)) << "shorter than its header";
  EXPECT_TRUE(nothing(6, 0x20)) << "more fragments follow";
  EXPECT_TRUE(nothing(7, 0x01)) << "a later fragment";
  EXPECT_TRUE(nothing(25, 7)) << "a datagram shorter than its header";
  EXPECT_TRUE(nothing(25, 31)) << "a datagram longer than its packet";
  EXPECT_TRUE(nothing(9, 1)) << "ICMP";
}

}  // namespace
}  // namespace luxrig::recording
