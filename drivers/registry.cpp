#include "drivers/registry.h"

#include <fmt/format.h>

#include "core/rig/null_bus.h"
#include "core/text/nearest.h"
#include "drivers/can/canopen_driver.h"
#include "drivers/dmx/artnet/artnet_driver.h"
#include "drivers/dmx/enttec_pro/enttec_pro_driver.h"
#include "drivers/dmx/open_dmx/open_dmx_driver.h"
#include "drivers/dmx/sacn/sacn_driver.h"
#include "drivers/dmx/udmx/udmx_driver.h"
#include "drivers/modbus/modbus_data_loss.h"
#include "drivers/modbus/modbus_rtu_driver.h"
#include "drivers/modbus/modbus_tcp_driver.h"

namespace luxrig {
namespace {

constexpr std::string_view kOnlyTheWidget =
    "the widget answers, lamps do not; a broken line or a dead lamp is noticed only by a luxmeter or camera";
constexpr std::string_view kUnits =
    "each unit answers; a dead lamp is noticed where its register map has failure bits, else only by a luxmeter or "
    "camera";

// One line per driver.
const DriverEntry kDrivers[] = {
    {"sacn", "ANSI E1.31 over UDP, send", sacn_options(), check_sacn, make_sacn, sacn_when_data_stops,
     "nothing comes back; a dead node or lamp is noticed only by a luxmeter or camera"},
    {"artnet", "Art-Net 4 over UDP, send", artnet_options(), check_artnet, make_artnet, artnet_when_data_stops,
     "nodes answer polls, lamps do not; a dead lamp is noticed only by a luxmeter or camera"},
    {"enttec_pro", "ENTTEC DMX USB Pro widget, holds its last look", enttec_pro_options(), check_enttec_pro,
     make_enttec_pro, enttec_pro_when_data_stops, kOnlyTheWidget},
    {"open_dmx", "ENTTEC Open DMX or FTDI cable, silent without Luxrig", open_dmx_options(), check_open_dmx,
     make_open_dmx, open_dmx_when_data_stops, kOnlyTheWidget},
    {"udmx", "uDMX widget, holds its last look", udmx_options(), check_udmx, make_udmx, udmx_when_data_stops,
     kOnlyTheWidget},
    {"modbus_tcp", "Modbus TCP dimmers and luxmeters", modbus_tcp_options(), check_modbus_tcp, make_modbus_tcp,
     modbus_when_data_stops, kUnits},
    {"modbus_rtu", "Modbus RTU dimmers and luxmeters on RS-485", modbus_rtu_options(), check_modbus_rtu,
     make_modbus_rtu, modbus_when_data_stops, kUnits},
    {"canopen", "CiA 402 pan-tilt axes over CAN", canopen_options(), check_canopen, make_canopen, nullptr, ""},
};

}  // namespace

std::span<const DriverEntry> drivers() { return kDrivers; }

const DriverEntry* find_driver(std::string_view name) {
  for (const DriverEntry& entry : kDrivers) {
    if (entry.name == name) return &entry;
  }
  return nullptr;
}

std::string_view what_comes_back(const Bus& bus) {
  return is_null_bus(bus) ? "nothing: it is a null bus" : find_driver(bus.driver)->comes_back;
}

std::vector<Problem> check_buses(const Rig& rig) {
  std::vector<std::string_view> names;
  for (const DriverEntry& entry : kDrivers) names.push_back(entry.name);
  names.push_back(kNullDriver);
  std::vector<Problem> problems;
  for (std::size_t i = 0; i < rig.buses.size(); ++i) {
    const Bus& bus = rig.buses[i];
    if (is_null_bus(bus)) continue;
    const DriverEntry* entry = find_driver(bus.driver);
    if (entry == nullptr) {
      problems.push_back({rig.file.string(), bus.in_file.line, bus.in_file.column,
                          fmt::format("bus \"{}\" has an unknown driver \"{}\"", bus.name, bus.driver),
                          mend_for_unknown(bus.driver, names, "no driver is built in")});
      continue;
    }
    const std::vector<Problem> found = entry->check(rig, i);
    problems.insert(problems.end(), found.begin(), found.end());
  }
  return problems;
}

}  // namespace luxrig
