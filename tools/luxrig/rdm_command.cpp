// rdm: lists the devices behind Art-Net nodes or a USB widget, reads their settings and changes them.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <memory>
#include <nlohmann/json.hpp>

#include "drivers/dmx/artnet/artnet_codec.h"
#include "drivers/usb/usb_search.h"
#include "tools/command_line/choice.h"
#include "tools/luxrig/commands.h"
#include "tools/luxrig/rdm_bus.h"
#include "tools/luxrig/rdm_stubs.h"
#include "tools/terminal/command.h"
#include "tools/terminal/table.h"

namespace luxrig {
namespace {

using Json = nlohmann::json;

/// Devices on the DMX lines behind Art-Net nodes or a USB widget.
struct RdmArguments {
  std::string node;  ///< address, with or without port; empty: all nodes that answer a broadcast
  std::string broadcast = "255.255.255.255";
  std::optional<int> universe;  ///< Art-Net port address; none = all
  double seconds = 3;
  bool rediscover = false;
  bool usb = false;                         ///< a widget's line instead of nodes
  std::string usb_serial, usb_port, usbip;  ///< selects the widget; any of them implies `usb`
  bool json = false, toml = false;
  std::string uid, parameter, value;
};

int refuse_input(const std::string& text) {
  fmt::print(stderr, "luxrig: {}\n", text);
  return kExitBadInput;
}

/// The whole text as a number from `least` to `most`.
std::optional<int> number_between(const std::string& text, int least, int most) {
  int value = 0;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  if (parsed.ec != std::errc() || parsed.ptr != end || value < least || value > most) return std::nullopt;
  return value;
}

/// "10.0.0.7" or "10.0.0.7:6454".
std::optional<SocketAddress> address_of(const std::string& text) {
  const auto colon = text.find(':');
  const auto ipv4 = parse_ipv4(text.substr(0, colon));
  if (!ipv4 || *ipv4 == 0 || is_multicast(*ipv4)) return std::nullopt;
  SocketAddress address{*ipv4, artnet::kPort};
  if (colon == std::string::npos) return address;
  const auto port = number_between(text.substr(colon + 1), 1, 65535);
  if (!port) return std::nullopt;
  address.port = static_cast<std::uint16_t>(*port);
  return address;
}

std::string text_of_json(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// Searches the line of a widget. Prints a problem and returns nothing if an argument is wrong.
std::optional<Result<RdmBus>> find_widget(const RdmArguments& arguments) {
  RdmWidgetSearch search{arguments.usb_serial, arguments.usb_port, std::nullopt, arguments.universe.value_or(1)};
  if (!arguments.node.empty()) {
    refuse_input("--node and a USB widget are two places to ask: give one of them");
    return std::nullopt;
  }
  if (!search.port.empty() && !is_port_path(search.port)) {
    refuse_input(
        fmt::format("--usb-port {} is no USB port: write it as `ls /sys/bus/usb/devices` shows it", search.port));
    return std::nullopt;
  }
  if (!arguments.usbip.empty()) {
    const auto server = address_of(arguments.usbip);
    if (!server || arguments.usbip.find(':') == std::string::npos) {
      refuse_input(fmt::format("--usbip {} is no IPv4 address with a port: such as 127.0.0.1:3240", arguments.usbip));
      return std::nullopt;
    }
    search.server = Redirect{text_of(server->ipv4), server->port};
  }
  return RdmBus::find(search);
}

/// Looks for nodes and their tables. Prints a problem and returns nothing if an argument is wrong.
std::optional<Result<RdmBus>> find_bus(const RdmArguments& arguments) {
  if (arguments.usb || !arguments.usb_serial.empty() || !arguments.usb_port.empty() || !arguments.usbip.empty())
    return find_widget(arguments);
  const std::string& where = arguments.node.empty() ? arguments.broadcast : arguments.node;
  const auto address = address_of(where);
  if (!address) {
    refuse_input(fmt::format("{} {} is no IPv4 address to ask: write numbers, such as 2.0.0.10",
                             arguments.node.empty() ? "--broadcast" : "--node", where));
    return std::nullopt;
  }
  return RdmBus::find({*address, !arguments.node.empty(), arguments.universe, arguments.seconds, arguments.rediscover});
}

Json rdm_device_json(const PatchedDevice& device, const std::string& node) {
  const rdm::DeviceProfile& profile = device.profile;
  Json out = {{"uid", text_of(profile.uid)},
              {"node", node},
              {"universe", device.universe},
              {"manufacturer", profile.manufacturer},
              {"model", profile.model},
              {"model_id", profile.info.model},
              {"category", rdm::name_of_category(profile.info.category)},
              {"label", profile.label},
              {"software", profile.software},
              {"footprint", profile.info.footprint_slots},
              {"personality", profile.info.personality},
              {"personalities", profile.info.personalities},
              {"sub_devices", profile.info.sub_devices}};
  if (profile.info.start_address) out["address"] = *profile.info.start_address;
  if (profile.personality) out["personality_text"] = profile.personality->text;
  if (profile.lamp_hours) out["lamp_hours"] = *profile.lamp_hours;
  if (profile.device_hours) out["device_hours"] = *profile.device_hours;
  if (profile.lamp) out["lamp_state"] = rdm::text_of(*profile.lamp);
  if (const auto names = slot_names(profile); !names.empty()) out["slots"] = names;
  Json sensors = Json::array();
  for (const rdm::SensorState& sensor : profile.sensors) {
    Json one = {{"name", sensor.definition.description},
                {"type", rdm::name_of_sensor_type(sensor.definition.type)},
                {"unit", rdm::name_of_unit(sensor.definition.unit)}};
    if (sensor.value) one["value"] = text_of(sensor.definition, sensor.value->present);
    sensors.push_back(std::move(one));
  }
  out["sensors"] = std::move(sensors);
  return out;
}

std::vector<std::string> row_of(const PatchedDevice& device) {
  const rdm::DeviceProfile& profile = device.profile;
  std::string sensors;
  for (const rdm::SensorState& sensor : profile.sensors) {
    sensors += fmt::format("{}{} {}", sensors.empty() ? "" : ", ", sensor.definition.description,
                           sensor.value ? text_of(sensor.definition, sensor.value->present) : "?");
  }
  std::string personality = fmt::format("{}/{}", profile.info.personality, profile.info.personalities);
  if (profile.personality) personality += " " + profile.personality->text;
  return {text_of(profile.uid),
          profile.manufacturer,
          profile.model.empty() ? fmt::format("model {}", profile.info.model) : profile.model,
          profile.label,
          fmt::format("{}", device.universe),
          profile.info.start_address ? fmt::format("{}", *profile.info.start_address) : "-",
          fmt::format("{}", profile.info.footprint_slots),
          std::move(personality),
          std::move(sensors)};
}

/// The line of a device; prints a problem if it is on none.
const RdmUniverse* line_with(const RdmBus& bus, const rdm::Uid& uid) {
  const RdmUniverse* line = bus.line_of(uid);
  if (line != nullptr) return line;
  std::size_t others = 0;
  for (const RdmUniverse& universe : bus.universes()) others += universe.uids.size();
  fmt::print(stderr, "luxrig: {} is on no line: {} nodes answer, with {} other devices; --rediscover searches anew\n",
             text_of(uid), bus.nodes(), others);
  return nullptr;
}

/// The data that a GET needs besides the parameter: the number of a sensor or a personality.
std::optional<std::vector<std::uint8_t>> index_of(rdm::Pid pid, const std::string& index) {
  if (pid == rdm::Pid::sensor_definition || pid == rdm::Pid::sensor_value) {
    const auto number = number_between(index.empty() ? "0" : index, 0, 254);
    return number ? std::optional(std::vector{static_cast<std::uint8_t>(*number)}) : std::nullopt;
  }
  if (pid == rdm::Pid::dmx_personality_description) {
    const auto number = number_between(index.empty() ? "1" : index, 1, 255);
    return number ? std::optional(std::vector{static_cast<std::uint8_t>(*number)}) : std::nullopt;
  }
  return index.empty() ? std::optional(std::vector<std::uint8_t>{}) : std::nullopt;
}

struct Setting {
  rdm::Pid pid{};
  std::vector<std::uint8_t> data;
};

/// The setting that a person wants; else how to mend the request.
tl::expected<Setting, std::string> setting_of(const std::string& what, const std::string& value) {
  if (what == "address") {
    const auto address = number_between(value, 1, 512);
    if (!address) return tl::unexpected(fmt::format("{} is no start address: use 1 to 512", value));
    return Setting{rdm::Pid::dmx_start_address, rdm::encode_start_address(*address)};
  }
  if (what == "personality") {
    const auto number = number_between(value, 1, 255);
    if (!number) return tl::unexpected(fmt::format("{} is no personality: use 1 to 255", value));
    return Setting{rdm::Pid::dmx_personality, {static_cast<std::uint8_t>(*number)}};
  }
  if (what == "identify") {
    if (value != "on" && value != "off") return tl::unexpected(fmt::format("{} is neither on nor off", value));
    return Setting{rdm::Pid::identify_device, {static_cast<std::uint8_t>(value == "on" ? 1 : 0)}};
  }
  const bool printable =
      std::all_of(value.begin(), value.end(), [](char letter) { return letter >= 0x20 && letter < 0x7F; });
  if (value.size() > rdm::kMaxLabel || !printable) {
    return tl::unexpected(fmt::format("a label has at most {} plain (ASCII) characters: use fewer", rdm::kMaxLabel));
  }
  return Setting{rdm::Pid::device_label, {value.begin(), value.end()}};
}

int run_rdm_list(const RdmArguments& arguments) {
  const auto found = find_bus(arguments);
  if (!found) return kExitBadInput;
  if (!*found) return report(found->error());
  const RdmBus& bus = **found;
  std::vector<PatchedDevice> devices;
  Json all = Json::array();
  Table table(
      {"UID", "manufacturer", "model", "label", ">universe", ">address", ">footprint", "personality", "sensors"});
  bool failed = false;
  for (const RdmUniverse& universe : bus.universes()) {
    if (!universe.complete) {
      fmt::print(stderr, "universe {} of {}: its table of devices is not complete: --seconds {:.0f} waits longer\n",
                 universe.universe, universe.node, 2 * arguments.seconds);
    }
    for (const rdm::Uid& uid : universe.uids) {
      const rdm::Ask ask = [&universe](const rdm::Request& request) { return RdmBus::ask(universe, request); };
      auto profile = rdm::read_profile(ask, uid);
      if (!profile) {
        failed = true;
        report(profile.error());
        continue;
      }
      devices.push_back({universe.universe, std::move(*profile)});
      table.row(row_of(devices.back()));
      all.push_back(rdm_device_json(devices.back(), universe.node));
    }
  }
  if (arguments.json) {
    fmt::print("{}\n", text_of_json(all));
  } else if (arguments.toml) {
    fmt::print("{}", fixture_stubs(devices));
  } else if (!devices.empty()) {
    fmt::print("{}", table.text());
  } else {
    fmt::print("nothing found: {} nodes answer, with {} universes\n", bus.nodes(), bus.universes().size());
  }
  return failed ? kExitFailed : kExitOk;
}

int run_rdm_get(const RdmArguments& arguments) {
  const auto uid = rdm::parse_uid(arguments.uid);
  if (!uid || is_broadcast(*uid)) return refuse_input(arguments.uid + " is no UID: such as 7ff0:00000001");
  const auto pid = rdm::parse_pid(arguments.parameter);
  if (!pid) {
    return refuse_input(arguments.parameter + " is no parameter that is known here: such as device_info, or 0x8001");
  }
  const auto index = index_of(*pid, arguments.value);
  if (!index) return refuse_input(fmt::format("{} of {} is not to be had", arguments.value, text_of(*pid)));
  const auto found = find_bus(arguments);
  if (!found) return kExitBadInput;
  if (!*found) return report(found->error());
  const RdmUniverse* line = line_with(**found, *uid);
  if (line == nullptr) return kExitFailed;
  const auto data = RdmBus::ask(*line, {*uid, rdm::CommandClass::get, *pid, *index});
  if (!data) return report(data.error());
  std::string text = rdm::describe(*pid, *data);
  if (const auto value = rdm::decode_sensor_value(*data); value && *pid == rdm::Pid::sensor_value) {
    const auto about = RdmBus::ask(*line, {*uid, rdm::CommandClass::get, rdm::Pid::sensor_definition, *index});
    const auto definition = about ? rdm::decode_sensor_definition(*about) : std::nullopt;
    if (definition) text = fmt::format("{} {}", definition->description, text_of(*definition, value->present));
  }
  if (arguments.json) {
    fmt::print("{}\n",
               text_of_json({{"uid", text_of(*uid)}, {"parameter", text_of(*pid)}, {"value", text}, {"data", *data}}));
  } else {
    fmt::print("{}\n", text);
  }
  return kExitOk;
}

int run_rdm_set(const RdmArguments& arguments) {
  const auto uid = rdm::parse_uid(arguments.uid);
  if (!uid || is_broadcast(*uid)) return refuse_input(arguments.uid + " is no UID: such as 7ff0:00000001");
  const auto setting = setting_of(arguments.parameter, arguments.value);
  if (!setting) return refuse_input(setting.error());
  const auto found = find_bus(arguments);
  if (!found) return kExitBadInput;
  if (!*found) return report(found->error());
  const RdmUniverse* line = line_with(**found, *uid);
  if (line == nullptr) return kExitFailed;
  if (auto done = RdmBus::ask(*line, {*uid, rdm::CommandClass::set, setting->pid, setting->data}); !done) {
    return report(done.error());
  }
  // Read it back: a device may round or limit a value.
  const auto after = RdmBus::ask(*line, {*uid, rdm::CommandClass::get, setting->pid});
  if (!after) return report(after.error());
  const std::string text = rdm::describe(setting->pid, *after);
  if (arguments.json) {
    fmt::print("{}\n", text_of_json({{"uid", text_of(*uid)}, {"parameter", text_of(setting->pid)}, {"value", text}}));
  } else {
    fmt::print("{}: {}\n", text_of(*uid), text);
  }
  return kExitOk;
}

void add_search(CLI::App& command, RdmArguments& rdm) {
  command.add_option("--node", rdm.node, "ask this node only (IPv4 address, with or without :port)");
  command.add_option("--broadcast", rdm.broadcast, "where nodes are asked: the lighting network's");
  command
      .add_option("--universe", rdm.universe, "only this Art-Net port address; of a widget, what its line is called")
      ->check(CLI::Range(0, 32767));
  command.add_option("--seconds", rdm.seconds, "how long to wait for the nodes' tables of devices")
      ->check(CLI::Range(0.1, 600.0));
  command.add_flag("--rediscover", rdm.rediscover, "have the nodes search their lines anew");
  command.add_flag("--usb", rdm.usb, "on the line of an ENTTEC DMX USB Pro, which puts out no levels meanwhile");
  command.add_option("--usb-serial", rdm.usb_serial, "of the widget with this serial number");
  command.add_option("--usb-port", rdm.usb_port, "of the widget that is plugged in there, such as 1-1.4");
  command.add_option("--usbip", rdm.usbip,
                     "of a widget behind this USB/IP server, such as a simulated one (IPv4:port)");
  command.add_flag("--json", rdm.json, "print JSON");
}

Action declare_rdm(CLI::App& command) {
  const auto rdm = std::make_shared<RdmArguments>();
  command.require_subcommand(1);
  auto* list = command.add_subcommand("list", "a table of all devices");
  add_search(*list, *rdm);
  list->add_flag("--toml", rdm->toml, "print [[fixture]] entries for a rig file");
  auto* get = command.add_subcommand("get", "read one parameter of a device");
  get->add_option("UID", rdm->uid, "which device")->required();
  get->add_option("PARAMETER", rdm->parameter, "its name (device_info, lamp_hours …) or number (0x8001)")->required();
  get->add_option("INDEX", rdm->value, "of which sensor (from 0) or personality (from 1)");
  add_search(*get, *rdm);
  auto* set = command.add_subcommand("set", "set one parameter of a device");
  set->add_option("UID", rdm->uid, "which device")->required();
  set->add_option("PARAMETER", rdm->parameter, "which")
      ->required()
      ->check(one_of({"address", "label", "personality", "identify"}));
  set->add_option("VALUE", rdm->value, "1 to 512, a text, a number, on or off")->required();
  add_search(*set, *rdm);
  return [rdm, list, get] { return *list ? run_rdm_list(*rdm) : *get ? run_rdm_get(*rdm) : run_rdm_set(*rdm); };
}

}  // namespace

const Command kRdmCommand{"rdm", command_group::kDevices,
                          "list, read and set devices behind Art-Net nodes or a USB widget", declare_rdm};

}  // namespace luxrig
