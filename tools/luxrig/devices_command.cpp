// devices: lists connected devices, without a rig file.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "drivers/io/datagram.h"
#include "drivers/scan/scan.h"
#include "tools/luxrig/commands.h"
#include "tools/process/clock.h"
#include "tools/terminal/command.h"
#include "tools/terminal/table.h"

namespace luxrig {
namespace {

struct DevicesArguments {
  double seconds = 3;
  std::string broadcast = "255.255.255.255", interface;
  bool json = false;
};

constexpr auto kStepPeriod = std::chrono::milliseconds(20);

int run_devices(const DevicesArguments& arguments) {
  ScanOptions options;
  options.broadcast = arguments.broadcast;
  options.interface = arguments.interface;
  const auto broadcast = parse_ipv4(arguments.broadcast);
  if (!broadcast || *broadcast == 0 || is_multicast(*broadcast)) {
    fmt::print(stderr, "luxrig: --broadcast {} is no IPv4 address to send to: write numbers, such as 2.255.255.255\n",
               arguments.broadcast);
    return kExitBadInput;
  }
  std::vector<NamedScan> scans = all_scans(options);
  std::vector<std::string> faults(scans.size());
  const Time start = now(), end = start + from_seconds(arguments.seconds);
  Time told = start;
  do {
    for (std::size_t i = 0; i < scans.size(); ++i) {
      const auto stepped = scans[i].scan->step(now());
      faults[i] = stepped ? "" : stepped.error().detail;
    }
    if (!arguments.json && now() - told >= std::chrono::seconds(2)) {
      told = now();
      fmt::print(stderr, "\rlistening, {:.0f} s more ", to_seconds(end - told));
    }
    std::this_thread::sleep_for(kStepPeriod);
  } while (now() < end);
  if (told != start) fmt::print(stderr, "\r{:30}\r", "");

  nlohmann::json all = nlohmann::json::array();
  Table table({"driver", "address", "name", "detail"});
  for (const NamedScan& one : scans) {
    for (const FoundDevice& device : one.scan->found()) {
      table.row({device.driver, device.address, device.name, device.detail});
      all.push_back(
          {{"driver", device.driver}, {"address", device.address}, {"name", device.name}, {"detail", device.detail}});
    }
  }
  if (arguments.json) {
    fmt::print("{}\n", all.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    fmt::print("{}", all.empty() ? std::string("nothing found\n") : table.text());
  }
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (!faults[i].empty()) fmt::print(stderr, "{} could not be looked for: {}\n", scans[i].what, faults[i]);
    if (faults[i].empty() && from_seconds(arguments.seconds) < scans[i].complete_after) {
      fmt::print(stderr, "{} may be missing: --seconds {:.0f} hears all\n", scans[i].what,
                 std::ceil(to_seconds(scans[i].complete_after)));
    }
  }
  return kExitOk;
}

Action declare_devices(CLI::App& command) {
  const auto devices = std::make_shared<DevicesArguments>();
  command.add_option("--seconds", devices->seconds, "how long to listen")->check(CLI::Range(0.1, 600.0));
  command.add_option("--broadcast", devices->broadcast, "where Art-Net nodes are asked: the lighting network's");
  command.add_option("--interface", devices->interface, "network interface by which sACN sources are heard");
  command.add_flag("--json", devices->json, "print the list as JSON");
  command.footer("Art-Net nodes, sACN sources, USB widgets, serial ports, CAN interfaces, cameras.");
  return [devices] { return run_devices(*devices); };
}

}  // namespace

const Command kDevicesCommand{"devices", command_group::kDevices, "what is there to be driven, without a rig file",
                              declare_devices};

}  // namespace luxrig
