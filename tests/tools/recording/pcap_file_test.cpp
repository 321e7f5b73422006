// Whole capture files: by other programs, and byte by byte; damaged ones are refused with the packet's number.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "drivers/dmx/artnet/artnet_codec.h"
#include "tests/folders.h"
#include "tests/loopback_desk.h"
#include "tests/tools/recording/capture_bytes.h"

namespace luxrig::recording {
namespace {

std::filesystem::path recorded(const std::string& name) {
  return test::source_folder() / "tests/data/recordings" / name;
}

/// tshark 4.0 on the interface `any`: 14 packets of a desk on sACN universe 1, eight slots, the last three a goodbye.
TEST(PcapFile, ACaptureByTsharkIsRead) {
  const auto read = read_recording(recorded("sacn_by_tshark_on_any.pcapng"), {});
  ASSERT_TRUE(read.has_value()) << said_of(read);
  EXPECT_EQ(read->packets, 14u);
  EXPECT_EQ(read->length, std::chrono::nanoseconds(1'144'795'248));
  ASSERT_EQ(read->sources.size(), 1u);
  const Source& source = read->sources[0];
  EXPECT_EQ(source.protocol, Protocol::sacn);
  EXPECT_EQ(source.name, "house desk");
  EXPECT_EQ(source.cid[0], 0x40);
  EXPECT_EQ(source.universes, std::set<int>{1});
  EXPECT_FALSE(source.sent_here) << "loopback shows each packet as it arrives";
  ASSERT_EQ(read->dmx.size(), 14u);
  EXPECT_EQ(read->dmx[0].at, Duration{});
  const auto first = sacn::decode(read->dmx[0].bytes), last = sacn::decode(read->dmx[13].bytes);
  ASSERT_TRUE(first && last);
  EXPECT_EQ(first->sequence, 8);
  EXPECT_EQ(first->slots, (std::vector<std::uint8_t>{0x89, 0x76, 10, 20, 0, 0, 0, 0}));
  EXPECT_TRUE(last->terminated);
}

TEST(PcapFile, ACaptureByTcpdumpIsRead) {
  const auto read = read_recording(recorded("artdmx_by_tcpdump_on_any.pcap"), {});
  ASSERT_TRUE(read.has_value()) << said_of(read);
  ASSERT_EQ(read->sources.size(), 1u);
  EXPECT_EQ(read->sources[0].name, "127.0.0.2:6454");
  EXPECT_EQ(read->sources[0].universes, std::set<int>{0x121});
  ASSERT_EQ(read->dmx.size(), 1u);
  EXPECT_EQ(artnet::decode_dmx(read->dmx[0].bytes)->slots, (std::vector<std::uint8_t>{10, 20, 30, 40}));
}

TEST(PcapFile, EveryTruncationIsRefusedOrEndsBetweenTwoPackets) {
  std::ifstream in(recorded("artdmx_by_tcpdump_on_any.pcap"), std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  for (std::size_t size = 1; size < whole.size(); ++size) {
    PcapBytes file;
    file.bytes().assign(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    const auto read = file.checked();
    EXPECT_EQ(read.has_value(), size == 24) << size;
    if (size > 24) {
      EXPECT_NE(said_of(read).find("a.pcap:0:0: packet 1: "), std::string::npos) << said_of(read);
    }
  }
}

TEST(PcapFile, WhatIsNoRecordingIsRefused) {
  PcapBytes other(195);  // IEEE 802.15.4
  EXPECT_NE(said_of(other.checked()).find("link type"), std::string::npos);
  PcapBytes text;
  const std::string words = "# a plan, or another text";
  text.bytes().assign(words.begin(), words.end());
  EXPECT_NE(said_of(text.checked()).find("give a pcap or pcapng file"), std::string::npos);
  EXPECT_NE(said_of(read_recording("/dev/zero", {})).find("this is no file"), std::string::npos);
  EXPECT_NE(said_of(read_recording("/nowhere/a.pcap", {})).find("No such file"), std::string::npos);
}

TEST(PcapFile, APacketThatTheCaptureCutIsNamed) {
  CaptureBytes packet = udp_packet(kDeskAddress, 5568, kOwnAddress, 5568, test::sacn_packet(1, 0, {1, 2}));
  PcapBytes file;
  file.add(0, packet);
  packet.resize(96);
  file.add(1, packet, 666);
  EXPECT_EQ(said_of(file.checked()),
            "a.pcap:0:0: packet 2: it is cut to 96 of its 666 bytes: capture whole packets: tcpdump -s 0, tshark "
            "without -s");
}

TEST(PcapFile, AClockThatJumpsAWeekIsNamed) {
  PcapBytes file;
  file.add(0, {1});
  file.add(700'000, {1});
  EXPECT_NE(said_of(file.checked()).find("a.pcap:0:0: packet 2: its time is "), std::string::npos);
}

TEST(PcapFile, PacketsAreSortedByTimeAndCountFromTheEarliest) {
  const auto dmx = [](std::uint8_t value) {
    return udp_packet(kDeskAddress, 6454, kOwnAddress, 6454, test::artdmx_packet(3, 0, {value}));
  };
  PcapBytes file;
  file.add(2, dmx(2));
  file.add(1, dmx(1));
  file.add(4, {0x60});  // nothing of ours
  const Recording read = file.read();
  EXPECT_EQ(read.length, std::chrono::seconds(3));
  ASSERT_EQ(read.dmx.size(), 2u);
  EXPECT_EQ(read.dmx[0].at, Duration{});
  EXPECT_EQ(read.dmx[0].bytes[18], 1);
  EXPECT_EQ(read.dmx[1].at, std::chrono::seconds(1));
}

TEST(PcapFile, SourcesAreToldApartByCidOrAddress) {
  auto one = test::sacn_packet(1, 0, {1}), other = test::sacn_packet(2, 0, {1});
  other[22] = 0xCD;
  PcapBytes file;
  file.add(0, udp_packet(kDeskAddress, 5568, kOwnAddress, 5568, one));
  file.add(1, udp_packet(kOwnAddress, 5568, kDeskAddress, 5568, one));  // the same, by another way
  file.add(2, udp_packet(kDeskAddress, 5568, kOwnAddress, 5568, other));
  file.add(3, udp_packet(kDeskAddress, 6454, kOwnAddress, 6454, test::artdmx_packet(0, 0, {})));
  file.add(4, udp_packet(kOwnAddress, 6454, kDeskAddress, 6454, test::artdmx_packet(0, 0, {})));
  const Recording read = file.read();
  ASSERT_EQ(read.sources.size(), 4u);
  EXPECT_EQ(read.sources[0].packets, 2u);
  EXPECT_EQ(read.sources[3].name, "10.0.0.1:6454");
}

TEST(PcapFile, MoreSourcesThanARigCanHaveAreRefused) {
  PcapBytes file;
  auto packet = test::sacn_packet(1, 0, {1});
  CaptureBytes all;
  for (int i = 0; i <= 1000; ++i) {
    packet[22] = static_cast<std::uint8_t>(i >> 8);
    packet[23] = static_cast<std::uint8_t>(i);
    PcapBytes one;
    one.add(i * 0.001, udp_packet(kDeskAddress, 5568, kOwnAddress, 5568, packet));
    all.insert(all.end(), one.bytes().begin() + 24, one.bytes().end());
  }
  file.bytes() = joined({file.bytes(), all});
  EXPECT_NE(said_of(file.checked()).find("packet 1001: it is by source 1001 of DMX"), std::string::npos);
}

TEST(PcapFile, CanFramesAreCountedAndDrivesSayTheirPositions) {
  PcapBytes file(227);
  file.add(0, {0, 0, 1, 0x85, 7, 0, 0, 0, 0x37, 0x02, 0x10, 0x27, 0, 0, 1});        // node 5 at 10000
  file.add(1, {0, 0, 1, 0x85, 7, 0, 0, 0, 0x37, 0x02, 0xF0, 0xD8, 0xFF, 0xFF, 1});  // -10000
  file.add(2, {0, 0, 0, 0x80, 0, 0, 0, 0});                                         // SYNC
  file.add(3, {0x20, 0, 0, 4, 8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});                 // an error frame
  const Recording read = file.read();
  EXPECT_EQ(read.can_frames, (std::map<std::uint32_t, std::size_t>{{0x80, 1}, {0x185, 2}}));
  ASSERT_EQ(read.drives.size(), 1u);
  EXPECT_EQ(read.drives.at(5).least, -10000);
  EXPECT_EQ(read.drives.at(5).greatest, 10000);
}

TEST(PcapFile, ModbusIsReadOnItsPortAndOnTheRigs) {
  for (const int port : {502, 1502}) {
    PcapBytes file;
    file.add(0, tcp_packet(kOwnAddress, 40000, kServerAddress, port, 5, 0x18, {0, 9, 0, 0, 0, 6, 1, 3, 0, 2, 0, 2}));
    file.add(0.1, tcp_packet(kServerAddress, port, kOwnAddress, 40000, 6, 0x18,
                             {0, 9, 0, 0, 0, 7, 1, 3, 4, 0, 2, 0x49, 0xF0}));
    EXPECT_EQ(file.read().modbus.size(), port == 502 ? 1u : 0u);
    EXPECT_EQ(file.read({1502}).modbus.size(), 1u);
  }
}

}  // namespace
}  // namespace luxrig::recording
