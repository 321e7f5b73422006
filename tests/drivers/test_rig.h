#pragma once
/// Rigs built in code, so that a driver test needs no file.

#include <string>
#include <utility>
#include <vector>

#include "core/rig/rig.h"
#include "drivers/registry.h"

namespace luxrig {

inline Time at_ms(double ms) { return Time{} + from_seconds(1000.0 + ms / 1000.0); }

inline Bus bus_of(std::string driver, std::vector<std::pair<std::string, OptionValue>> options = {}) {
  Bus bus;
  bus.name = "the-bus";
  bus.driver = std::move(driver);
  bus.in_file = {7, 1};
  int line = 8;
  for (auto& [key, value] : options) bus.options[key] = {value, {line++, 5}};
  return bus;
}

/// A valid value for an option that has no default.
inline std::string required_value(const OptionDoc& doc) {
  return doc.range.find("path") == std::string_view::npos ? "127.0.0.1" : "/dev/luxrig-no-such-port";
}

inline Rig rig_with(Bus bus) {
  Rig rig;
  rig.file = "a/rig.toml";
  rig.name = "test";
  rig.buses.push_back(std::move(bus));
  return rig;
}

inline Fixture& add_dmx(Rig& rig, std::string name, int universe, int address,
                        std::vector<DmxSlot> slots = {DmxSlot{}}) {
  Fixture fixture;
  fixture.name = std::move(name);
  fixture.patch = DmxPatch{universe, address, std::move(slots)};
  fixture.in_file = {20 + static_cast<int>(rig.fixtures.size()), 3};
  rig.fixtures.push_back(std::move(fixture));
  return rig.fixtures.back();
}

inline Fixture& add_head(Rig& rig, std::string name, int universe, int address) {
  Fixture& fixture = add_dmx(rig, std::move(name), universe, address,
                             {{SlotUse::pan},
                              {SlotUse::pan_fine},
                              {SlotUse::tilt},
                              {SlotUse::tilt_fine},
                              {SlotUse::dimmer},
                              {SlotUse::dimmer_fine},
                              {SlotUse::constant, 255}});
  fixture.moves = true;
  fixture.pan_speed_rad_s = fixture.tilt_speed_rad_s = 3;
  return fixture;
}

/// Turns pan and tilt into drives on the first bus: fast, 1000 and -800 counts per degree, home beyond their travel.
inline Fixture& add_axes(Fixture& fixture, int pan_node, int tilt_node) {
  fixture.moves = true;
  fixture.pan_speed_rad_s = rad_from_deg(1000);
  fixture.tilt_speed_rad_s = rad_from_deg(800);
  fixture.axes = AxesPatch{0,
                           {pan_node, 1000, fixture.range.pan_min_rad - rad_from_deg(5), rad_from_deg(10000)},
                           {tilt_node, -800, fixture.range.tilt_max_rad + rad_from_deg(5), rad_from_deg(8000)}};
  return fixture;
}

inline Fixture& add_modbus(Rig& rig, std::string name, int unit, int reg, int full_scale = 1000) {
  Fixture fixture;
  fixture.name = std::move(name);
  fixture.patch = ModbusPatch{unit, reg, full_scale};
  fixture.in_file = {20 + static_cast<int>(rig.fixtures.size()), 3};
  rig.fixtures.push_back(std::move(fixture));
  return rig.fixtures.back();
}

inline Luxmeter& add_meter(Rig& rig, std::string name, int unit, int first_register) {
  Luxmeter meter;
  meter.name = std::move(name);
  meter.patch.unit = unit;
  meter.patch.first_register = first_register;
  meter.range_lx = 100000;
  meter.in_file = {40 + static_cast<int>(rig.luxmeters.size()), 3};
  rig.luxmeters.push_back(std::move(meter));
  return rig.luxmeters.back();
}

}  // namespace luxrig
