#include "tools/luxrig/monitor_picture.h"

#include <gtest/gtest.h>

namespace luxrig {
namespace {

using nlohmann::json;

TEST(MonitorPicture, ShowsSlotsByAddressAndOmitsDarkRows) {
  std::vector<int> slots(512, 0);
  slots[0] = 255, slots[40] = 7;
  const json universes = {{{"bus", "dmx"}, {"universe", 3}, {"silent", false}, {"slots", slots}}};
  const json status = json::parse(R"({"rig":"hall","phase":"holding","detail":"all well",
    "alarms":[{"severe":true,"text":"the cable is out"}],
    "devices":[{"name":"dmx","life":"active","sent":12,"errors":0,"last_ok_s":0.02,"detail":""}],
    "fixtures":[{"name":"spot","drive":0.5,"level":0.25,"pan_deg":12.34,"tilt_deg":-5,"moves":true,"identified":true},
                {"name":"wash","drive":1.0,"level":1.0,"pan_deg":0,"tilt_deg":0}],
    "luxmeters":[{"name":"desk","life":"active","lux":301.26,"age_s":0.4},{"name":"wall","life":"faulted"}]})");
  const std::string text = monitor_picture(status, universes, 80);
  EXPECT_NE(text.find("hall: holding: all well\nALARM    the cable is out\n"), std::string::npos) << text;
  EXPECT_NE(text.find("dmx, universe 3\n   1 255   ·"), std::string::npos) << text;
  // 80 columns hold 16 slots per row: address 41 is the ninth in the row of 33.
  EXPECT_NE(text.find("\n  33   ·   ·   ·   ·   ·   ·   ·   ·   7   ·"), std::string::npos) << text;
  EXPECT_EQ(text.find("\n  17 "), std::string::npos);
  EXPECT_NE(text.find("████    "), std::string::npos) << text;
  EXPECT_NE(text.find("12.3"), std::string::npos);
  EXPECT_NE(text.find("← this one"), std::string::npos);
  EXPECT_NE(text.find("301.3"), std::string::npos);
  EXPECT_NE(text.find("faulted"), std::string::npos);
}

TEST(MonitorPicture, ShowsWhyAHeadIsDarkAndWhatItWaitsFor) {
  const json status = json::parse(R"({"rig":"hall","fixtures":[
    {"name":"spot","moves":true,"parked":true,"waits_for":"the next plan"},
    {"name":"wash","moves":true,"kept_dark":true,"waits_for":"its beam to be clear of keep-out zone \"stage\""},
    {"name":"old","moves":true,"kept_dark":true},
    {"name":"lit","moves":true}]})");
  const std::string text = monitor_picture(status, json::array(), 80);
  EXPECT_NE(text.find("parked, waits for the next plan\n"), std::string::npos) << text;
  EXPECT_NE(text.find("kept dark, waits for its beam to be clear of keep-out zone \"stage\"\n"), std::string::npos)
      << text;
  EXPECT_NE(text.find("kept dark\n"), std::string::npos) << text;
  const std::size_t lit = text.find("\nlit");
  ASSERT_NE(lit, std::string::npos) << text;
  EXPECT_EQ(text.find("dark", lit), std::string::npos) << text;
}

TEST(MonitorPicture, ToleratesInvalidStatus) {
  for (const char* status :
       {"null", "[]", "7", "{}", R"({"alarms":7,"devices":{},"fixtures":[[],null],"luxmeters":[1]})",
        R"({"fixtures":[{"name":5,"drive":"x"}]})"}) {
    for (const char* universes : {"null", "7", "{}", R"([{"slots":[1,"x",null,-5,1e300]}])", "[[],7,null]"}) {
      EXPECT_FALSE(monitor_picture(json::parse(status), json::parse(universes), -3).empty());
    }
  }
}

}  // namespace
}  // namespace luxrig
