// Recordings of a real rig in tested shows: the lamps follow the recorded desk, the daemon the recorded meters.
#include "tools/scenario/replay.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <fstream>

#include "tests/core/rig/listed_problems.h"
#include "tests/folders.h"
#include "tests/loopback_desk.h"
#include "tests/tools/recording/capture_bytes.h"
#include "tools/scenario/explore.h"
#include "tools/scenario/scenario_file.h"
#include "tools/scenario/stepped_show.h"

namespace luxrig::scenario {
namespace {

using recording::PcapBytes;

PreparedRig prepared_rig(const char* name) {
  auto made = prepare(test::source_folder() / "tests/rigs" / name, {});
  EXPECT_TRUE(made.has_value()) << (made ? "" : test::listed(made.error()));
  return std::move(*made);
}

/// A folder with recordings; scenarios name them from there.
class RecordingFolder {
 public:
  RecordingFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "luxrig-replay-XXXXXX").string();
    EXPECT_NE(::mkdtemp(name.data()), nullptr);
    path_ = name;
  }
  ~RecordingFolder() { std::filesystem::remove_all(path_); }
  RecordingFolder(const RecordingFolder&) = delete;
  RecordingFolder& operator=(const RecordingFolder&) = delete;

  void write(const char* name, const std::vector<std::uint8_t>& bytes) const {
    std::ofstream(path_ / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  [[nodiscard]] Checked<Scenario> scenario(const std::string& rest, const Rig& rig, double length_s = 30) const {
    return parse_scenario(fmt::format("[scenario]\nname = \"t\"\nlength_s = {}\n{}", length_s, rest), path_ / "t.toml",
                          rig);
  }

 private:
  std::filesystem::path path_;
};

/// What failed, in lines; empty if nothing did.
std::string failures_of(const Outcome& outcome) {
  std::string text = outcome.error;
  for (const auto* list : {&outcome.expectations, &outcome.rules})
    for (const Judged& one : *list)
      if (!one.held) text += one.expected + ": " + one.found + "\n";
  return text;
}

/// A desk on universe 101, where the rig `visitors` hears it, for ten seconds: bulb at 20 %, from 4 s on at 50 %. Its
/// plan has 79 %.
PcapBytes recorded_desk(int priority = 100, const std::string& source = "desk") {
  PcapBytes file;
  for (int i = 0; i < 100; ++i) {
    test::DeskSlots slots(512, 0);
    slots[19] = i < 40 ? 51 : 128;
    auto packet = test::sacn_packet(101, static_cast<std::uint8_t>(i), slots, priority);
    std::fill_n(packet.begin() + 44, 64, std::uint8_t{0});
    std::copy(source.begin(), source.end(), packet.begin() + 44);
    file.add(0.1 * i, recording::udp_packet(recording::kDeskAddress, 5568, recording::kOwnAddress, 5568, packet));
  }
  return file;
}

TEST(Replay, TheLampsFollowARecordedDesk) {
  const PreparedRig prepared = prepared_rig("visitors");
  const RecordingFolder folder;
  folder.write("desk.pcap", recorded_desk().bytes());
  const auto scenario = folder.scenario(
      "[[event]]\nname = \"it\"\nat_s = 12\ndo = \"replay\"\nrecording = \"desk.pcap\"\n"
      "[[expect]]\nalways = \"level bulb <= 0.205\"\nafter = \"it\"\nfrom_s = 2.5\nwithin_s = 1.4\n"
      "[[expect]]\nalways = \"level bulb >= 0.195\"\nafter = \"it\"\nfrom_s = 2.5\nwithin_s = 1.4\n"
      "[[expect]]\nalways = \"level bulb >= 0.495\"\nafter = \"it\"\nfrom_s = 4.5\nwithin_s = 5\n"
      "[[expect]]\nalways = \"level bulb <= 0.505\"\nafter = \"it\"\nfrom_s = 2.5\nwithin_s = 7\n"
      "[[expect]]\nat_end = \"level bulb > 0.7\"\n[[expect]]\nat_end = \"phase holding\"\n",
      prepared.session->rig, 40);
  ASSERT_TRUE(scenario.has_value()) << test::listed(scenario.error());
  EXPECT_EQ(failures_of(run_stepped(prepared, *scenario, 1)), "");
  // It is the same again from its own text.
  const auto again =
      folder.scenario(to_toml(*scenario).substr(to_toml(*scenario).find("\n[[event]]")), prepared.session->rig, 40);
  ASSERT_TRUE(again.has_value()) << test::listed(again.error());
  EXPECT_EQ(to_toml(*again).substr(to_toml(*again).find("[[event]]")),
            to_toml(*scenario).substr(to_toml(*scenario).find("[[event]]")));
}

TEST(Replay, ForSEndsItBeforeItsEnd) {
  const PreparedRig prepared = prepared_rig("visitors");
  const RecordingFolder folder;
  folder.write("desk.pcap", recorded_desk().bytes());
  const auto scenario = folder.scenario(
      "[[event]]\nname = \"it\"\nat_s = 12\ndo = \"replay\"\nrecording = \"desk.pcap\"\nfor_s = 3.5\n"
      "[[expect]]\nalways = \"level bulb > 0.7\"\nafter = \"it\"\nfrom_s = 6\nwithin_s = 3\n",
      prepared.session->rig, 40);
  ASSERT_TRUE(scenario.has_value()) << test::listed(scenario.error());
  EXPECT_EQ(failures_of(run_stepped(prepared, *scenario, 1)), "");
}

TEST(Replay, ASourceCountsByTheRulesOfTheDrivers) {
  const PreparedRig prepared = prepared_rig("visitors");
  const Rig& rig = prepared.session->rig;
  const auto bulb_at = [&](PcapBytes file, double at_s) -> std::optional<double> {
    Replay replay(rig, std::make_shared<const recording::Recording>(file.read()), Time{});
    std::optional<double> drive;
    for (Time now{}; now <= Time{} + from_seconds(at_s); now += std::chrono::milliseconds(20)) {
      drive.reset();
      for (const DeskCommand& command : replay.desk(now))
        if (rig.fixtures[command.fixture].name == "bulb") drive = command.drive;
    }
    return drive;
  };
  EXPECT_EQ(bulb_at(recorded_desk(), 1.4), std::nullopt) << "E1.31: a new source counts after 1.5 s";
  EXPECT_NEAR(bulb_at(recorded_desk(), 1.6).value_or(-1), 0.2, 1e-9);
  EXPECT_NEAR(bulb_at(recorded_desk(), 9).value_or(-1), 128 / 255.0, 1e-9);
  EXPECT_EQ(bulb_at(recorded_desk(), 13), std::nullopt) << "lost";
  PcapBytes both = recorded_desk(90);
  PcapBytes second;
  for (int i = 0; i < 100; ++i) {
    auto packet = test::sacn_packet(101, static_cast<std::uint8_t>(i), test::DeskSlots(512, 25), 110);
    packet[22] = 0x77;  // another CID
    second.add(0.1 * i, recording::udp_packet(recording::kDeskAddress, 5568, recording::kOwnAddress, 5568, packet));
  }
  both.bytes().insert(both.bytes().end(), second.bytes().begin() + 24, second.bytes().end());
  EXPECT_NEAR(bulb_at(both, 9).value_or(-1), 25 / 255.0, 1e-9) << "the higher priority";
}

TEST(Replay, WhatIsNotForTheRigIsSaidAtItsPlace) {
  const PreparedRig prepared = prepared_rig("visitors");
  const Rig& rig = prepared.session->rig;
  const RecordingFolder folder;
  const auto said = [&](const std::string& keys) {
    const auto scenario = folder.scenario("[[event]]\nat_s = 1\ndo = \"replay\"\n" + keys, rig);
    return scenario ? std::string("read") : scenario.error().front().text();
  };
  EXPECT_NE(said("").find("t.toml:4:1: "), std::string::npos) << said("");
  EXPECT_NE(said("recording = \"no.pcap\"\n").find("t.toml:7:13: \"no.pcap\": No such file"), std::string::npos);
  folder.write("own.pcap", recorded_desk(100, "Luxrig visitors").bytes());
  EXPECT_NE(said("recording = \"own.pcap\"\n").find("t.toml:7:13: nothing in \"own.pcap\" is for this rig"),
            std::string::npos);
  PcapBytes cut = recorded_desk();
  cut.bytes().pop_back();
  folder.write("cut.pcap", cut.bytes());
  EXPECT_NE(said("recording = \"cut.pcap\"\n").find("t.toml:7:13: \"cut.pcap\": packet 100: "), std::string::npos);
  folder.write("bad.ola", {'O', 'L', 'A', ' ', 'S', 'h', 'o', 'w', '\n', 'x', '\n'});
  EXPECT_NE(said("recording = \"bad.ola\"\n").find("t.toml:7:13: \"bad.ola\": line 2: \"x\" does not begin"),
            std::string::npos);
  folder.write("desk.pcap", recorded_desk().bytes());
  EXPECT_NE(said("recording = \"desk.pcap\"\nvalue = 1\n").find("value has no effect on replay"), std::string::npos);
}

TEST(Replay, AShowByOlaIsHeardOnItsUniverse) {
  const PreparedRig prepared = prepared_rig("visitors");
  const RecordingFolder folder;
  std::string show = "OLA Show\n101 0";
  for (int i = 1; i < 19; ++i) show += ",0";
  show += ",153\n9000\n101 0\n";
  folder.write("show.ola", {show.begin(), show.end()});
  const auto scenario = folder.scenario(
      "[[event]]\nname = \"it\"\nat_s = 12\ndo = \"replay\"\nrecording = \"show.ola\"\n"
      "[[expect]]\nalways = \"level bulb >= 0.59\"\nafter = \"it\"\nfrom_s = 3\nwithin_s = 5\n",
      prepared.session->rig);
  ASSERT_TRUE(scenario.has_value()) << test::listed(scenario.error());
  EXPECT_EQ(failures_of(run_stepped(prepared, *scenario, 1)), "");
}

/// Unit 1 at 127.0.0.1:1502, as the rig `room` reads its meter-1: so many lux, ten times a second.
PcapBytes recorded_meter(double lux, double seconds) {
  using recording::big16, recording::big32, recording::joined;
  PcapBytes file;
  const recording::CaptureBytes loopback = {127, 0, 0, 1};
  std::uint32_t asked = 1, answered = 1;
  for (int i = 0; i < static_cast<int>(seconds * 10); ++i) {
    const auto transaction = big16(static_cast<std::size_t>(i));
    const auto request = joined({transaction, {0, 0, 0, 6, 1, 3, 0, 2, 0, 2}});
    const auto answer = joined({transaction, {0, 0, 0, 7, 1, 3, 4}, big32(static_cast<std::size_t>(lux * 1000))});
    file.add(0.1 * i, recording::tcp_packet(loopback, 40000, loopback, 1502, asked, 0x18, request));
    file.add(0.1 * i + 0.01, recording::tcp_packet(loopback, 1502, loopback, 40000, answered, 0x18, answer));
    asked += static_cast<std::uint32_t>(request.size());
    answered += static_cast<std::uint32_t>(answer.size());
  }
  return file;
}

TEST(Replay, TheDaemonCorrectsByRecordedReadings) {
  const PreparedRig prepared = prepared_rig("room");
  const RecordingFolder folder;
  folder.write("meter.pcap", recorded_meter(180, 60).bytes());
  const auto scenario = folder.scenario(
      "deviations = \"none\"\nstart = \"dark\"\n"
      "[[event]]\nat_s = 0\ndo = \"replay\"\nrecording = \"meter.pcap\"\n"
      "[[event]]\nat_s = 1\ndo = \"apply\"\n"
      "[[expect]]\nalways = \"reading meter-1 == 180\"\nfrom_s = 2\nwithin_s = 50\n"
      "[[expect]]\nreached = \"lux plinth-top < 135\"\nfrom_s = 20\nwithin_s = 30\n",
      prepared.session->rig, 60);
  ASSERT_TRUE(scenario.has_value()) << test::listed(scenario.error());
  EXPECT_EQ(failures_of(run_stepped(prepared, *scenario, 1)), "");
}

}  // namespace
}  // namespace luxrig::scenario
