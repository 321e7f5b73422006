#include <gtest/gtest.h>

#include "tests/folders.h"
#include "tests/tools/recording/capture_bytes.h"

namespace luxrig::recording {
namespace {

std::string said_of_show(const std::string& text) { return said_of(read_ola_show(text, "a.ola")); }

void expect_said(const std::string& text, const std::string& begin) {
  EXPECT_TRUE(said_of_show(text).starts_with(begin)) << said_of_show(text);
}

/// By ola_recorder 0.10.9: four frames, 653, 820 and 1845 ms apart.
TEST(OlaShow, AFileByOlaRecorderIsRead) {
  const auto read = read_recording(test::source_folder() / "tests/data/recordings/show_by_ola_recorder.ola", {});
  ASSERT_TRUE(read.has_value()) << said_of(read);
  EXPECT_EQ(read->length, std::chrono::milliseconds(653 + 820 + 1845));
  ASSERT_EQ(read->sources.size(), 1u);
  EXPECT_EQ(read->sources[0].protocol, Protocol::ola);
  EXPECT_EQ(read->sources[0].universes, std::set<int>{1});
  std::vector<std::pair<int, int>> firsts;  // ms, slot 1
  for (const DmxPacket& packet : read->dmx)
    firsts.emplace_back(std::chrono::duration_cast<std::chrono::milliseconds>(packet.at).count(), packet.bytes[0]);
  // Repeated every 0.8 s while nothing changes, as a desk does.
  EXPECT_EQ(firsts, (std::vector<std::pair<int, int>>{
                        {0, 0}, {653, 40}, {1453, 40}, {1473, 120}, {2273, 120}, {3073, 120}, {3318, 255}}));
  EXPECT_EQ(read->dmx[0].bytes, (std::vector<std::uint8_t>{0, 100, 50, 200}));
}

TEST(OlaShow, EmptySlotsAreZeroAndLinesMayEndAsOnWindows) {
  const auto read = read_ola_show("OLA Show\r\n3 ,7,,255\r\n10\r\n4 1\r\n0\r\n3 2", "a.ola");
  ASSERT_TRUE(read.has_value()) << said_of(read);
  ASSERT_EQ(read->dmx.size(), 3u);
  EXPECT_EQ(read->dmx[0].bytes, (std::vector<std::uint8_t>{0, 7, 0, 255}));
  EXPECT_EQ(read->dmx[1].universe, 4);
  EXPECT_EQ(read->dmx[2].at, std::chrono::milliseconds(10));
}

TEST(OlaShow, ABadLineIsNamed) {
  expect_said("OLA Show V2\n1 2\n", "a.ola:1:1: the format \"OLA Show V2\" is not kno");
  expect_said("OLA Show\n", "a.ola:2:1: there is no frame in it:");
  expect_said("OLA Show\n1,2\n", "a.ola:2:1: \"1,2\" does not begin with a universe: ");
  expect_said("OLA Show\n1 2,256\n", "a.ola:2:1: \"256\" is no value of a slot: w");
  expect_said("OLA Show\n1 2\n-5\n", "a.ola:3:1: \"-5\" is no number of millisecon");
  expect_said("OLA Show\n1 2\n604800001\n", "a.ola:3:1: \"604800001\" is no n");
  expect_said("OLA Show\n99999 2\n", "a.ola:2:1: \"99999 2\" does not");
  std::string long_line = "OLA Show\n1 0";
  for (int i = 0; i < 512; ++i) long_line += ",0";
  expect_said(long_line, "a.ola:2:1: it has more than 512 slots: ");
  EXPECT_NE(said_of_show("OLA Show\n1 2\n604800000\n1 3\n").find("too much is to be repeated"), std::string::npos);
}

}  // namespace
}  // namespace luxrig::recording
