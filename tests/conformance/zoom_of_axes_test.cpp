// A head whose pan and tilt are drives on a CAN bus, while its zoom is a slot of its lamp's DMX address: from the rig
// file over both wires to the simulated head.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>

#include "core/rig/rig_file.h"
#include "drivers/dmx/dmx_patch.h"
#include "sim/devices/dmx_fixture.h"
#include "sim/wire/can/axis_bus.h"
#include "sim/wire/dmx_fixtures.h"
#include "tests/conformance/axes_bench.h"

namespace luxrig {
namespace {

const std::string kZoomingAxes = R"([rig]
name = "stage"
[[luminaire]]
name = "profile"
model = "spot"
lumens = 8000
beam_angle_deg = 20
field_angle_deg = 25
zoom_deg = [10, 50]
[[bus]]
name = "can"
driver = "canopen"
interface = "can0"
[[bus]]
name = "dmx"
driver = "sacn"
[[fixture]]
name = "head"
luminaire = "profile"
position_m = [0, 0, 5]
bus = "dmx"
address = 1
slots = ["dimmer", "zoom", "zoom-fine"]
zoom_speed_deg_s = 20
axes_bus = "can"
pan_node = 5
pan_counts_per_degree = 500
pan_home_deg = -175
pan_range_deg = [-170, 170]
tilt_node = 6
tilt_counts_per_degree = -400
tilt_home_deg = 125
tilt_range_deg = [-120, 120]
)";

Joints aimed(double pan_deg, double tilt_deg, double beam_deg) {
  return {rad_from_deg(pan_deg), rad_from_deg(tilt_deg), rad_from_deg(beam_deg)};
}

TEST(ZoomOfAxes, GoesOutByDmxButPanAndTiltDoNot) {
  const Checked<Rig> rig = parse_rig(kZoomingAxes, "stage.toml", ".");
  ASSERT_TRUE(rig) << rig.error().front().text();
  ASSERT_TRUE(rig->fixtures[0].range.zooms());
  DmxPatchbay bay(*rig, 1);
  EXPECT_TRUE(bay.has_heads());
  const LevelCommand lit{0, 1};
  for (const auto& [beam_deg, value] : {std::pair(10.0, 0), std::pair(50.0, 0xFFFF), std::pair(30.0, 0x8000)}) {
    const AimCommand aim{0, aimed(100, -50, beam_deg)};
    ASSERT_TRUE(bay.set_aims({&aim, 1}));
    ASSERT_TRUE(bay.set_levels({&lit, 1}));
    const DmxSlots& slots = bay.universes()[0].slots;
    EXPECT_EQ(slots[0], 255);
    EXPECT_NEAR(slots[1] << 8 | slots[2], value, 1);
    EXPECT_EQ(slots[3], 0);
  }
  const AimCommand too_wide{0, aimed(0, 0, 51)};
  EXPECT_FALSE(bay.set_aims({&too_wide, 1}));
}

TEST(ZoomOfAxes, TheSimulatedHeadZoomsWhileItsAxesTurnIt) {
  const Checked<Rig> rig = parse_rig(kZoomingAxes, "stage.toml", ".");
  ASSERT_TRUE(rig) << rig.error().front().text();
  AxesBench bench(*rig);
  bench.aim = aimed(40, -30, 50);
  DmxPatchbay bay(*rig, 1);
  std::uint64_t frame = 0;
  bench.each_cycle = [&] {
    const AimCommand aim{0, *bench.aim};
    const LevelCommand lit{0, 1};
    ASSERT_TRUE(bay.set_aims({&aim, 1}));
    ASSERT_TRUE(bay.set_levels({&lit, 1}));
    sim::obey_dmx({bench.rig, 1, *bench.world, bench.faults}, ++frame, [&](int) { return bay.universes()[0].slots; });
  };
  ASSERT_TRUE(bench.arrive()) << (bench.result ? "" : bench.result.error().detail);
  EXPECT_NEAR(deg_from_rad(bench.joints().beam_rad), 50, 0.01);
  bench.run(1);
  // Only the zoom: no axis gets an order, and only the beam width changes.
  const Joints before = bench.joints();
  const Time still = bench.moved_at;
  bench.aim->beam_rad = rad_from_deg(10);
  bench.run(1);
  EXPECT_NEAR(deg_from_rad(bench.joints().beam_rad), 30, 1) << "20 degrees in a second";
  bench.run(2);
  EXPECT_NEAR(deg_from_rad(bench.joints().beam_rad), 10, 0.01);
  EXPECT_EQ(bench.moved_at, still);
  EXPECT_NEAR(bench.joints().pan_rad, before.pan_rad, 1e-9);
  EXPECT_TRUE(bench.result);
}

/// The same lamp by its maker's file: zoom from 8 to 60 degrees, wide at 0. The luminaire uses 10 to 50 degrees.
struct MadeLamp {
  MadeLamp() {
    std::string name = (std::filesystem::temp_directory_path() / "luxrig-lamp-XXXXXX").string();
    folder = ::mkdtemp(name.data());
    std::ofstream(folder / "lamp.json") << R"({
      "$schema": "https://raw.githubusercontent.com/OpenLightingProject/open-fixture-library/master/schemas/fixture.json",
      "name": "Lamp", "categories": ["Other"],
      "meta": {"authors": ["Somebody"], "createDate": "2026-01-01", "lastModifyDate": "2026-01-01"},
      "availableChannels": {
        "Dimmer": {"capability": {"type": "Intensity"}},
        "Zoom": {"fineChannelAliases": ["Zoom fine"],
                 "capability": {"type": "Zoom", "angleStart": "60deg", "angleEnd": "8deg"}}},
      "modes": [{"name": "Basic", "channels": ["Dimmer", "Zoom", "Zoom fine"]}]})";
  }
  ~MadeLamp() {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
  MadeLamp(const MadeLamp&) = delete;
  MadeLamp& operator=(const MadeLamp&) = delete;

  [[nodiscard]] Checked<Rig> rig(const std::string& more = "", const std::string& zoom = "zoom_deg = [10, 50]") const {
    std::string text = kZoomingAxes;
    const auto replace = [&text](const std::string& from, const std::string& to) {
      text.replace(text.find(from), from.size(), to);
    };
    replace("slots = [\"dimmer\", \"zoom\", \"zoom-fine\"]", "personality = \"lamp.json\"\n" + more);
    replace("zoom_deg = [10, 50]", zoom);
    if (zoom.empty()) replace("zoom_speed_deg_s = 20\n", "");
    return parse_rig(text, "stage.toml", folder);
  }

  std::filesystem::path folder;
};

