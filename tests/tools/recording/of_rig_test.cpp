// What of a recording concerns a rig; and the filter by which its traffic is captured.
#include "tools/recording/of_rig.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/rig/rig_file.h"
#include "drivers/registry.h"
#include "tests/folders.h"
#include "tests/loopback_desk.h"
#include "tests/tools/recording/capture_bytes.h"
#include "tools/recording/capture.h"

namespace luxrig::recording {
namespace {

/// The rig `room` with further keys of its DMX bus.
Rig room(const std::string& keys, const std::string& driver = "sacn") {
  const auto folder = test::source_folder() / "tests/rigs/room";
  std::ifstream in(folder / "rig.toml");
  std::string text((std::istreambuf_iterator<char>(in)), {});
  const std::string line = "driver = \"sacn\"\n";
  text.replace(text.find(line), line.size(), "driver = \"" + driver + "\"\n" + keys + "\n");
  auto rig = parse_rig(text, folder / "rig.toml", folder);
  EXPECT_TRUE(rig.has_value()) << (rig ? "" : rig.error().front().text());
  EXPECT_TRUE(check_buses(*rig).empty());
  return rig ? std::move(*rig) : Rig{};
}

std::vector<bool> own_of(const Recording& recording, const Rig& rig) { return own_sources(recording, rig); }

TEST(OfRig, TheFilterNamesEveryPortOfTheRig) {
  EXPECT_EQ(filter_for(room("input = \"merge\"\ninput_port = 5570"), true).text,
            "udp port 5568 or udp port 5570 or (host 127.0.0.1 and tcp port 1502)");
  EXPECT_EQ(filter_for(room("", "artnet"), true).text, "udp port 6454 or (host 127.0.0.1 and tcp port 1502)");
}

TEST(OfRig, TheFilterSaysWhichBusesNoCaptureSees) {
  Rig rig = room("");
  rig.buses[0].driver = "udmx";
  rig.buses[1].driver = "canopen";
  const CaptureFilter any = filter_for(rig, true), one = filter_for(rig, false);
  EXPECT_EQ(any.text, "ether[14:2] = 12");
  EXPECT_EQ(any.unseen, (std::vector<std::string>{"dmx: udmx is no network, so its traffic cannot be captured here"}));
  EXPECT_EQ(one.text, "");
  EXPECT_EQ(one.unseen.size(), 2u);
}

TEST(OfRig, ABusHearsADeskOnItsUniversesWithTheirOffset) {
  EXPECT_TRUE(desk_buses(room("")).empty());
  const auto buses = desk_buses(room("input = \"standby\"\ninput_offset = 100\npriority = 120"));
  ASSERT_EQ(buses.size(), 1u);
  EXPECT_EQ(buses[0].universes, std::set<int>{101});
  EXPECT_EQ(buses[0].lowest_priority, 120);
}

TEST(OfRig, LuxrigsOwnSacnIsKnownByNameOrCid) {
  Recording recording;
  for (const char* name : {"Luxrig room", "house desk", "renamed"})
    recording.sources.push_back({Protocol::sacn, name, {}, {0x0A000001, 5568}, false, {}, 0});
  recording.sources[2].cid[0] = 0x77;
  EXPECT_EQ(own_of(recording, room("")), (std::vector<bool>{true, false, false}));
  EXPECT_EQ(own_of(recording, room("source_name = \"renamed\"\ncid = \"77000000-0000-0000-0000-000000000000\"")),
            (std::vector<bool>{false, false, true}));
}

TEST(OfRig, LuxrigsOwnArtnetIsWhatItsComputerSends) {
  Recording recording;
  for (const std::uint32_t from : {0x0A000001u, 0x0A000005u, 0x7F000001u})
    recording.sources.push_back({Protocol::artnet, "", {}, {from, 6454}, false, {}, 0});
  recording.sources.push_back({Protocol::artnet, "", {}, {0x0A000009, 6454}, true, {}, 0});
  recording.modbus_clients = {0x0A000001, 0x7F000001};
  EXPECT_EQ(own_of(recording, room("", "artnet")), (std::vector<bool>{true, false, false, true}));
}

/// Unit 1 has its lux in registers 2 and 3, in thousandths; unit 2 the same by default.
TEST(OfRig, ReadingsFollowTheRigsPatch) {
  Recording recording;
  const SocketAddress server{0x7F000001, 1502}, other{0x7F000001, 502};
  const auto read = [&](int s, SocketAddress at, int unit, modbus::Function function, int first,
                        std::vector<std::uint16_t> values) {
    recording.modbus.push_back({std::chrono::seconds(s), at, {unit, function, first, values.size(), {}}, values});
  };
  using enum modbus::Function;
  read(1, server, 1, read_holding, 2, {0x0002, 0x49F0});        // 150 lx
  read(2, server, 1, read_holding, 1, {9, 0x0001, 0x86A0, 9});  // among others: 100 lx
  read(3, server, 1, read_holding, 2, {0xFFFF, 0xFFFF});        // a broken sensor
  read(4, server, 1, read_holding, 3, {1, 1});                  // half of it
  read(4, server, 1, read_input, 2, {1, 1});                    // of other registers
  read(4, other, 1, read_holding, 2, {1, 1});                   // of another device
  read(5, server, 2, read_holding, 2, {0, 500});                // 0.5 lx
  const auto readings = meter_readings(recording, room(""));
  ASSERT_EQ(readings.size(), 2u);
  ASSERT_EQ(readings[0].size(), 2u);
  EXPECT_EQ(readings[0][0].at, std::chrono::seconds(1));
  EXPECT_DOUBLE_EQ(readings[0][0].lux, 150);
  EXPECT_DOUBLE_EQ(readings[0][1].lux, 100);
  ASSERT_EQ(readings[1].size(), 1u);
  EXPECT_DOUBLE_EQ(readings[1][0].lux, 0.5);
  EXPECT_EQ(modbus_ports(room("")), std::set<std::uint16_t>{1502});
}

}  // namespace
}  // namespace luxrig::recording
