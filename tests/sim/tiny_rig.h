#pragma once
// A small rig built in code: two DMX fixtures (one a head) on "dmx", one Modbus dimmer and two meters on "field", one
// limited point. Its light is a matrix, so no ray is traced.

#include "core/rig/rig.h"
#include "sim/world/world.h"

namespace luxrig::sim {

inline Rig tiny_rig(const std::string& dmx_driver = "sacn") {
  Rig rig;
  rig.name = "tiny";
  Luminaire bulb;
  bulb.name = "bulb";
  bulb.lumens = 1000;
  bulb.intensity = make_isotropic(1000);
  rig.luminaires = {bulb};
  rig.buses.resize(2);
  rig.buses[0].name = "dmx";
  rig.buses[0].driver = dmx_driver;
  rig.buses[1].name = "field";
  rig.buses[1].driver = "modbus_tcp";

  Fixture spot;
  spot.name = "spot-1";
  spot.world_from_mount.translation_m = {0, 0, 3};
  spot.bus = 0;
  spot.patch = DmxPatch{1, 1, {DmxSlot{}}};
  Fixture head = spot;
  head.name = "head-1";
  head.moves = true;
  head.pan_speed_rad_s = kPi;
  head.tilt_speed_rad_s = kPi / 2;
  head.patch = DmxPatch{1,
                        10,
                        {{SlotUse::pan, 0},
                         {SlotUse::pan_fine, 0},
                         {SlotUse::tilt, 0},
                         {SlotUse::tilt_fine, 0},
                         {SlotUse::dimmer, 0},
                         {SlotUse::dimmer_fine, 0},
                         {SlotUse::constant, 255}}};
  Fixture lamp = spot;
  lamp.name = "bulb-1";
  lamp.bus = 1;
  lamp.patch = ModbusPatch{10, 0, 1000};
  rig.fixtures = {spot, head, lamp};

  Point table;
  table.name = "table";
  table.goal_lx = 150;
  table.max_lx = 200;
  rig.points = {table};
  for (int m = 0; m < 2; ++m) {
    Luxmeter meter;
    meter.name = "meter-" + std::to_string(m + 1);
    meter.bus = 1;
    meter.tolerance = 0.04;
    meter.patch.unit = m + 1;
    meter.patch.first_register = 2;
    rig.luxmeters.push_back(meter);
  }
  return rig;
}

// Rows: table, meter-1, meter-2.
inline Eigen::MatrixXd tiny_light() {
  Eigen::MatrixXd light(3, 3);
  light << 100, 50, 200,  //
      100, 50, 200,       //
      30, 40, 20;
  return light;
}

inline std::unique_ptr<World> tiny_world(const Rig& rig, const Deviations& deviations = Deviations::none()) {
  return std::move(*World::make(rig, deviations, tiny_light()));
}

inline Time at_s(double seconds) { return Time{} + from_seconds(seconds); }

}  // namespace luxrig::sim
