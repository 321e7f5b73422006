#include "tools/recording/of_rig.h"

#include <algorithm>

#include "drivers/dmx/artnet/artnet_codec.h"
#include "drivers/dmx/sacn/sacn_source.h"
#include "drivers/io/host_id.h"
#include "drivers/modbus/modbus_registers.h"
#include "drivers/options.h"
#include "drivers/registry.h"

namespace luxrig::recording {
namespace {

constexpr std::string_view kSacn = "sacn", kArtnet = "artnet", kModbusTcp = "modbus_tcp";

template <class Take>
void for_each_bus(const Rig& rig, std::string_view driver, const Take& take) {
  for (std::size_t b = 0; b < rig.buses.size(); ++b)
    if (rig.buses[b].driver == driver) take(b, rig.buses[b], find_driver(driver)->options);
}

bool is_loopback(std::uint32_t ipv4) { return ipv4 >> 24 == 127; }

}  // namespace

std::set<std::uint16_t> modbus_ports(const Rig& rig) {
  std::set<std::uint16_t> ports;
  for_each_bus(rig, kModbusTcp, [&](std::size_t, const Bus& bus, auto docs) {
    ports.insert(static_cast<std::uint16_t>(integer_option(bus, docs, "port")));
  });
  return ports;
}

std::vector<DeskBus> desk_buses(const Rig& rig) {
  std::vector<DeskBus> buses;
  for (const auto& [driver, protocol] : {std::pair(kSacn, Protocol::sacn), std::pair(kArtnet, Protocol::artnet)})
    for_each_bus(rig, driver, [&, protocol = protocol](std::size_t b, const Bus& bus, auto docs) {
      DeskBus found{b, protocol, desk_options(bus, docs), {}, 0};
      if (!found.desk.rules) return;
      for (const Fixture& fixture : rig.fixtures)
        if (fixture.bus == b) found.universes.insert(std::get<DmxPatch>(fixture.patch).universe + found.desk.offset);
      // As the driver does: in standby only sources count that receivers prefer.
      if (protocol == Protocol::sacn && found.desk.rules->mode == DeskMode::standby)
        found.lowest_priority = static_cast<int>(integer_option(bus, docs, "priority"));
      buses.push_back(std::move(found));
    });
  return buses;
}

std::vector<bool> own_sources(const Recording& recording, const Rig& rig) {
  std::vector<bool> own(recording.sources.size(), false);
  std::set<std::uint32_t> hosts = recording.modbus_clients;
  for_each_bus(rig, kSacn, [&](std::size_t, const Bus& bus, auto docs) {
    std::string name = string_option(bus, docs, "source_name");
    if (name.empty()) name = "Luxrig " + rig.name;
    const auto cid =
        sacn::parse_cid(string_option(bus, docs, "cid")).value_or(sacn::derive_cid(host_id(), rig.name, bus.name));
    for (std::size_t s = 0; s < own.size(); ++s) {
      const Source& source = recording.sources[s];
      if (source.protocol != Protocol::sacn || (source.cid != cid && source.name != name)) continue;
      own[s] = true;
      hosts.insert(source.address.ipv4);
    }
  });
  for (std::size_t s = 0; s < own.size(); ++s) {
    const Source& source = recording.sources[s];
    if (source.protocol != Protocol::artnet) continue;
    own[s] = source.sent_here || (hosts.contains(source.address.ipv4) && !is_loopback(source.address.ipv4));
  }
  return own;
}

bool hears(const DeskBus& bus, const Recording& recording, const DmxPacket& packet) {
  const Protocol protocol = recording.sources[packet.source].protocol;
  if (protocol != bus.protocol && protocol != Protocol::ola) return false;
  return !packet.universe || bus.universes.contains(*packet.universe);
}

std::vector<std::vector<MeterReading>> meter_readings(const Recording& recording, const Rig& rig) {
  std::vector<std::vector<MeterReading>> all(rig.luxmeters.size());
  std::map<std::size_t, SocketAddress> servers;  // by bus
  for_each_bus(rig, kModbusTcp, [&](std::size_t b, const Bus& bus, auto docs) {
    servers[b] = {parse_ipv4(string_option(bus, docs, "host")).value_or(0),
                  static_cast<std::uint16_t>(integer_option(bus, docs, "port"))};
  });
  for (std::size_t m = 0; m < rig.luxmeters.size(); ++m) {
    const Luxmeter& meter = rig.luxmeters[m];
    const auto server = servers.find(meter.bus);
    if (server == servers.end()) continue;
    const ModbusMeterPatch& patch = meter.patch;
    const auto function = patch.input_registers ? modbus::Function::read_input : modbus::Function::read_holding;
    for (const ModbusExchange& exchange : recording.modbus) {
      const modbus::Request& asked = exchange.request;
      if (exchange.server != server->second || asked.unit != patch.unit || asked.function != function ||
          patch.first_register < asked.first_register)
        continue;
      const auto at = static_cast<std::size_t>(patch.first_register - asked.first_register);
      const auto registers = static_cast<std::size_t>(patch.registers);
      if (at + registers > exchange.values.size()) continue;
      const auto words = std::span<const std::uint16_t>(exchange.values).subspan(at, registers);
      if (const auto lux = modbus::plausible_lux(modbus::lux_from_registers(patch, words), meter.range_lx))
        all[m].push_back({exchange.at, *lux});
    }
  }
  return all;
}

int number_of(const Recording& recording, const DmxPacket& packet) {
  if (recording.sources[packet.source].protocol == Protocol::ola) return 0;
  if (const auto data = sacn::decode(packet.bytes)) return data->sequence;
  if (const auto sync = sacn::decode_sync(packet.bytes)) return sync->sequence;
  const auto dmx = artnet::decode_dmx(packet.bytes);
  return dmx ? dmx->sequence : 0;
}

std::vector<std::uint8_t> datagram_of(const Recording& recording, const DmxPacket& packet, Protocol protocol,
                                      int number, const std::optional<sacn::Cid>& cid) {
  const Source& source = recording.sources[packet.source];
  const auto counted = [&](int recorded) { return static_cast<std::uint8_t>((recorded + number) & 0xFF); };
  // 1 to 255; 0 says that the sender does not count.
  const auto artnet_counted = [&](int recorded) {
    return static_cast<std::uint8_t>(recorded == 0 ? 0 : (recorded - 1 + number) % 255 + 1);
  };
  if (source.protocol == Protocol::ola) {
    if (protocol == Protocol::artnet) {
      artnet::Dmx dmx{artnet_counted(1), 0, *packet.universe, packet.bytes};
      if (dmx.slots.size() % 2 != 0) dmx.slots.push_back(0);  // Art-Net has an even number
      return artnet::encode(dmx);
    }
    sacn::DataPacket data;
    data.cid = cid.value_or(sacn::derive_cid("recording", source.name, ""));
    data.source_name = source.name;
    data.universe = static_cast<std::uint16_t>(*packet.universe);
    data.sequence = counted(0);
    data.slots = packet.bytes;
    return sacn::encode(data);
  }
  if (auto data = sacn::decode(packet.bytes)) {
    data->sequence = counted(data->sequence);
    if (cid) data->cid = *cid;
    return sacn::encode(*data);
  }
  if (auto sync = sacn::decode_sync(packet.bytes)) {
    sync->sequence = counted(sync->sequence);
    if (cid) sync->cid = *cid;
    return sacn::encode(*sync);
  }
  if (auto dmx = artnet::decode_dmx(packet.bytes)) {
    dmx->sequence = artnet_counted(dmx->sequence);
    return artnet::encode(*dmx);
  }
  return packet.bytes;
}

}  // namespace luxrig::recording
