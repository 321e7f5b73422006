#include "drivers/modbus/modbus_tcp_driver.h"

#include <fmt/format.h>

#include "drivers/io/datagram.h"
#include "drivers/modbus/modbus_driver.h"
#include "drivers/modbus/modbus_patch_check.h"
#include "drivers/modbus/modbus_tcp_link.h"
#include "drivers/options.h"

namespace luxrig {
namespace {

constexpr OptionDoc kModbusTcpOptions[] = {
    {"host", "text", "", "required", "an IPv4 address", "the Modbus TCP server: a device or a gateway"},
    {"port", "whole number", "", "502", "1 to 65535", "its TCP port"},
    {"response_timeout_ms", "whole number", "ms", "200", "20 to 5000",
     "how long one request may take; gateways to slow serial lines need up to 1000"},
    {"refresh_ms", "whole number", "ms", "400", "100 to 10000",
     "unchanged dimmer values are written again this often, so that a restarted dimmer gets its level back"},
    {"poll_ms", "whole number", "ms", "200", "20 to 10000", "each luxmeter is read this often"},
    modbus::kContactInputOption,
    modbus::kContactUnitOption,
    modbus::kContactWhenOption,
};

Duration tcp_option_ms(const Bus& bus, std::string_view key) {
  return std::chrono::milliseconds(integer_option(bus, kModbusTcpOptions, key));
}

}  // namespace

std::span<const OptionDoc> modbus_tcp_options() { return kModbusTcpOptions; }

std::vector<Problem> check_modbus_tcp(const Rig& rig, std::size_t bus) {
  const Bus& entry = rig.buses[bus];
  std::vector<Problem> problems = check_options(rig, entry, kModbusTcpOptions);
  ModbusLineRules rules;
  if (problems.empty()) {
    rules.refresh = tcp_option_ms(entry, "refresh_ms");
    const std::string host = string_option(entry, kModbusTcpOptions, "host");
    const auto address = parse_ipv4(host);
    if (!address || *address == 0 || is_multicast(*address) || *address == 0xFFFFFFFF) {
      problems.push_back(problem_at(rig, entry, "host", fmt::format("host = \"{}\" is no IPv4 address", host),
                                    "write numbers, such as \"192.168.1.30\" (a name would need a resolver, which may "
                                    "block)"));
    }
  }
  if (problems.empty())
    problems = modbus::check_contact(rig, entry, kModbusTcpOptions, rules.first_unit, rules.last_unit);
  check_modbus_patches(rig, bus, rules, problems);
  return problems;
}

std::unique_ptr<Driver> make_modbus_tcp(const Rig& rig, std::size_t bus, const std::optional<Redirect>& redirect) {
  const Bus& entry = rig.buses[bus];
  ModbusTiming timing;
  timing.response_timeout = std::chrono::milliseconds(integer_option(entry, kModbusTcpOptions, "response_timeout_ms"));
  timing.refresh = tcp_option_ms(entry, "refresh_ms");
  timing.poll = tcp_option_ms(entry, "poll_ms");
  timing.contact = modbus::contact_patch(entry, kModbusTcpOptions);
  timing.behind_gateway = true;
  auto link =
      redirect ? std::make_unique<modbus::TcpLink>(redirect->host, redirect->port)
               : std::make_unique<modbus::TcpLink>(string_option(entry, kModbusTcpOptions, "host"),
                                                   static_cast<int>(integer_option(entry, kModbusTcpOptions, "port")));
  return std::make_unique<ModbusDriver>(std::move(link), timing, rig, bus);
}

}  // namespace luxrig
