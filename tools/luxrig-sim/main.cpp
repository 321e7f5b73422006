// luxrig-sim: a rig's devices on ports of this machine, driven by the simulated world. See README.md.
#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>

#include "core/rig/null_bus.h"
#include "core/rig/rig_file.h"
#include "sim/faults/faults.h"
#include "sim/wire/rig_server.h"
#include "sim/wire/standard_ports.h"
#include "sim/world/deviations_text.h"
#include "tools/command_line/completion.h"
#include "tools/command_line/installed.h"
#include "tools/command_line/parse_command_line.h"
#include "tools/command_line/version.h"
#include "tools/luxrig-sim/control_http.h"
#include "tools/luxrig-sim/ports_file.h"
#include "tools/luxrig-sim/real_time.h"

namespace {

using namespace luxrig;
using Clock = std::chrono::steady_clock;

constexpr int kExitFailed = 1, kExitBadInput = 2;

volatile std::sig_atomic_t stop_asked = 0;
void ask_to_stop(int) { stop_asked = 1; }

struct Options {
  std::filesystem::path rig;
  std::uint64_t seed = 1;
  std::string ports_file;
  int control_port = 0;
  bool standard_ports = false;
  std::string listen = "127.0.0.1";
  double max_error = 0.01;
  std::string deviations = "mild";
  bool with_parent = false;
};

int failed(const Fault& fault) {
  fmt::print(stderr, "luxrig-sim: {}{}{}\n", fault.device, fault.device.empty() ? "" : ": ", fault.detail);
  return kExitFailed;
}

int refused(const std::vector<Problem>& problems) {
  for (const Problem& problem : problems) fmt::print(stderr, "{}\n", problem.text());
  return kExitBadInput;
}

Progress progress_on_stderr() {
  return [last = -1](double done) mutable {
    const int tenth = static_cast<int>(done * 10);
    if (tenth <= last) return;
    last = tenth;
    fmt::print(stderr, "luxrig-sim: light {} %\n", tenth * 10);
  };
}

/// The wanted place of every bus.
std::map<std::string, sim::EndpointPlace> places_of(const Rig& rig, const sim::Ports& before, std::uint32_t address,
                                                    bool standard_ports) {
  std::map<std::string, sim::EndpointPlace> places;
  for (const Bus& bus : rig.buses) {
    sim::EndpointPlace& place = places[bus.name];
    place.address = address;
    if (const auto port = before.buses.find(bus.name); port != before.buses.end()) place.port = port->second;
    if (const auto path = before.paths.find(bus.name); path != before.paths.end()) place.path = path->second;
  }
  if (standard_ports)
    for (const std::string& note : sim::use_standard_ports(rig, sim::may_listen_on, places))
      fmt::print(stderr, "luxrig-sim: {}\n", note);
  return places;
}

int simulate(const Options& options) {
  auto deviations = sim::parse_deviations(options.deviations);
  if (!deviations) return refused(deviations.error());
  deviations->seed = options.seed;
  sim::Ports ports;
  if (!options.ports_file.empty()) {
    const auto before = sim::read_ports(options.ports_file);
    if (!before) return refused(before.error());
    if (*before) ports = **before;
  }
  if (options.control_port != 0) ports.control = options.control_port;
  ports.seed = options.seed;
  in_addr listen{};
  if (::inet_pton(AF_INET, options.listen.c_str(), &listen) != 1)
    return refused({{"--listen", 0, 0, "\"" + options.listen + "\" is no IPv4 address",
                     "give one of this computer, such as 192.168.1.20, or 0.0.0.0 for all of them"}});
  const std::uint32_t address = ntohl(listen.s_addr);

  const auto rig = load_rig(options.rig);
  if (!rig) return refused(rig.error());
  if (const auto unwired = null_buses_in_use(*rig); !unwired.empty()) return refused(unwired);
  const auto begun = Clock::now();
  Watch watch;
  watch.progress = progress_on_stderr();
  auto world = sim::World::make(*rig, *deviations, options.max_error, watch);
  if (!world) return failed(world.error());
  fmt::print(stderr, "luxrig-sim: world made in {:.1f} s\n",
             std::chrono::duration<double>(Clock::now() - begun).count());

  sim::Faults faults(options.seed);
  auto places = places_of(*rig, ports, address, options.standard_ports);
  auto server = sim::RigServer::open(*rig, **world, faults, places);
  if (!server) return failed(server.error());
  ports.buses = (*server)->ports();
  ports.paths = (*server)->paths();
  for (const auto& [bus, port] : ports.buses) places[bus].port = port;
  for (const auto& [bus, path] : ports.paths) places[bus].path = path;
  if (address != sim::kAnyAddress) ports.host = sim::address_text(address);
  std::mutex world_mutex;
  auto control = sim::ControlHttp::open(
      {*rig, **world, faults, world_mutex, *deviations,
       sim::rig_json(*rig, places, fmt::format("{}, seed {}", options.deviations, options.seed), options.seed)},
      ports.control);
  if (!control) return failed(control.error());
  ports.control = (*control)->port();
  if (!options.ports_file.empty()) {
    if (const auto written = sim::write_ports(options.ports_file, ports); !written) return failed(written.error());
  }
  fmt::print(stderr, "luxrig-sim: truth and faults: http://127.0.0.1:{}/\n", ports.control);
  if (address >> 24 != sim::kLoopback >> 24)
    fmt::print(stderr, "luxrig-sim: everybody on {} can drive and read this simulated rig\n",
               address == sim::kAnyAddress ? "the networks of this computer" : "the network of " + options.listen);
  fmt::print("ready {}\n", sim::to_json(ports));
  std::fflush(stdout);
  sim::serve_in_real_time(**world, **server, world_mutex, [] { return stop_asked == 0; });
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("simulates a rig's devices on ports of this machine, in a seeded true world, with faults to switch on",
               "luxrig-sim");
  begin_command_line(app);
  app.set_version_flag("--version", std::string("luxrig-sim ") + kVersion, "print version and commit");
  app.footer("Faults, by POST /fault to the control port:\n" + sim::faults_in_words());
  add_rig_option(app, options.rig);
  app.add_option("--seed", options.seed, "of everything that differs from the rig file");
  app.add_option("--ports-file", options.ports_file, "JSON: taken from there when it exists, written when ready")
      ->check(offers_files());
  app.add_option("--control-port", options.control_port, "HTTP control port (0: any free one)")
      ->check(CLI::Range(0, 65535));
  app.add_flag(
      "--standard-ports", options.standard_ports,
      "sACN on 5568 with multicast, Art-Net on 6454 with broadcast, Modbus TCP on 502 (1502 without privilege)");
  app.add_option("--listen", options.listen,
                 "IPv4 address of the buses; 0.0.0.0: all. The control port stays on 127.0.0.1");
  app.add_option("--max-error", options.max_error, "relative error of the true light transport")
      ->check(CLI::Range(1e-4, 1.0));
  app.add_option("--deviations", options.deviations,
                 "mild, real, bad, none, or changes to one: real,meter_noise=0.003");
  app.add_flag("--with-parent", options.with_parent, "end when the program that started this ends");
  if (const auto end = parse_command_line(app, argc, argv)) return *end;

  struct sigaction action {};
  action.sa_handler = ask_to_stop;
  ::sigaction(SIGTERM, &action, nullptr);
  ::sigaction(SIGINT, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  if (options.with_parent) {
    const pid_t parent = ::getppid();
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) return kExitFailed;  // it ended before prctl()
  }
  return simulate(options);
}
