/// Each driver's statement of its outputs' behaviour when data stops.
#include "drivers/when_data_stops.h"

#include <gtest/gtest.h>

#include "core/rig/register_map/register_map.h"
#include "tests/drivers/test_rig.h"

namespace luxrig {
namespace {

TEST(WhenDataStops, IsStatedByEveryDriverThatCarriesLamps) {
  for (const DriverEntry& entry : drivers()) {
    if (entry.name == "canopen") {
      EXPECT_EQ(entry.when_data_stops, nullptr);
      continue;
    }
    Rig rig = rig_with(bus_of(std::string(entry.name)));
    if (entry.name.starts_with("modbus")) {
      rig.fixtures.emplace_back().patch = ModbusPatch{};
    } else {
      add_dmx(rig, "lamp", 1, 1);
    }
    const auto outputs = outputs_without_data(rig);
    ASSERT_EQ(outputs.size(), 1u) << entry.name;
    EXPECT_FALSE(outputs[0].lamp.by.empty()) << entry.name;
    EXPECT_FALSE(told(outputs[0].lamp).empty()) << entry.name;
    EXPECT_FALSE(outputs[0].axes);
  }
}

TEST(WhenDataStops, FollowsTheStandardOrTheDevice) {
  const auto lamp_on = [](const char* driver) {
    Rig rig = rig_with(bus_of(driver));
    add_dmx(rig, "lamp", 1, 1);
    return outputs_without_data(rig)[0].lamp;
  };
  EXPECT_EQ(told(lamp_on("sacn")), "noticed after 2.5 s; then its maker's choice");
  EXPECT_EQ(told(lamp_on("artnet")), "holds its last level");
  EXPECT_EQ(told(lamp_on("enttec_pro")), "holds its last level");
  EXPECT_EQ(told(lamp_on("udmx")), "holds its last level");
  EXPECT_EQ(told(lamp_on("open_dmx")), "noticed after 1 s; then its maker's choice");
}

TEST(WhenDataStops, OfAModbusProductFollowsItsRegisterMap) {
  Rig rig = rig_with(bus_of("modbus_tcp", {{"host", std::string("127.0.0.1")}}));
  auto map = std::make_shared<RegisterMap>();
  map->name = "product";
  ModbusPatch patch;
  patch.map = map;
  rig.fixtures.emplace_back().patch = patch;
  EXPECT_EQ(outputs_without_data(rig)[0].lamp.does, WithoutData::holds);
  map->when_data_stops = DataLoss::watchdog;
  map->stops_after = std::chrono::milliseconds(1500);
  EXPECT_EQ(told(outputs_without_data(rig)[0].lamp), "goes dark after 1.5 s");
  EXPECT_EQ(outputs_without_data(rig)[0].lamp.by, "product, its watchdog, which Luxrig arms");
  map->when_data_stops = DataLoss::dark;
  EXPECT_EQ(outputs_without_data(rig)[0].lamp.by, "product");
  std::get<ModbusPatch>(rig.fixtures[0].patch).map.reset();
  EXPECT_EQ(told(outputs_without_data(rig)[0].lamp), "nobody says");
}

TEST(WhenDataStops, AxesStopAfterThreeHeartbeats) {
  for (const bool release : {false, true}) {
    Rig rig = rig_with(bus_of("sacn"));
    rig.buses.push_back(bus_of("canopen", {{"interface", std::string("can0")},
                                           {"heartbeat_ms", std::int64_t{250}},
                                           {"on_stop", std::string(release ? "release" : "hold")}}));
    add_dmx(rig, "yoke", 1, 1).axes.emplace().bus = 1;
    const auto outputs = outputs_without_data(rig);
    ASSERT_TRUE(outputs[0].axes);
    EXPECT_EQ(told(*outputs[0].axes), release ? "pan and tilt stop after 0.75 s and are switched off"
                                              : "pan and tilt stop after 0.75 s and hold their place");
  }
}

}  // namespace
}  // namespace luxrig