TEST(ZoomOfAxes, FollowsTheMakersFile) {
  const MadeLamp lamp;
  const Checked<Rig> rig = lamp.rig();
  ASSERT_TRUE(rig) << rig.error().front().text();
  const Fixture& head = rig->fixtures[0];
  EXPECT_NEAR(deg_from_rad(head.range.beam_min_rad), 10, 1e-9);
  EXPECT_NEAR(deg_from_rad(head.range.beam_max_rad), 50, 1e-9);
  EXPECT_NEAR(deg_from_rad(head.range.pan_max_rad), 170, 1e-9);
  DmxPatchbay bay(*rig, 1);
  const LevelCommand lit{0, 1};
  for (const double beam_deg : {10.0, 24.0, 50.0}) {
    const AimCommand aim{0, aimed(100, -50, beam_deg)};
    ASSERT_TRUE(bay.set_aims({&aim, 1}));
    ASSERT_TRUE(bay.set_levels({&lit, 1}));
    const DmxSlots& slots = bay.universes()[0].slots;
    EXPECT_EQ(slots[0], 255);
    EXPECT_NEAR(slots[1] << 8 | slots[2], (60 - beam_deg) / 52 * 65535, 1) << beam_deg;
    const sim::DmxOrder order = sim::decode_slots(head, std::get<DmxPatch>(head.patch), slots);
    ASSERT_TRUE(order.beam_rad);
    EXPECT_FALSE(order.joints) << "pan and tilt are its axes'";
    EXPECT_NEAR(deg_from_rad(*order.beam_rad), beam_deg, 0.01);
  }
  EXPECT_NE(rig->fixtures[0].mode->told.back().find("zoom by \"Zoom\", 16 bit at slot 2, 10 to 50"), std::string::npos)
      << rig->fixtures[0].mode->told.back();
}

TEST(ZoomOfAxes, IsHeldForAFixedBeamAndRefusedOutsideTheMakersRange) {
  const MadeLamp lamp;
  const Checked<Rig> held = lamp.rig("", "");
  ASSERT_TRUE(held) << held.error().front().text();
  EXPECT_FALSE(held->fixtures[0].range.zooms());
  EXPECT_EQ(std::get<DmxPatch>(held->fixtures[0].patch).slots[1].use, SlotUse::constant);
  EXPECT_NEAR(std::get<DmxPatch>(held->fixtures[0].patch).slots[1].constant_dmx, (60 - 20) / 52.0 * 255, 1);
  const Checked<Rig> inverted = lamp.rig("zoom_inverted = true\n");
  ASSERT_FALSE(inverted);
  EXPECT_NE(inverted.error().front().text().find("the personality says which end is wide"), std::string::npos);
  const Checked<Rig> beyond = lamp.rig("", "zoom_deg = [1, 7]\n");
  ASSERT_FALSE(beyond);
}

}  // namespace
}  // namespace luxrig
