#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "sim/wire/dmx_endpoint.h"
#include "tools/luxrig-sim/control_http.h"

namespace luxrig::sim {
namespace {

using Json = nlohmann::ordered_json;

enum class DeviceKind { bus, fixture, axis, luxmeter };

constexpr std::pair<std::string_view, std::string_view> kProtocols[] = {
    {"sacn", "sACN (E1.31)"},         {"artnet", "Art-Net"},        {"modbus_tcp", "Modbus TCP"},
    {"modbus_rtu", "Modbus RTU"},     {"canopen", "CAN datagrams"}, {"enttec_pro", "USB/IP, Enttec DMX USB Pro"},
    {"open_dmx", "USB/IP, Open DMX"}, {"udmx", "USB/IP, uDMX"}};

std::string_view protocol_of(const Bus& bus) {
  const auto known = std::find_if(std::begin(kProtocols), std::end(kProtocols),
                                  [&](const auto& entry) { return entry.first == bus.driver; });
  return known == std::end(kProtocols) ? std::string_view(bus.driver) : known->second;
}

// Whether the page offers the fault for a device: no more than a help in choosing. POST /fault takes any.
bool worth_offering(FaultKind fault, DeviceKind kind, const Bus& bus) {
  const bool serial = bus.driver == "modbus_rtu", modbus = serial || bus.driver == "modbus_tcp";
  const bool network = bus.driver == "sacn" || bus.driver == "artnet", can = bus.driver == "canopen";
  switch (fault) {
    case FaultKind::stuck:
      return kind == DeviceKind::luxmeter || kind == DeviceKind::axis;
    case FaultKind::lying:
      return kind == DeviceKind::luxmeter;
    case FaultKind::reset:
    case FaultKind::unmappable:
      return kind == DeviceKind::axis;
    case FaultKind::lamp_failure:
      return kind == DeviceKind::fixture;
    case FaultKind::bus_off:
      return kind == DeviceKind::bus && can;
    case FaultKind::pressed:
      return kind == DeviceKind::bus && bus.options.contains("blackout_input");
    case FaultKind::checksum:
    case FaultKind::truncated:
    case FaultKind::gap:
    case FaultKind::noise:
    case FaultKind::wrong_unit:
    case FaultKind::wrong_function:
      return serial;
    case FaultKind::exception:
      return modbus || (kind == DeviceKind::bus && !network && !can);
    case FaultKind::unpowered:
      return kind == DeviceKind::fixture || kind == DeviceKind::luxmeter;
    case FaultKind::duplicated:
      return modbus || can || (network && kind == DeviceKind::bus);
    case FaultKind::reordered:
      return network && kind == DeviceKind::bus;
    case FaultKind::slow:
    case FaultKind::garbled:
      return kind == DeviceKind::bus || modbus || can;
    case FaultKind::lost:
    case FaultKind::silent:
    case FaultKind::dead:
      return true;
  }
  return true;
}

Json device_json(const std::string& name, DeviceKind kind, const Bus& bus) {
  constexpr std::string_view kNames[] = {"bus", "fixture", "axis", "luxmeter"};
  Json device = {{"name", name}, {"kind", kNames[static_cast<std::size_t>(kind)]}, {"faults", Json::array()}};
  for (const FaultKind fault : all_faults())
    if (worth_offering(fault, kind, bus)) device["faults"].push_back(name_of(fault));
  return device;
}

// "uint32", with the order of its words and bytes where it is not the usual one.
void put_format(Json& into, const RegisterFormat& format) {
  const char* number = format.number == RegisterNumber::floating       ? "float"
                       : format.number == RegisterNumber::signed_whole ? "int"
                                                                       : "uint";
  into["type"] = fmt::format("{}{}", number, 16 * format.registers);
  if (format.low_word_first) into["word_order"] = "low first";
  if (format.low_byte_first) into["byte_order"] = "low first";
}

Json bus_json(const Rig& rig, std::size_t b, const EndpointPlace& place) {
  const Bus& bus = rig.buses[b];
  Json json = {{"name", bus.name}, {"driver", bus.driver}, {"protocol", protocol_of(bus)}};
  if (place.path.empty()) {
    json["host"] = address_text(place.address);
    json["port"] = place.port;
  } else {
    json["path"] = place.path;
  }
  if (const auto universes = universes_of(rig, b); !universes.empty()) {
    json["universes"] = universes;
    if (bus.driver == "sacn" && place.among_others)
      for (const int universe : universes) json["multicast"].push_back(address_text(sacn_group(universe)));
  }
  std::set<int> units, nodes;
  for (const Fixture& fixture : rig.fixtures) {
    if (const auto* patch = std::get_if<ModbusPatch>(&fixture.patch); patch != nullptr && fixture.bus == b)
      units.insert(patch->unit);
    if (fixture.axes && fixture.axes->bus == b) nodes.insert({fixture.axes->pan.node, fixture.axes->tilt.node});
  }
  for (const Luxmeter& meter : rig.luxmeters)
    if (meter.bus == b) units.insert(meter.patch.unit);
  if (!units.empty()) json["units"] = units;
  if (!nodes.empty()) json["nodes"] = nodes;
  return json;
}

Json fixture_json(const Rig& rig, const Fixture& fixture) {
  Json json = {{"name", fixture.name}, {"bus", rig.buses[fixture.bus].name}};
  if (const auto* dmx = std::get_if<DmxPatch>(&fixture.patch)) {
    json["universe"] = dmx->universe;
    json["address"] = dmx->address;
    json["slots"] = dmx->slots.size();
  } else if (const auto* modbus = std::get_if<ModbusPatch>(&fixture.patch)) {
    json["unit"] = modbus->unit;
    json[modbus->coil ? "coil" : "register"] = modbus->holding_register;
    if (!modbus->coil) {
      put_format(json, modbus->format);
      json["dark"] = modbus->dark_raw;
      json["full"] = modbus->full_scale_raw;
    }
  }
  if (fixture.axes) {
    json["axes_bus"] = rig.buses[fixture.axes->bus].name;
    json["pan_node"] = fixture.axes->pan.node;
    json["tilt_node"] = fixture.axes->tilt.node;
  }
  return json;
}

}  // namespace

std::string rig_json(const Rig& rig, const std::map<std::string, EndpointPlace>& places, const std::string& world,
                     std::uint64_t seed) {
  Json json = {{"rig", rig.name}, {"world", world}, {"seed", seed}};
  for (const char* list : {"buses", "fixtures", "luxmeters", "cameras", "devices", "faults"})
    json[list] = Json::array();
  for (std::size_t b = 0; b < rig.buses.size(); ++b) {
    if (const auto place = places.find(rig.buses[b].name); place != places.end())
      json["buses"].push_back(bus_json(rig, b, place->second));
    json["devices"].push_back(device_json(rig.buses[b].name, DeviceKind::bus, rig.buses[b]));
  }
  for (const Fixture& fixture : rig.fixtures) {
    json["fixtures"].push_back(fixture_json(rig, fixture));
    json["devices"].push_back(device_json(fixture.name, DeviceKind::fixture, rig.buses[fixture.bus]));
    if (!fixture.axes) continue;
    for (const std::string& axis : {pan_axis_name(fixture), tilt_axis_name(fixture)})
      json["devices"].push_back(device_json(axis, DeviceKind::axis, rig.buses[fixture.axes->bus]));
  }
  for (const Luxmeter& meter : rig.luxmeters) {
    Json one = {{"name", meter.name},
                {"bus", rig.buses[meter.bus].name},
                {"unit", meter.patch.unit},
                {meter.patch.input_registers ? "input_register" : "register", meter.patch.first_register}};
    put_format(one, meter.patch.format());
    one["lux_per_count"] = meter.patch.lux_per_count;
    if (meter.point) one["point"] = rig.points[*meter.point].name;
    json["luxmeters"].push_back(std::move(one));
    json["devices"].push_back(device_json(meter.name, DeviceKind::luxmeter, rig.buses[meter.bus]));
  }
  for (const PictureCamera& camera : rig.cameras) json["cameras"].push_back(camera.name);
  for (const FaultKind kind : all_faults()) {
    const FaultRange range = range_of(kind);
    Json fault = {{"name", name_of(kind)}, {"does", range.does}};
    if (range.valued) fault.update({{"least", range.least}, {"most", range.most}, {"default", range.fallback}});
    json["faults"].push_back(std::move(fault));
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace luxrig::sim
